"""Data that ship: found, verified, and named."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from reliab.app import cli
from reliab.core import shipped
from reliab.core.errors import InputError
from reliab.core.shipped import or_shipped
from reliab.discrepancy.campaign.reading import campaign_folder
from reliab.sweep.results import find_results, open_results, real_results

ROOT = Path(__file__).parents[2]


@pytest.fixture
def installation(tmp_path, monkeypatch):
    """An installation without the large file, and an empty data folder."""
    folder = tmp_path / "datasets" / "real_suite"
    folder.mkdir(parents=True)
    for name in ("SHA256SUMS", "real_suite/results_of_six.nc"):
        shutil.copy(shipped.shipped("datasets", name), tmp_path / "datasets" / name)
    monkeypatch.setattr(shipped, "_PACKAGE_FOLDER", tmp_path)
    monkeypatch.setenv(shipped.DATA_VARIABLE, str(tmp_path / "data"))
    shipped.checksums.cache_clear()
    yield tmp_path
    shipped.checksums.cache_clear()


def test_every_listed_file_has_its_checksum():
    for name, reference in shipped.checksums("datasets").items():
        assert shipped.checksum_of(shipped.shipped("datasets", name)) == reference, name


def test_every_file_in_netcdf_is_listed():
    folder = shipped.shipped("datasets", "")
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*.nc")}
    assert files <= set(shipped.checksums("datasets"))


def test_a_changed_file_is_refused(installation):
    file = installation / "datasets" / "real_suite" / "results_of_six.nc"
    assert real_results([1.0], [0.02]) == file
    content = bytearray(file.read_bytes())
    content[1000] ^= 1
    file.write_bytes(content)
    with pytest.raises(InputError, match="has changed"):
        real_results([1.0], [0.02])


def test_missing_data_are_fetched(installation, capsys):
    source = ROOT / "datasets" / "real_suite" / "results.nc"
    with pytest.raises(InputError, match="Run `reliab fetch"):
        real_results([0.75], [0.02])
    assert cli.run(["fetch", str(source)]) == 0
    assert real_results([0.75], [0.02]).is_relative_to(installation / "data")
    assert "the checksum is as listed" in capsys.readouterr().out


@pytest.mark.parametrize("wrong", ["content", "name", "scheme", "missing"])
def test_nothing_else_is_fetched(installation, tmp_path, wrong, capsys):
    file = tmp_path / ("results.nc" if wrong != "name" else "other.nc")
    if wrong != "missing":
        file.write_bytes(b"no results")
    source = "http://example.org/results.nc" if wrong == "scheme" else str(file)
    assert cli.run(["fetch", source]) == 2
    assert not list((installation / "data").rglob("*.nc"))
    words = {"content": "checksum", "name": "of this name", "scheme": "https only", "missing": "Cannot fetch"}
    assert words[wrong] in capsys.readouterr().err


@pytest.mark.slow
def test_the_small_file_holds_the_values_of_the_large_one_to_its_precision():
    small, large = (open_results(real_results(*selection)) for selection in (([1.0], [0.02]), (None, None)))
    subset = large.sel(f=small["f"], xi=small["xi"])
    for name in ("rms", "mte"):
        assert (small[name].values == 0.0).sum() == (subset[name].values == 0.0).sum()
        np.testing.assert_allclose(small[name].values, subset[name].values, rtol=1.3e-3)
    assert {**small.attrs, "precision": ""} == {**large.attrs, "precision": ""}


@pytest.mark.parametrize("name", ["sample_test", "rig_a", "real_suite"])
def test_an_empty_folder_does_not_hide_shipped_data(name, tmp_path, monkeypatch):
    result = {
        "sample_test": lambda: or_shipped(Path("sample_test"), "datasets", "test.csv"),
        "rig_a": lambda: campaign_folder("rig_a"),
        "real_suite": lambda: find_results(Path("real_suite"), (1.0,), (0.02,)),
    }[name]
    monkeypatch.chdir(tmp_path)
    original = result()
    Path(name).mkdir()
    assert result() == original


def test_a_file_and_a_store_of_results_are_the_users_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("sample_test").write_text("0,1\n")
    Path("real_suite").mkdir()
    Path("real_suite/zarr.json").write_text("{}")
    assert or_shipped(Path("sample_test"), "datasets", "test.csv") == Path("sample_test")
    assert or_shipped(Path("real_suite"), "datasets", "results.nc") == Path("real_suite")
