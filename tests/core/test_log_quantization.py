"""Numbers in steps of their logarithm: rounded by half a step at most, and unknown where they were."""

import numpy as np
import pytest
import xarray as xr

from reliab.core.log_quantization import from_steps, to_steps
from reliab.core.shipped import shipped
from reliab.criterion.ellipse_reading import read_ellipses
from reliab.criterion.response_measures import read_shipped_ellipses, read_shipped_measures
from reliab.sweep.ellipse_dataset import open_windows
from reliab.sweep.netcdf import pack, read_netcdf, write_netcdf


@pytest.mark.parametrize("axes", [[0], [1], [0, 2], [2, 1, 0]])
def test_numbers_are_rounded_by_half_a_step(axes):
    values = np.exp(np.random.default_rng(8).normal(0.0, 6.0, size=(4, 5, 6)))
    result = from_steps(to_steps(values, 0.004, axes), 0.004, axes)
    assert np.abs(np.log(result / values)).max() <= 0.00201


def test_a_file_has_its_unknown_numbers_and_its_labels(tmp_path):
    values = np.exp(np.arange(6.0)).reshape(2, 3)
    values[0, 1] = np.nan
    dataset = xr.Dataset(
        {
            "a": (("x", "y"), values, {"units": "1"}),
            "unknown": (("x", "y"), np.isnan(values).astype(np.int8)),
        }
    )
    packed_dataset = pack(dataset, ("a",), step=0.01, dimensions=("y", "x"), unknown="unknown")
    write_netcdf(packed_dataset, tmp_path / "packed.nc")
    result = read_netcdf(tmp_path / "packed.nc", "A file", "Make it")
    np.testing.assert_allclose(result["a"], values, rtol=0.00501)
    assert result["a"].attrs == {"units": "1"}


@pytest.mark.slow
def test_both_readers_of_shipped_data_agree():
    path = shipped("datasets", "real_suite/ellipses.nc")
    windows = open_windows(path)
    for curve, window, metric in (("inscribed", "record", "rms"), ("ellipse", "20", "mte")):
        selection = windows[window].sel(curve=[curve], metric=[metric])
        table = read_shipped_ellipses(curve, window, metric)
        np.testing.assert_array_equal(table.a, selection["a"])
        np.testing.assert_array_equal(table.b, selection["b"])
        np.testing.assert_array_equal(table.error_at_rest, selection["error_at_rest"])
    selection = read_netcdf(shipped("datasets", "real_suite/first_order.nc"), "Measures", "")
    scales = read_shipped_measures(0.5 * np.pi).scales
    np.testing.assert_array_equal(scales.least, selection["scale"])
    near = selection["scale_towards"].sel(direction=[90.0, 112.5])
    np.testing.assert_array_equal(scales.towards, near)


def test_shipped_data_have_an_ellipse_or_a_reason():
    ellipses = read_ellipses("real_suite")
    assert (np.isfinite(ellipses["a"]) == (ellipses["no_ellipse"] == 0)).all()


@pytest.mark.parametrize("step", [0.0, -0.1, 1e300, np.nan])
def test_a_damaged_step_is_refused(step):
    with pytest.raises(ValueError, match="a step of"):
        from_steps(np.zeros(3, dtype=np.uint32), step, [0])
