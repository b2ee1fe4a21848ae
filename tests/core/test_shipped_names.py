"""A folder named like something that ships does not hide it, unless it holds such data."""

from pathlib import Path

import pytest

from reliab.core.shipped import or_shipped
from reliab.discrepancy.campaign.reading import campaign_folder
from reliab.sweep.results import stored_results


@pytest.mark.parametrize("name", ["sample_test", "rig_a", "real_suite"])
def test_a_folder_without_data_hides_nothing_that_ships(name, tmp_path, monkeypatch):
    found = {
        "sample_test": lambda: or_shipped(Path("sample_test"), "datasets", "test.csv"),
        "rig_a": lambda: campaign_folder("rig_a"),
        "real_suite": lambda: stored_results(Path("real_suite"), (1.0,), (0.02,)),
    }[name]
    monkeypatch.chdir(tmp_path)
    before = found()
    Path(name).mkdir()
    assert found() == before


def test_a_file_and_a_store_of_results_are_the_users_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sample_test").write_text("0,1\n")
    Path("real_suite").mkdir()
    Path("real_suite/zarr.json").write_text("{}")
    assert or_shipped(Path("sample_test"), "datasets", "test.csv") == Path("sample_test")
    assert or_shipped(Path("real_suite"), "datasets", "results.nc") == Path("real_suite")
