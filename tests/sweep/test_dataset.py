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
from reliab.simulation.linear_loop.dominant_pole import transfer
from reliab.structures.structure import critical_delay
from reliab.sweep.ellipse_table import EllipseRequest, trace_ellipses
from reliab.sweep.grid import ExplicitGrid, ScaledGrid
from reliab.sweep.plain import sweep_request
from reliab.sweep.request import SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.frequency_evaluation import frequency_evaluation
from reliab.tracking.indices.response_error import relative_error
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
def test_cells_hold_what_the_engine_gives(results, suite):
    rng = np.random.default_rng(1)
    for _ in range(20):
        m, f, xi = int(rng.integers(6)), float(rng.choice([0.5, 1.0])), float(rng.choice([0.02, 0.05]))
        at = results.reliab.select_structure(f, xi).isel(motion=m)
        late = rng.random() < 0.5
        chosen = np.flatnonzero(at["tau"].values > 0.0 if late else at["tau"].values < 0.0)
        i, j = int(rng.integers(at.sizes["kp"])), int(rng.choice(chosen[: chosen.size // 2]))
        loop = loop_of(results, suite[m], f, xi, Engine.DELAY if late else Engine.SPECTRAL)
        found = loop.deviation(loop.cells(gain=at["kp"].values[i], delay=at["tau"].values[j]))
        cell = at.isel(kp=i, tau=j)
        assert float(cell["rms"]) == pytest.approx(relative_error(found, Metric.RMS)[0], rel=1e-4)
        assert float(cell["mte"]) == pytest.approx(relative_error(found, Metric.MTE)[0], rel=1e-3)


def test_index_of_a_cell_is_that_of_its_histories(results, suite):
    at = results.reliab.select_structure(1.0, 0.05).isel(motion=2)
    structure = results.reliab.structure(1.0, 0.05)
    excitation = Excitation(acceleration=suite[2].acceleration, time_step=suite[2].time_step)
    blocks = cut(excitation, structure, step=1 / 512)
    punctual = int(np.argmin(np.abs(at["tau"].values)))
    for i, late in ((9, 6), (14, 8), (18, 10)):
        j = punctual + late
        gain, delay = float(at["kp"][i]), float(at["tau"][j])
        command, measured = delay_stepper.response(blocks, structure, gain, delay)
        found = frequency_evaluation(command, measured, blocks.step)
        assert float(at["A"][i, j]) == pytest.approx(found.amplitude, abs=2e-3)
        assert float(at["d"][i, j]) == pytest.approx(found.equivalent_delay, rel=1e-2)


def test_index_of_a_lead_is_that_of_its_histories(results, suite):
    at = results.reliab.select_structure(1.0, 0.05).isel(motion=2)
    structure = results.reliab.structure(1.0, 0.05)
    excitation = Excitation(acceleration=suite[2].acceleration, time_step=suite[2].time_step)
    for i, j in ((9, 4), (14, 12), (18, 20)):
        gain, delay = float(at["kp"][i]), float(at["tau"][j])
        assert delay < 0.0
        measured, step = spectral.response(excitation, structure, gain, delay)
        command, _ = spectral.respond(
            excitation,
            lambda s, g=gain, d=delay: transfer(structure, g, d, s) * np.exp(s * d) / g,
            lead=-delay,
        )
        found = frequency_evaluation(command, measured, step)
        assert float(at["A"][i, j]) == pytest.approx(found.amplitude, abs=2e-3)
        assert float(at["d"][i, j]) == pytest.approx(found.equivalent_delay, rel=1e-2)


def test_stable_is_below_the_critical_delay(results):
    at = results.reliab.select_structure(0.5, 0.02).isel(motion=0)
    limit = critical_delay(results.reliab.structure(0.5, 0.02), at["kp"].values)
    np.testing.assert_array_equal(at["stable"], at["tau"].values[np.newaxis] < limit[:, np.newaxis])


def test_memory_holds_double_precision(results):
    assert results["rms"].dtype == np.float32  # on disk, not yet read
    assert results.reliab.select_structure(1.0, 0.02)["rms"].dtype == np.float64


@pytest.mark.slow
def test_ellipses_from_the_store_are_those_traced_from_the_loop(tmp_path, suite):
    thresholds, metrics = (0.01, 0.02, 0.05, 0.10), (Metric.RMS, Metric.MTE)
    sweep = SweepRequest(frequencies=(0.5, 1.0), damping_ratios=(0.02, 0.05))
    few = suite[:2]
    stored = open_results(run_sweep(few, sweep, tmp_path / "full.zarr")).reliab.ellipses(thresholds, metrics)
    request = EllipseRequest(
        frequencies=(0.5, 1.0), damping_ratios=(0.02, 0.05), thresholds=thresholds, metrics=metrics
    )
    traced = trace_ellipses(few, request)
    assert stored["a"].dims == traced["a"].dims
    for metric, tolerance in (("rms", 0.005), ("mte", 0.02)):
        fitted, known = (each.sel(metric=metric, curve="ellipse") for each in (stored, traced))
        inside, true = (each.sel(metric=metric, curve="inscribed") for each in (stored, traced))
        for name in ("a", "b"):
            assert float(np.abs(fitted[name] / known[name] - 1.0).max()) < tolerance
        area = np.sqrt(inside["a"] * inside["b"] / true["a"] / true["b"])
        assert float(np.abs(area - 1.0).max()) < tolerance
    np.testing.assert_array_equal(stored["no_ellipse"], traced["no_ellipse"])
    np.testing.assert_allclose(stored["error_at_rest"], traced["error_at_rest"], rtol=1e-5)


def test_error_between_cells_and_nearest_cell(results, suite):
    loop = loop_of(results, suite[3], 1.0, 0.05)
    found = relative_error(loop.deviation(loop.cells(gain=1.013, delay=0.0021)), Metric.RMS)[0]
    assert float(results.reliab.errors(f=1.0, xi=0.05, gain=[1.013], delay=[0.0021])[3, 0]) == pytest.approx(
        found, rel=3e-3
    )
    nearest = results.reliab.nearest(f=1.0, xi=0.05, gain=1.013, delay=0.0021)
    assert abs(float(nearest["kp"]) - 1.013) < 0.006


def test_every_stored_window_has_its_own_errors(store, results, suite):
    arias = open_results(store, window="arias")
    assert arias.attrs["window"] == "arias"
    loop = loop_of(results, suite[0], 1.0, 0.02)
    bounds = Window.parse("arias").bounds(suite[0].acceleration, suite[0].time_step)
    inside = replace(loop, excitation=replace(loop.excitation, window=bounds))
    for dataset, asked in ((results, loop), (arias, inside)):
        at = dataset.reliab.select_structure(1.0, 0.02).isel(motion=0, kp=10, tau=-12)
        found = asked.deviation(asked.cells(gain=float(at["kp"]), delay=float(at["tau"])))
        assert float(at["rms"]) == pytest.approx(relative_error(found, Metric.RMS)[0], rel=1e-4)
    with pytest.raises(InputError, match="the store has record, arias"):
        open_results(store, window="40")


@pytest.mark.slow
def test_motions_traced_some_at_a_time_have_the_curves_of_all_together(store, monkeypatch):
    results = open_results(store)
    together = results.reliab.ellipses((0.02, 0.05), tuple(Metric))
    monkeypatch.setattr("reliab.sweep.results_accessor._MOTIONS_AT_A_TIME", 4)
    xr.testing.assert_identical(results.reliab.ellipses((0.02, 0.05), tuple(Metric)), together)


def test_contour_that_leaves_an_explicit_grid_is_not_made_up(tmp_path, suite):
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
    few = suite[:3]
    results = open_results(run_sweep(few, request, tmp_path / "paper.zarr"))
    assert results.reliab.sides == (Side.LAG,)
    with pytest.raises(InputError, match="results with leads"):
        results.reliab.ellipses(sides=(Side.LEAD,))
    stored = results.reliab.ellipses((0.02,)).sel(curve="ellipse").squeeze()
    for k, motion in enumerate(few):
        structure = request.structures[0]
        excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
        (contour,) = motion_contours(Loop(excitation=excitation, structure=structure), (0.02,))
        direct = Ellipse.fit(contour)
        if not np.isnan(stored["a"][k]):
            assert float(stored["a"][k]) == pytest.approx(direct.a, rel=0.005)
            assert float(stored["b"][k]) == pytest.approx(direct.b, rel=0.005)


def test_structure_that_was_not_simulated_is_refused(results):
    with pytest.raises(InputError, match=r"0\.5, 1"):
        results.reliab.select_structure(0.7, 0.02)


@pytest.mark.parametrize("what", ["grid", "engine", "window"])
def test_a_name_that_is_no_choice_is_refused_with_those_that_are(what):
    with pytest.raises(InputError, match=r"Unknown .*; found '?nothing"):
        sweep_request(**{what: "nothing"})


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
def test_request_that_makes_no_sense(wrong):
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
def test_grid_that_makes_no_sense(wrong):
    with pytest.raises(InputError):
        wrong()
