"""A specimen whose force nobody recorded: its error if it yielded, against simulations by another code."""

from dataclasses import replace

import numpy as np
import pytest
from rebuilt_error.laboratory import DELAY, HYSTERESIS, RATE, Lab, run, synthetic_ground

from reliab.assessment.budget.sizes import Source, ordinary_equipment
from reliab.assessment.error_of_test import Question, error_of_test
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
LAB = Lab(1.2, 0.04, 0.8, DELAY, (0.995, 0.002, 0.0, 0.0))
STRUCTURE = Structure(frequency=1.2, damping_ratio=0.04, experimental_fraction=0.8)
ORDINARY = ordinary_equipment()


def asked(**changes):
    given = {"structure": STRUCTURE, "stated": {}, "equipment": ORDINARY, "metric": Metric.RMS}
    return Question(**{**given, "threshold": 0.05, "model": None, "seed": 0, **changes})


@pytest.fixture(scope="module")
def yielded():
    """A test of a specimen that yielded at a third of what it would have reached."""
    displacement = float(np.abs(run(LAB, synthetic_ground(2, 15.0)).command).max()) / 3.0
    return run(replace(LAB, specimen=HYSTERESIS, shape=(displacement, 0.03, 8.0)), synthetic_ground(2, 15.0))


@pytest.fixture(scope="module")
def recording(yielded):
    return Recording(command=yielded.command, measured=yielded.measured, time_step=STEP)


@pytest.fixture(scope="module", autouse=True)
def _without_posterior():
    """Where no posterior is determined, draws of specimens that yield widen the interval."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reliab.assessment.inferred_error.infer_error", lambda *_, **__: None)
        yield


@pytest.fixture(scope="module")
def error(recording, _without_posterior):
    return error_of_test(recording, asked())


@pytest.mark.slow
def test_the_interval_holds_the_error_of_a_specimen_that_yielded(yielded, recording, error):
    assert error.rebuilt.rms.low < yielded.rms < error.rebuilt.rms.high
    linear = error_of_test(recording, asked(linear_specimen=True))
    assert linear.if_linear is None
    assert linear.rebuilt.rms.value == error.rebuilt.rms.value
    assert np.array_equal(linear.rebuilt.draws.rms, error.if_linear.rms)
    assert error.rebuilt.rms.low < linear.rebuilt.rms.value


def test_the_interval_holds_that_of_a_linear_specimen(error):
    """Of errors of specimens that stayed linear nine of ten lie in it as well."""
    for metric in Metric:
        low, high = error.if_linear.interval(metric)
        assert error.estimate(metric).low <= low
        assert error.estimate(metric).high >= high


def test_the_budget_names_it_with_what_would_show_it(error):
    item = next(item for item in error.budget if item.name == "yielding")
    assert item.source is Source.DEFAULT
    assert "Record the force" in item.remedy
    assert item.contribution > 0.0


def test_a_recorded_force_a_model_and_exact_equipment_leave_nothing_open(yielded, recording):
    assert asked().yielding(recording) == ORDINARY.yielding
    assert asked(linear_specimen=True).yielding(recording) == 0.0
    assert asked(equipment=None).yielding(recording) == 0.0
    assert asked(measured_specimen=True).yielding(recording) == 0.0
    assert asked().yielding(replace(recording, force=yielded.force)) == 0.0


@pytest.mark.parametrize("threshold", [0.5, 1.5])
def test_the_probability_is_the_less_certain_of_with_and_without(error, threshold):
    level = threshold * float(np.median(error.rebuilt.draws.rms))
    moved = replace(error, threshold=level)
    both = [d.probability_below(level, Metric.RMS) for d in (error.rebuilt.draws, error.if_linear)]
    assert abs(moved.probability - 0.5) == pytest.approx(min(abs(p - 0.5) for p in both))


def test_draws_of_two_kinds_have_their_shares_and_the_moments_of_both():
    rng = np.random.default_rng(3)
    one, other = (
        Spread(rms=r, mte=2.0 * r, mean=np.array([m]), deviation=np.array([s]))
        for r, m, s in ((rng.uniform(1.0, 2.0, 256), 1.0, 0.5), (rng.uniform(5.0, 6.0, 64), 4.0, 0.1))
    )
    both = one.together(other, 0.4)
    weights = both.weights()
    assert weights.mean() == pytest.approx(1.0)
    assert weights[256:].sum() / weights.sum() == pytest.approx(0.4)
    assert both.probability_below(3.0, Metric.RMS) == pytest.approx(0.6, abs=0.01)
    drawn = np.concatenate([rng.normal(1.0, 0.5, 60_000), rng.normal(4.0, 0.1, 40_000)])
    assert both.mean[0] == pytest.approx(drawn.mean(), rel=0.01)
    assert both.deviation[0] == pytest.approx(drawn.std(), rel=0.01)
    average = np.average(both.mte, weights=weights)
    assert both.average(Metric.MTE) == pytest.approx(average)
    parts = 0.6 * one.average(Metric.MTE) + 0.4 * other.average(Metric.MTE)
    assert both.average(Metric.MTE) == pytest.approx(parts)
