"""An offset is doubtful only where another effect predicts the tests as well."""

import pytest
from blind_campaigns.campaign import Options, generate

from reliab.discrepancy.campaign.reading import read_campaign
from reliab.discrepancy.diagnose import diagnose
from reliab.effects.registry import library

ROUNDED_LOAD_CELL_WITH_AN_OFFSET = 9_500_031


@pytest.mark.slow
def test_worse_prediction_casts_no_doubt_on_an_offset(tmp_path):
    """Rounding lets a rival take the offset for slow noise: by its evidence alone it won."""
    generate(ROUNDED_LOAD_CELL_WITH_AN_OFFSET, tmp_path / "campaign", options=Options(with_rivals=False))
    (effect,) = diagnose(read_campaign(tmp_path / "campaign")).effects
    assert effect.effect is library()["force_bias"]
    assert effect.error_with < 0.25 * effect.error_without
