"""Shares and sides of sweeps."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import reliab
from reliab.core.errors import InputError
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS, LABELS, Metric, NoEllipse, Side
from reliab.effects.registry import find_effect
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.frame_file import FrameUnderTest
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure
from reliab.sweep.ellipse_dataset import curve_row, open_ellipses, share_at_rest, write_ellipses
from reliab.sweep.ellipse_table import EllipseRequest, predict_ellipses, trace_ellipses
from reliab.sweep.frame_table import FrameRequest, trace_frame_ellipses
from reliab.sweep.labels import select_share, shares_of
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.results import open_results, write_compact
from reliab.sweep.run import run_sweep
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Ellipse, InscribedEllipse
from reliab.tracking.indices.response_error import relative_error

SHARES = (0.25, 1.0)
REQUEST = SweepRequest(
    frequencies=(1.0,),
    damping_ratios=(0.02, 0.05),
    experimental_fractions=SHARES,
    grid=ScaledGrid(gain_steps=8, delay_steps=10, lead_steps=8),
)


@pytest.fixture(scope="module")
def two(suite):
    return suite[:2]


@pytest.fixture(scope="module")
def results(tmp_path_factory, two):
    return open_results(run_sweep(two, REQUEST, tmp_path_factory.mktemp("shares") / "results.zarr"))


def test_the_share_is_a_dimension_after_the_damping_ratio(results):
    assert results["rms"].dims == ("motion", "f", "xi", "alpha", "kp", "tau")
    assert results["rms_at_rest"].dims == ("motion", "f", "xi", "alpha")
    assert results["alpha"].attrs["long_name"] == LABELS["alpha"].long_name
    assert shares_of(results) == SHARES
    assert "experimental_fraction" not in results.attrs


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("share", SHARES)
def test_each_share_has_the_bits_of_its_own_sweep(tmp_path, two, results, share):
    separate = replace(REQUEST, experimental_fractions=(share,))
    original = open_results(run_sweep(two, separate, tmp_path / "results.zarr"))
    part = select_share(results, share)
    assert shares_of(original) == (share,)
    xr.testing.assert_equal(part, original)
    xr.testing.assert_equal(select_share(results.reliab.ellipses(), share), original.reliab.ellipses())


def test_request_of_one_share_keeps_its_digest():
    description = replace(REQUEST, experimental_fractions=(0.5,)).describe()
    assert description["experimental_fraction"] == 0.5
    assert "experimental_fractions" not in description


def test_cells_of_a_share_solve_the_delay_equation(results, two):
    motion = two[0]
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    part = select_share(results, 0.25)
    structure = part.reliab.structure(1.0, 0.05)
    assert structure.experimental_fraction == 0.25
    cells = REQUEST.grid.cells(structure)
    some = np.flatnonzero((cells.delay > 0.0) & cells.stable)[::11]
    selection = replace(cells, gain=cells.gain[some], delay=cells.delay[some])
    exact = relative_error(
        Loop(excitation=excitation, structure=structure, engine=Engine.DELAY).deviation(selection), Metric.RMS
    )
    archive = part["rms"].sel(f=1.0, xi=0.05).isel(motion=0).values.ravel()[some]
    np.testing.assert_allclose(archive, exact, rtol=2e-3, atol=1e-5)


def test_small_errors_have_the_ellipse_of_the_closed_form(two):
    request = EllipseRequest(
        frequencies=(1.0,),
        damping_ratios=(0.05,),
        experimental_fractions=(0.3, 1.0),
        thresholds=(0.002,),
        curves=(Ellipse,),
    )
    boundary, prediction = trace_ellipses(two, request), predict_ellipses(two, request)
    assert (
        boundary["a"].dims == prediction["a"].dims == ("motion", "f", "xi", "alpha", *boundary["a"].dims[4:])
    )
    np.testing.assert_allclose(boundary["a"], prediction["a"], rtol=0.03)
    np.testing.assert_allclose(boundary["b"].sel(side="lag"), prediction["b"].sel(side="lag"), rtol=0.06)


def test_compact_files_keep_the_dimension(tmp_path, results):
    write_compact(results, tmp_path / "results.nc")
    dataset = open_results(tmp_path / "results.nc")
    assert shares_of(dataset) == SHARES
    np.testing.assert_allclose(dataset["rms"], results["rms"].clip(max=1.0), rtol=3e-4, atol=1e-5)


def test_options_of_one_share_are_refused_for_several(results):
    with pytest.raises(InputError, match="one share"):
        results.reliab.structure(1.0, 0.02)
    with pytest.raises(InputError, match="has no such share"):
        select_share(results, 0.5)
    selection = results.sel(alpha=0.25)  # by xarray's own means, which leaves a coordinate
    assert selection.reliab.structure(1.0, 0.02).experimental_fraction == 0.25


@pytest.mark.parametrize("shares", [(), (0.5, 0.5), (1.0, 0.5)])
def test_non_increasing_shares_are_refused(shares):
    with pytest.raises(InputError, match="increase"):
        replace(REQUEST, experimental_fractions=shares)


def trace_frame(motions, request, **options):
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    frame = FrameUnderTest(
        name="frame",
        partition=Partition.from_structure(structure, mass=20.0),
        output=None,
        error_of="interface",
    )
    asked = {name: getattr(request, name) for name in ("thresholds", "metrics", "curves", "sides")}
    return trace_frame_ellipses(motions, FrameRequest(frame=frame, **asked), **options)


TABLE = EllipseRequest(
    frequencies=(0.5, 1.0),
    damping_ratios=(0.02, 0.05),
    thresholds=(0.02, 0.05),
    curves=(InscribedEllipse, Ellipse),
)
SINGLE_STRUCTURE = replace(  # the second f, curve and metric, but the first ξ, side and threshold
    TABLE,
    frequencies=(1.0,),
    damping_ratios=(0.02,),
    thresholds=(0.02,),
    curves=(Ellipse,),
    sides=(Side.LAG,),
)
BOTH = (Metric.MTE, Metric.RMS)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("trace", "metrics"), [(trace_ellipses, BOTH), (trace_frame, BOTH), (predict_ellipses, (Metric.RMS,))]
)
def test_table_entry_equals_its_own_tracing(two, trace, metrics):
    """Structures, thresholds, metrics, curves and sides stand where the labels say."""
    complete = trace(two, replace(TABLE, metrics=metrics))
    single = trace(two[1:], SINGLE_STRUCTURE)
    for name in ("a", "b", "n", "no_ellipse"):
        part = complete[name].sel({dimension: single[dimension].values for dimension in single[name].dims})
        np.testing.assert_allclose(part.values, single[name].values, rtol=1e-4)


@pytest.mark.parametrize("trace", [trace_ellipses, trace_frame, predict_ellipses])
def test_progress_rises_to_its_total(two, trace):
    steps = []
    request = replace(SINGLE_STRUCTURE, experimental_fractions=SHARES)
    trace(two, request, progress=lambda *step: steps.append(step))
    finished_count, totals = zip(*steps, strict=True)
    assert list(finished_count) == sorted(set(finished_count))
    assert set(totals) == {finished_count[-1]}


@pytest.fixture(scope="module")
def boundary(suite):
    request = EllipseRequest(frequencies=(2.0,), damping_ratios=(0.05,), thresholds=(0.02, 0.05, 0.6))
    return trace_ellipses(suite[:3], request)


def test_both_sides_and_curves_are_there(boundary):
    assert boundary["a"].dims == ELLIPSE_DIMENSIONS
    assert boundary["curve"].values.tolist() == ["ellipse", "inscribed"]
    assert boundary["side"].values.tolist() == ["lag", "lead"]
    small = boundary.sel(threshold=0.05)
    assert (small["b"].sel(side="lead") > small["b"].sel(side="lag")).all()
    inscribed_curve, fit = (small.sel(curve=name) for name in ("inscribed", "ellipse"))
    assert (inscribed_curve["a"] * inscribed_curve["b"] < fit["a"] * fit["b"]).all()
    assert (small["no_ellipse"] == NoEllipse.NOT_SO).all()


def test_no_number_is_meaningless(boundary):
    for name in ("a", "b"):
        values = boundary[name].values
        assert not np.isinf(values).any()
        assert not (values < 0.0).any()
        np.testing.assert_array_equal(np.isnan(values), boundary["no_ellipse"].values > NoEllipse.NO_ROOM)
    # At 60 % no lead is long enough; what was followed still bounds the inscribed ellipse.
    far = boundary.sel(threshold=0.6, side="lead")
    assert (far["no_ellipse"].sel(curve="ellipse") == NoEllipse.NOT_REACHED).all()
    assert (far["a"].sel(curve="inscribed") > 0.0).all()


def test_threshold_kept_at_rest_is_found(boundary):
    remainder = boundary["error_at_rest"].sel(metric="rms").squeeze()
    assert remainder.dims == ("motion",)
    assert ((remainder > 0.05) & (remainder < 0.6)).all()
    share = share_at_rest(boundary).squeeze()
    assert share.sel(threshold=0.05) == 0.0
    assert share.sel(threshold=0.6) == 1.0
    assert np.isnan(share_at_rest(boundary.drop_vars("error_at_rest"))).all()


@pytest.mark.parametrize(
    ("contour", "curve", "reason"),
    [
        (None, Ellipse, NoEllipse.OUTSIDE_GRID),
        (Contour(amplitude=np.zeros(0), delay=np.zeros(0)), Ellipse, NoEllipse.NO_ROOM),
        (Contour(amplitude=np.linspace(0.9, 1.1, 9), delay=0.01 + np.linspace(-0.1, 0.1, 9) ** 2), Ellipse,
         NoEllipse.NOT_ELLIPTIC),
        (Contour(amplitude=np.ones(2), delay=-np.ones(2), corners=np.array([[0.9, 1.1], [0.0, 0.0]])),
         Ellipse, NoEllipse.NOT_REACHED),
    ],
)  # fmt: skip
def test_reason_for_a_missing_ellipse(contour, curve, reason):
    a, b, _, _, result = curve_row(contour, curve)
    assert result == reason
    assert (a, b) == (0.0, 0.0) if reason is NoEllipse.NO_ROOM else np.isnan([a, b]).all()


def test_inscribed_ellipse_of_a_widening_boundary():
    widening = Contour(amplitude=np.linspace(0.9, 1.1, 9), delay=0.01 + np.linspace(-0.1, 0.1, 9) ** 2)
    result = InscribedEllipse.fit(widening)
    assert result.a == pytest.approx(0.01)
    assert result.b == pytest.approx(100.0)


def test_a_file_without_curves_and_sides_holds_delays_only(tmp_path, boundary):
    plain = boundary.sel(curve="ellipse", side="lag", drop=True)
    plain[["a", "b", "sse", "n"]].to_netcdf(tmp_path / "plain.nc", engine="h5netcdf")
    dataset = open_ellipses(tmp_path / "plain.nc")
    assert dataset["a"].dims == ELLIPSE_DIMENSIONS
    xr.testing.assert_equal(dataset["b"].sel(curve="ellipse", side="lag", drop=True), plain["b"])
    assert dataset["side"].values.tolist() == ["lag"]


@pytest.mark.slow
def test_file_of_several_windows_gives_the_requested_one(tmp_path, boundary):
    has_several = xr.concat(
        [boundary, boundary.assign(b=2.0 * boundary["b"])],
        xr.Variable("window", ["record", "40"]),
        join="exact",
    )
    write_ellipses(has_several, tmp_path / "windows.nc")
    for window, factor in ((None, 1.0), ("record", 1.0), ("40", 2.0)):
        dataset = open_ellipses(tmp_path / "windows.nc", window=window)
        assert dataset.attrs["window"] == (window or "record")
        xr.testing.assert_allclose(dataset["b"], factor * boundary["b"])
    with pytest.raises(InputError, match="record, 40"):
        open_ellipses(tmp_path / "windows.nc", window="arias")
    write_ellipses(boundary, tmp_path / "one.nc")
    with pytest.raises(InputError, match="there are record"):
        open_ellipses(tmp_path / "one.nc", window="40")


def test_model_with_effects_has_delays_only(suite):
    lag = find_effect("first_order_lag")(time_constant_s=1e-4)
    model = HybridTest(structure=Structure(frequency=0.5, damping_ratio=0.1), effects=(lag,))
    with pytest.raises(InputError, match="late actuators only"):
        EllipseRequest(frequencies=(0.5,), damping_ratios=(0.1,), model=model)
    with pytest.raises(InputError, match="without leads"):
        SweepRequest(frequencies=(0.5,), damping_ratios=(0.1,), model=model)
    assert reliab.ellipses(suite[:1], model=model)["side"].values.tolist() == ["lag"]


def test_store_of_an_older_version_still_answers(tmp_path, suite):
    request = SweepRequest(frequencies=(1.0,), damping_ratios=(0.02,), grid=ScaledGrid(lead_steps=0))
    results = open_results(run_sweep(suite[:2], request, tmp_path / "lag.zarr")).drop_vars("rms_at_rest")
    result = results.reliab.ellipses((0.05,))
    assert result["side"].values.tolist() == [Side.LAG]
    assert "error_at_rest" not in result
