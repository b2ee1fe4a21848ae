"""Tests that are left out judge a model only where the others determine its effects."""

import numpy as np
import pytest

from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.fitting import left_out
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import screen_effects
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.segment import cut_segments, motions_of, scales_of

RATE, STROKE, NOISE = 256.0, 0.02, 2e-5
TIME = np.arange(0.0, 10.0, 1.0 / RATE)
AMPLITUDES = (0.012, 0.012, 0.012, 0.03)


@pytest.fixture(scope="module")
def models():
    """All models of an actuator that meets the end of its stroke in the last of four tests."""
    random = np.random.default_rng(4)
    tests = []
    for place, amplitude in enumerate(AMPLITUDES):
        command = amplitude * np.sin(2.0 * np.pi * (0.8 + 0.1 * place) * TIME) * np.sin(np.pi * TIME / 10.0)
        reading = np.clip(command, -STROKE, STROKE) + NOISE * random.normal(size=TIME.size)
        channels = {Channel.COMMAND: command, Channel.MEASURED: reading}
        tests.append(MeasuredTest(file=f"{place}", motion="sine", held_out=False, channels=channels))
    campaign = Campaign(
        name="sines", structure=None, mass=1.0, actuator=None, specimen=None, rate=RATE, tests=tuple(tests)
    )
    block = ActuatorBlock(campaign, scales_of(campaign, motions_of(campaign)))
    problem = Problem(
        block=block,
        segments=cut_segments(campaign.training, RATE, block.highest_of, block.sketch.every),
    )
    search = Search(problem)
    search.extend(search.null, screen_effects(problem, search.null, block.candidates, search.null)[:2])
    return search


def test_limit_of_one_test_is_not_judged_without_it(models: Search):
    limited_model = models.fitted[frozenset(["stroke_saturation"])]
    error = models.error(limited_model)
    assert error.foretold.tolist() == [True, True, True, False]
    assert error.relative[3] > 100.0 * error.relative[:3].max()
    assert error.is_at_most(1.02, models.error(models.null))
    assert models.error(models.null).foretold.all()


@pytest.mark.parametrize(("foreseen", "left"), [(3.9, 4.0), (2.0, 1.0)])
def test_model_is_fitted_in_full_where_a_step_leaves_more_than_foreseen(
    models: Search, monkeypatch: pytest.MonkeyPatch, foreseen: float, left: float
):
    """A step leaves 4 of each test, and a whole fit without it 1."""
    size = models.null.space.size
    monkeypatch.setattr(left_out, "refit", lambda *_: np.zeros(size))
    monkeypatch.setattr(left_out, "_refit_fully", lambda *_: np.ones(size))
    monkeypatch.setattr(left_out, "_foreseen_energy", lambda *_: foreseen)
    monkeypatch.setattr(left_out, "_residual_energy", lambda _p, _s, x, _segments: 1.0 if x.all() else 4.0)
    assert left_out.leave_out(models.problem, models.null).energies.tolist() == [left] * len(AMPLITUDES)


def test_derivatives_foresee_what_a_linear_model_leaves(models: Search):
    """Gain and delay by a little: the energy is that of the residual, which is nearly linear in them."""
    problem, fit = models.problem, models.null
    rows = problem.owners == 1
    coordinates = fit.coordinates + 1e-3
    foreseen = left_out._foreseen_energy(problem, fit, rows, coordinates)  # noqa: SLF001 - what is tested
    energy = left_out._residual_energy(problem, fit.space, coordinates, problem.segments[1:2])  # noqa: SLF001
    assert foreseen == pytest.approx(energy, rel=0.01)
