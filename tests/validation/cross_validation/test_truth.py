"""Containment is counted by the true error, not by the curve that was fitted to it."""

import numpy as np
import pytest

from reliab.app.api.simulation import simulate
from reliab.app.api.sources import ellipses as api_ellipses
from reliab.core.errors import InputError
from reliab.core.vocabulary import Side
from reliab.criterion.laws.registry import MANY_MOTION_LAWS
from reliab.criterion.laws.table import TabulatedLimits
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import spectral
from reliab.structures.structure import Structure
from reliab.tracking.indices.window import Window
from reliab.validation.folds import leave_one_event_out
from reliab.validation.judge import PrintedCandidate, cross_validate
from reliab.validation.truth import Cell, EllipseTruth, Region, SimulatedTruth, StoredTruth

CELL = Cell(frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")


@pytest.fixture(scope="module")
def motions():
    return list(synthetic_suite(count=6))


@pytest.fixture(scope="module")
def both_sides():
    return api_ellipses(synthetic_suite(count=6), f=[1.0], xi=[0.02], threshold=[0.05])


@pytest.fixture(scope="module")
def ellipses(both_sides):
    return both_sides.sel(side=["lag"], curve=["ellipse"])


@pytest.fixture(scope="module")
def results_path(tmp_path_factory):
    path = tmp_path_factory.mktemp("truth") / "results.zarr"
    return simulate(synthetic_suite(count=6)[:2], out=path, f=[1.0], xi=[0.02])


def spectral_error(motion, region):
    """RMS^R along an edge by the engine that neither the criterion nor its ellipses come from."""
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    excitation = Excitation(acceleration=motion.acceleration, time_step=motion.time_step)
    edge = region.edge()
    deviation = spectral.deviation(excitation, structure, edge.gain, edge.delay)
    return np.sqrt(deviation.mean_square) / deviation.ideal_peak


def test_edge_is_the_ellipse_and_closes_on_the_axis_of_no_delay():
    late, early = (Region(a=1e-4, b=4.0, side=side) for side in Side)
    edge = late.edge()
    np.testing.assert_allclose((edge.gain - 1.0) ** 2 / 1e-4 + (1e3 * edge.delay) ** 2 / 4.0, 1.0)
    assert edge.delay[0] == edge.delay[-1] == 0.0
    assert edge.delay.max() == pytest.approx(2e-3)
    np.testing.assert_array_equal(early.edge().delay, -edge.delay)


def test_simulated_and_stored_truth_agree_with_the_spectral_engine(motions, results_path):
    region = Region(a=1e-4, b=2.0)
    edge = region.edge()
    for number, motion in enumerate(motions[:2]):
        exact = spectral_error(motion, region) / 0.05
        for truth in (SimulatedTruth(motions=motions), StoredTruth(results_path)):
            np.testing.assert_allclose(truth.errors(CELL, number, edge.gain, edge.delay), exact, rtol=2e-3)


def test_values_outside_the_store_are_unknown(results_path):
    errors = StoredTruth(results_path).errors(CELL, 0, np.array([1.0, 1.0]), np.array([0.001, 0.5]))
    assert np.isfinite(errors).tolist() == [True, False]


def test_ellipses_judge_the_actuators_of_their_own_side(both_sides):
    fit = both_sides.sel(curve=["ellipse"])
    delay = np.array([0.001, -0.001])
    result = EllipseTruth(fit).errors(CELL, 2, np.ones(2), delay)
    b = [float(fit["b"].sel(side=side).squeeze()[2]) for side in ("lag", "lead")]
    assert abs(b[1] / b[0] - 1.0) > 0.1
    np.testing.assert_allclose(result, 1.0 / np.sqrt(b))


def test_window_changes_the_truth(motions):
    edge = Region(a=1e-4, b=2.0).edge()
    complete, strong = (
        SimulatedTruth(motions=motions, window=Window.parse(text)).errors(CELL, 0, edge.gain, edge.delay)
        for text in ("record", "arias")
    )
    assert (strong[1:-1] > complete[1:-1]).all()


def test_flattering_ellipse_does_not_contain_the_criterion(motions, ellipses):
    original = [float(ellipses[name].min()) for name in ("a", "b")]
    law = TabulatedLimits.fit([1.0], [0.02], [[0.98 * original[0]]], [[0.98 * original[1]]])
    flattering = ellipses.assign(a=1e3 * ellipses["a"], b=1e3 * ellipses["b"])
    validation = cross_validate(
        flattering,
        leave_one_event_out(ellipses["event"].values),
        [
            PrintedCandidate(
                name="printed", law=law.fit([1.0], [0.02], [[100 * original[0]]], [[100 * original[1]]])
            )
        ],
        scheme="test",
        confidences=(0.95,),
        truth=SimulatedTruth(motions=motions),
        trials=64,
    )
    assert validation.containment_by_ellipse()["rate"].item() == 1.0
    assert validation.containment()["rate"].item() == 0.0
    assert validation.truth == "simulated"


def test_containment_is_the_share_of_motions_with_no_error_above_along_the_edge(motions, ellipses):
    a, b = (float(ellipses[name].median()) for name in ("a", "b"))
    reference = [spectral_error(motion, Region(a=a, b=b)).max() <= 0.05 for motion in motions]
    validation = cross_validate(
        ellipses,
        leave_one_event_out(ellipses["event"].values),
        [PrintedCandidate(name="printed", law=TabulatedLimits.fit([1.0], [0.02], [[a]], [[b]]))],
        scheme="test",
        confidences=(0.95,),
        truth=SimulatedTruth(motions=motions),
        trials=64,
    )
    assert validation.counts["contained"].sel(side="lag").values.ravel().tolist() == reference
    assert 0 < sum(reference) < 6


def test_motions_without_an_ellipse_are_judged_by_their_errors_only(motions, ellipses):
    unknown = ellipses.copy(deep=True)
    unknown["a"][0] = -1.0
    law = TabulatedLimits.fit([1.0], [0.02], [[1e-6]], [[0.01]])
    for truth, verdict in ((SimulatedTruth(motions=motions), 6), (EllipseTruth(unknown), 5)):
        counts = cross_validate(
            unknown,
            leave_one_event_out(ellipses["event"].values),
            [PrintedCandidate(name="printed", law=law)],
            scheme="test",
            confidences=(0.95,),
            truth=truth,
            trials=64,
        ).counts.sum()
        assert int(counts["judged"]) == verdict
        assert int(counts["fitted"]) == 5
        assert int(counts["judged"] + counts["unresolved"]) == 6


def test_leads_are_judged_by_their_own_limits_and_errors(motions, both_sides):
    original = {
        side: [0.999 * float(both_sides[name].sel(side=side, curve="inscribed").min()) for name in ("a", "b")]
        for side in ("lag", "lead")
    }
    assert original["lead"][1] > 1.1 * original["lag"][1]
    laws = {side: TabulatedLimits.fit([1.0], [0.02], [[a]], [[b]]) for side, (a, b) in original.items()}
    candidates = [
        PrintedCandidate(name="each side", law=laws["lag"], lead_law=laws["lead"]),
        PrintedCandidate(name="lag limits of leads", law=laws["lead"], lead_law=laws["lead"]),
    ]
    validation = cross_validate(
        both_sides,
        leave_one_event_out(both_sides["event"].values),
        candidates,
        scheme="test",
        confidences=(0.95,),
        truth=SimulatedTruth(motions=motions),
        trials=64,
    )
    lag, lead = (validation.containment(side=side)["rate"].squeeze().values for side in Side)
    assert lag[0] == lead[0] == lead[1] == 1.0
    assert lag[1] < 1.0


def test_threshold_kept_at_rest_is_refused(motions, both_sides):
    rest_error = both_sides.assign(error_at_rest=0.1 * both_sides["error_at_rest"])
    law = TabulatedLimits.fit([1.0], [0.02], [[1e-6]], [[0.01]])
    with pytest.raises(InputError, match="does not move"):
        cross_validate(
            rest_error,
            leave_one_event_out(both_sides["event"].values),
            [PrintedCandidate(name="printed", law=law)],
            scheme="test",
            confidences=(0.95,),
            truth=SimulatedTruth(motions=motions),
            trials=64,
        )


def test_a_law_of_the_paper_counts_leads_as_lags_and_other_laws_say_nothing_of_them():
    silent, output = (
        PrintedCandidate(name="law", law=law).learn(None, 0.05, "rms", [0.95])[0.95].regions(CELL)
        for law in (TabulatedLimits.fit([1.0], [0.02], [[1e-4]], [[1.0]]), MANY_MOTION_LAWS["guo_2017_18"])
    )
    assert [region.side for region in silent] == [Side.LAG]
    assert [region.side for region in output] == [Side.LAG, Side.LEAD]
    assert output[0].b == output[1].b
