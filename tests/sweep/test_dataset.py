"""The stored dataset has the promised shape and holds what the engines give."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.vocabulary import LABELS, RESULT_DIMENSIONS, Metric, Side
from reliab.simulation.engine import Engine, Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper, spectral
from reliab.simulation.linear_loop.blocks import cut
from reliab.simulation.linear_loop.pole_recursion import transfer
from reliab.structures.structure import critical_delay
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.request import ExplicitGrid, ScaledGrid, SweepRequest, sweep_request
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.tracking import frequency_evaluation
from reliab.tracking.indices.window import Window


@pytest.fixture(scope="module")
def results(store):
    return open_results(store)


def loop_of(results, motion, f, xi, engine=Engine.DELAY):
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    return Loop(excitation=excitation, structure=results.reliab.structure(f, xi), engine=engine)


def test_dimensions_variables_and_labels(results, suite):
    assert results["rms"].dims == RESULT_DIMENSIONS
    assert set(results.data_vars) == {"rms", "mte", "A", "d", "stable", "rms_at_rest"}
    assert results["kp"].dims == ("xi", "kp")
    assert results["tau"].dims == ("f", "xi", "tau")
    for name, variable in results.variables.items():
        assert variable.attrs["units"] == LABELS[name].units
        assert variable.attrs["long_name"]
    assert results["event"].values.tolist() == list(suite.events)
    assert results["checksum"].values.tolist() == [motion.checksum for motion in suite]
    assert results.attrs["schema_version"] == 2
    for attribute in ("engine", "window", "tolerance", "versions", "study_hash"):
        assert results.attrs[attribute]


@pytest.mark.slow
def test_cells_equal_engine_results(results, suite):
    rng = np.random.default_rng(1)
    for _ in range(20):
        m, f, xi = int(rng.integers(6)), float(rng.choice([0.5, 1.0])), float(rng.choice([0.02, 0.05]))
        position = results.reliab.select_structure(f, xi).isel(motion=m)
        late = rng.random() < 0.5
        selection = np.flatnonzero(position["tau"].values > 0.0 if late else position["tau"].values < 0.0)
        i, j = int(rng.integers(position.sizes["kp"])), int(rng.choice(selection[: selection.size // 2]))
        loop = loop_of(results, suite[m], f, xi, Engine.DELAY if late else Engine.SPECTRAL)
        result = loop.deviation(loop.cells(gain=position["kp"].values[i], delay=position["tau"].values[j]))
        cell = position.isel(kp=i, tau=j)
        assert float(cell["rms"]) == pytest.approx(relative_error(result, Metric.RMS)[0], rel=1e-4)
        assert float(cell["mte"]) == pytest.approx(relative_error(result, Metric.MTE)[0], rel=1e-3)


def test_index_of_a_cell_is_of_its_histories(results, suite):
    cell = results.reliab.select_structure(1.0, 0.05).isel(motion=2)
    structure = results.reliab.structure(1.0, 0.05)
    excitation = Excitation(acceleration=suite[2].acceleration, time_step=suite[2].time_step)
    blocks = cut(excitation, structure, step=1 / 512)
    punctual = int(np.argmin(np.abs(cell["tau"].values)))
    for i, late in ((9, 6), (14, 8), (18, 10)):
        j = punctual + late
        gain, delay = float(cell["kp"][i]), float(cell["tau"][j])
        command, reading = delay_stepper.response(blocks, structure, gain, delay)
        result = frequency_evaluation(command, reading, blocks.step)
        assert float(cell["A"][i, j]) == pytest.approx(result.amplitude, abs=2e-3)
        assert float(cell["d"][i, j]) == pytest.approx(result.equivalent_delay, rel=1e-2)


def test_index_of_a_lead_is_of_its_histories(results, suite):
    cell = results.reliab.select_structure(1.0, 0.05).isel(motion=2)
    structure = results.reliab.structure(1.0, 0.05)
    excitation = Excitation(acceleration=suite[2].acceleration, time_step=suite[2].time_step)
    for i, j in ((9, 4), (14, 12), (18, 20)):
        gain, delay = float(cell["kp"][i]), float(cell["tau"][j])
        assert delay < 0.0
        reading, step = spectral.response(excitation, structure, gain, delay)
        command, _ = spectral.respond(
            excitation,
            lambda s, g=gain, d=delay: transfer(structure, g, d, s) * np.exp(s * d) / g,
            lead=-delay,
        )
        result = frequency_evaluation(command, reading, step)
        assert float(cell["A"][i, j]) == pytest.approx(result.amplitude, abs=2e-3)
        assert float(cell["d"][i, j]) == pytest.approx(result.equivalent_delay, rel=1e-2)


def test_stable_is_below_the_critical_delay(results):
    cell = results.reliab.select_structure(0.5, 0.02).isel(motion=0)
    limit = critical_delay(results.reliab.structure(0.5, 0.02), cell["kp"].values)
    np.testing.assert_array_equal(cell["stable"], cell["tau"].values[np.newaxis] < limit[:, np.newaxis])


def test_memory_holds_double_precision(results):
    assert results["rms"].dtype == np.float32  # on disk, not yet read
    assert results.reliab.select_structure(1.0, 0.02)["rms"].dtype == np.float64


@pytest.mark.slow
def test_ellipses_from_the_store_are_those_traced_from_the_loop(tmp_path, suite):
    thresholds, metrics = (0.01, 0.02, 0.05, 0.10), (Metric.RMS, Metric.MTE)
    sweep = SweepRequest(frequencies=(0.5, 1.0), damping_ratios=(0.02, 0.05))
    small_sample = suite[:2]
    archive = open_results(run_sweep(small_sample, sweep, tmp_path / "full.zarr")).reliab.ellipses(
        thresholds, metrics
    )
    request = EllipseRequest(
        frequencies=(0.5, 1.0), damping_ratios=(0.02, 0.05), thresholds=thresholds, metrics=metrics
    )
    boundary = trace_ellipses(small_sample, request)
    assert archive["a"].dims == boundary["a"].dims
    for metric, tolerance in (("rms", 0.005), ("mte", 0.02)):
        fit, reference = (item.sel(metric=metric, curve="ellipse") for item in (archive, boundary))
        is_inside, true = (item.sel(metric=metric, curve="inscribed") for item in (archive, boundary))
        for name in ("a", "b"):
            assert float(np.abs(fit[name] / reference[name] - 1.0).max()) < tolerance
        area = np.sqrt(is_inside["a"] * is_inside["b"] / true["a"] / true["b"])
        assert float(np.abs(area - 1.0).max()) < tolerance
    np.testing.assert_array_equal(archive["no_ellipse"], boundary["no_ellipse"])
    np.testing.assert_allclose(archive["error_at_rest"], boundary["error_at_rest"], rtol=1e-5)


def test_error_between_cells_and_nearest_cell(results, suite):
    loop = loop_of(results, suite[3], 1.0, 0.05)
    result = relative_error(loop.deviation(loop.cells(gain=1.013, delay=0.0021)), Metric.RMS)[0]
    assert float(results.reliab.errors(f=1.0, xi=0.05, gain=[1.013], delay=[0.0021])[3, 0]) == pytest.approx(
        result, rel=3e-3
    )
    nearest = results.reliab.nearest(f=1.0, xi=0.05, gain=1.013, delay=0.0021)
    assert abs(float(nearest["kp"]) - 1.013) < 0.006


def test_every_stored_window_has_its_own_errors(store, results, suite):
    arias = open_results(store, window="arias")
    assert arias.attrs["window"] == "arias"
    loop = loop_of(results, suite[0], 1.0, 0.02)
    bounds = Window.parse("arias").bounds(suite[0].acceleration, suite[0].time_step)
    is_inside = replace(loop, excitation=replace(loop.excitation, window=bounds))
    for dataset, options in ((results, loop), (arias, is_inside)):
        cell = dataset.reliab.select_structure(1.0, 0.02).isel(motion=0, kp=10, tau=-12)
        result = options.deviation(options.cells(gain=float(cell["kp"]), delay=float(cell["tau"])))
        assert float(cell["rms"]) == pytest.approx(relative_error(result, Metric.RMS)[0], rel=1e-4)
    with pytest.raises(InputError, match="the store has record, arias"):
        open_results(store, window="40")


@pytest.mark.slow
def test_motions_traced_some_at_a_time_have_the_curves_of_all_together(store, monkeypatch):
    results = open_results(store)
    joint = results.reliab.ellipses((0.02, 0.05), tuple(Metric))
    monkeypatch.setattr("reliab.sweep.results_accessor._MOTIONS_AT_A_TIME", 4)
    xr.testing.assert_identical(results.reliab.ellipses((0.02, 0.05), tuple(Metric)), joint)


def test_contour_leaving_an_explicit_grid_is_not_invented(tmp_path, suite):
    grid = ExplicitGrid(
        gain=tuple(np.linspace(0.99, 1.01, 21).round(4)), delay=tuple(np.linspace(0, 5e-4, 6))
    )
    request = SweepRequest(frequencies=(1.0,), damping_ratios=(0.05,), grid=grid)
    results = open_results(run_sweep(suite, request, tmp_path / "small.zarr"))
    assert results["kp"].dims == ("kp",)
    assert np.isnan(results.reliab.ellipses((0.2,))["a"]).all()
    assert set(results.reliab.contours(f=1.0, xi=0.05, threshold=0.2).values()) == {None}


def test_explicit_grid_of_the_paper_resolves_its_own_boundaries(tmp_path, suite):
    request = SweepRequest(frequencies=(1.0,), damping_ratios=(0.02,), grid=ExplicitGrid())
    small_sample = suite[:3]
    results = open_results(run_sweep(small_sample, request, tmp_path / "paper.zarr"))
    assert results.reliab.sides == (Side.LAG,)
    with pytest.raises(InputError, match="no early actuators"):
        results.reliab.ellipses(sides=(Side.LEAD,))
    archive = results.reliab.ellipses((0.02,)).sel(curve="ellipse").squeeze()
    for k, motion in enumerate(small_sample):
        structure = request.structures[0]
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        (contour,) = motion_contours(Loop(excitation=excitation, structure=structure), (0.02,))
        direct = Ellipse.fit(contour)
        if not np.isnan(archive["a"][k]):
            assert float(archive["a"][k]) == pytest.approx(direct.a, rel=0.005)
            assert float(archive["b"][k]) == pytest.approx(direct.b, rel=0.005)


def test_unsimulated_structure_is_refused(results):
    with pytest.raises(InputError, match=r"0\.5, 1"):
        results.reliab.select_structure(0.7, 0.02)


@pytest.mark.parametrize("label", ["grid", "engine", "window"])
def test_unknown_name_is_refused_with_the_choices(label):
    with pytest.raises(InputError, match=r"Unknown .*; found '?nothing"):
        sweep_request(**{label: "nothing"})


def test_accessor_refuses_other_datasets():
    with pytest.raises(InputError, match="results dataset"):
        _ = xr.Dataset({"rms": ("x", [1.0])}).reliab


@pytest.mark.parametrize(
    "wrong",
    [
        {"frequencies": ()},
        {"frequencies": (1.0, 0.5)},
        {"damping_ratios": (0.02, 0.02)},
        {"windows": ()},
        {"frequencies": (-1.0, 1.0)},
    ],
)
def test_senseless_request_is_refused(wrong):
    with pytest.raises(InputError):
        SweepRequest(**{"frequencies": (1.0,), "damping_ratios": (0.02,), **wrong})


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: ExplicitGrid(gain=(0.9, 0.95, 1.05, 1.1, 1.2)),
        lambda: ExplicitGrid(delay=(0.001, 0.002, 0.003, 0.004)),
        lambda: ExplicitGrid(delay=(-0.002, -0.001, -0.0005, 0.0)),
        lambda: ScaledGrid(lead_steps=2),
        lambda: ExplicitGrid(gain=(1.1, 1.0, 0.9, 0.8, 0.7)),
        lambda: ScaledGrid(gain_steps=1),
    ],
)
def test_senseless_grid_is_refused(wrong):
    with pytest.raises(InputError):
        wrong()
