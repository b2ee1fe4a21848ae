"""Results in one small file answer what the store answers."""

import h5py
import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.sweep.ellipse_dataset import open_ellipses, write_ellipses
from reliab.sweep.results import open_results, write_compact
from reliab.tracking.boundary.curves import Ellipse


@pytest.fixture(scope="module")
def compact(tmp_path_factory, store):
    path = tmp_path_factory.mktemp("compact") / "results.nc"
    write_compact(open_results(store), path)
    return path


@pytest.mark.slow
def test_ellipses_of_the_small_file_are_those_of_the_store(store, compact):
    thresholds = (0.02, 0.05, 0.1)
    large, small = (open_results(path).reliab.ellipses(thresholds) for path in (store, compact))
    assert small["side"].values.tolist() == ["lag", "lead"]
    fit = [item.sel(curve="ellipse") for item in (small, large)]
    assert np.allclose(*(item["a"] for item in fit), rtol=5e-3, equal_nan=True)
    assert np.allclose(*(item["b"] for item in fit), rtol=5e-3, equal_nan=True)
    # An inscribed ellipse may pass from one edge of the hull to the next, but keeps its area.
    area = [np.sqrt(item["a"] * item["b"]).sel(curve="inscribed") for item in (small, large)]
    assert np.allclose(*area, rtol=5e-3)
    assert np.allclose(small["error_at_rest"], large["error_at_rest"], rtol=2.5e-4)


def test_errors_are_kept_to_the_stated_precision(store, compact):
    large, small = (open_results(path)["rms"].values for path in (store, compact))
    is_within_range = large <= 1.0
    assert np.allclose(small[is_within_range], large[is_within_range], rtol=2.52e-4)  # and single precision
    assert small.max() == 1.0


def test_window_missing_in_file_is_refused(compact):
    with pytest.raises(InputError, match="record"):
        open_results(compact, window="arias")


def test_file_declaring_too_much_is_refused_before_reading(compact, tmp_path):
    path = tmp_path / "results.nc"
    path.write_bytes(compact.read_bytes())
    with h5py.File(path, "a") as file:
        file.create_dataset("rms2", shape=(1 << 40,), chunks=(1 << 20,), dtype="f8")
    for dataset in (open_results, open_ellipses):
        with pytest.raises(InputError, match="must hold the numbers that it declares"):
            dataset(path)


def test_file_of_an_earlier_version_is_refused(compact, tmp_path):
    path = tmp_path / "results.nc"
    path.write_bytes(compact.read_bytes())
    with h5py.File(path, "a") as file:
        file.attrs["step_of_logarithm"] = [5e-4]
    with pytest.raises(InputError, match="Fetch or make it again"):
        open_results(path)


def test_ellipses_survive_their_file(tmp_path, store):
    ellipses = open_results(store).reliab.ellipses()
    write_ellipses(ellipses, tmp_path / "ellipses.nc")
    assert open_ellipses(tmp_path / "ellipses.nc").identical(ellipses)


@pytest.mark.parametrize("dataset", [open_results, open_ellipses])
@pytest.mark.parametrize("content", [b"", b"a,b\n1,2\n", b"\x89HDF\r\n\x1a\n"])
def test_other_files_are_refused(tmp_path, dataset, content):
    path = tmp_path / "other.nc"
    path.write_bytes(content)
    with pytest.raises(InputError, match="NetCDF"):
        dataset(path)


@pytest.mark.slow
def test_the_shipped_files_agree_with_each_other():
    results = open_results(shipped("datasets", "real_suite/results.nc")).sel(f=[1.0], xi=[0.02])
    ellipses = open_ellipses(shipped("datasets", "real_suite/ellipses.nc"))
    looked_up = results.reliab.ellipses((0.05,), curves=(Ellipse,)).squeeze(
        ("f", "xi", "threshold", "metric")
    )
    boundary = ellipses.sel(f=1.0, xi=0.02, threshold=0.05, metric="rms", curve=["ellipse"])
    boundary = boundary.sel(side=looked_up["side"])
    assert np.allclose(looked_up["a"], boundary["a"], rtol=5e-3)
    assert np.allclose(looked_up["b"], boundary["b"], rtol=5e-3)
