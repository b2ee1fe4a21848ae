"""A diagnosis reports that it moves within a block, and ends at its announced total."""

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose


def test_progress_grows_by_one_step_up_to_the_total(small_campaign):
    calls = []
    diagnose(read_campaign(small_campaign), progress=lambda count, total: calls.append((count, total)))
    total = calls[0][1]
    assert total > 1  # a single block
    assert calls == [(count, total) for count in range(total + 1)]
