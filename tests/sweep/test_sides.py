"""Datasets of ellipses have two sides and two curves, and say why an ellipse is not there."""

import numpy as np
import pytest
import xarray as xr

import reliab
from reliab.core.errors import InputError
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS, NoEllipse, Side
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_dataset import curve_row, share_at_rest
from reliab.sweep.ellipse_file import open_ellipses, write_ellipses
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.grid import ScaledGrid
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Cosine, Ellipse, InscribedEllipse


@pytest.fixture(scope="module")
def traced(suite):
    request = EllipseRequest(frequencies=(2.0,), damping_ratios=(0.05,), thresholds=(0.02, 0.05, 0.6))
    return trace_ellipses(suite[:3], request)


def test_both_sides_and_curves_are_there(traced):
    assert traced["a"].dims == ELLIPSE_DIMENSIONS
    assert traced["curve"].values.tolist() == ["ellipse", "inscribed"]
    assert traced["side"].values.tolist() == ["lag", "lead"]
    small = traced.sel(threshold=0.05)
    assert (small["b"].sel(side="lead") > small["b"].sel(side="lag")).all()
    inscribed, fitted = (small.sel(curve=name) for name in ("inscribed", "ellipse"))
    assert (inscribed["a"] * inscribed["b"] < fitted["a"] * fitted["b"]).all()
    assert (small["no_ellipse"] == NoEllipse.NOT_SO).all()


def test_no_number_is_meaningless(traced):
    for name in ("a", "b"):
        values = traced[name].values
        assert not np.isinf(values).any()
        assert not (values < 0.0).any()
        np.testing.assert_array_equal(np.isnan(values), traced["no_ellipse"].values > NoEllipse.NO_ROOM)
    # At 60 % no lead is long enough; what was followed still bounds the inscribed ellipse.
    far = traced.sel(threshold=0.6, side="lead")
    assert (far["no_ellipse"].sel(curve="ellipse") == NoEllipse.NOT_REACHED).all()
    assert (far["a"].sel(curve="inscribed") > 0.0).all()


def test_threshold_that_an_actuator_at_rest_keeps_is_found(traced):
    rest = traced["error_at_rest"].sel(metric="rms").squeeze()
    assert rest.dims == ("motion",)
    assert ((rest > 0.05) & (rest < 0.6)).all()
    share = share_at_rest(traced).squeeze()
    assert share.sel(threshold=0.05) == 0.0
    assert share.sel(threshold=0.6) == 1.0
    assert np.isnan(share_at_rest(traced.drop_vars("error_at_rest"))).all()


@pytest.mark.parametrize(
    ("contour", "curve", "reason"),
    [
        (None, Ellipse, NoEllipse.OUTSIDE_GRID),
        (Contour(amplitude=np.zeros(0), delay=np.zeros(0)), Ellipse, NoEllipse.NO_ROOM),
        (Contour(amplitude=np.linspace(0.9, 1.1, 9), delay=0.01 + np.linspace(-0.1, 0.1, 9) ** 2), Ellipse,
         NoEllipse.NOT_ELLIPTIC),
        (Contour(amplitude=np.ones(2), delay=-np.ones(2), corners=np.array([[0.9, 1.1], [0.0, 0.0]])), Cosine,
         NoEllipse.NOT_REACHED),
    ],
)  # fmt: skip
def test_reason_for_which_there_is_no_ellipse(contour, curve, reason):
    a, b, _, _, found = curve_row(contour, curve)
    assert found == reason
    assert (a, b) == (0.0, 0.0) if reason is NoEllipse.NO_ROOM else np.isnan([a, b]).all()


def test_inscribed_ellipse_of_a_boundary_that_widens_with_the_amplitude_is_one():
    widening = Contour(amplitude=np.linspace(0.9, 1.1, 9), delay=0.01 + np.linspace(-0.1, 0.1, 9) ** 2)
    found = InscribedEllipse.fit(widening)
    assert found.a == pytest.approx(0.01)
    assert found.b == pytest.approx(100.0)


def test_file_of_an_older_version_holds_delays_only(tmp_path, traced):
    older = traced.sel(curve="ellipse", side="lag", drop=True)
    older[["a", "b", "sse", "n"]].to_netcdf(tmp_path / "older.nc", engine="h5netcdf")
    opened = open_ellipses(tmp_path / "older.nc")
    assert opened["a"].dims == ELLIPSE_DIMENSIONS
    xr.testing.assert_equal(opened["b"].sel(curve="ellipse", side="lag", drop=True), older["b"])
    assert opened["side"].values.tolist() == ["lag"]


@pytest.mark.slow
def test_file_of_several_windows_gives_the_one_that_is_asked_for(tmp_path, traced):
    several = xr.concat(
        [traced, traced.assign(b=2.0 * traced["b"])], xr.Variable("window", ["record", "40"]), join="exact"
    )
    write_ellipses(several, tmp_path / "windows.nc")
    for window, factor in ((None, 1.0), ("record", 1.0), ("40", 2.0)):
        opened = open_ellipses(tmp_path / "windows.nc", window=window)
        assert opened.attrs["window"] == (window or "record")
        xr.testing.assert_allclose(opened["b"], factor * traced["b"])
    with pytest.raises(InputError, match="record, 40"):
        open_ellipses(tmp_path / "windows.nc", window="arias")
    write_ellipses(traced, tmp_path / "one.nc")
    with pytest.raises(InputError, match="there are record"):
        open_ellipses(tmp_path / "one.nc", window="40")


def test_model_with_effects_has_delays_only(suite):
    lag = find_effect("first_order_lag")(time_constant_s=1e-4)
    model = HybridTest(structure=Structure(frequency=0.5, damping_ratio=0.1), effects=(lag,))
    with pytest.raises(InputError, match="lags only"):
        EllipseRequest(frequencies=(0.5,), damping_ratios=(0.1,), model=model)
    with pytest.raises(InputError, match="without leads"):
        SweepRequest(frequencies=(0.5,), damping_ratios=(0.1,), model=model)
    assert reliab.ellipses(suite[:1], model=model)["side"].values.tolist() == ["lag"]


def test_store_of_an_older_version_still_answers(tmp_path, suite):
    request = SweepRequest(frequencies=(1.0,), damping_ratios=(0.02,), grid=ScaledGrid(lead_steps=0))
    results = open_results(run_sweep(suite[:2], request, tmp_path / "lag.zarr")).drop_vars("rms_at_rest")
    found = results.reliab.ellipses((0.05,))
    assert found["side"].values.tolist() == [Side.LAG]
    assert "error_at_rest" not in found
