"""The page draws x_c − x_m from the distribution from which Python draws it."""

import numpy as np
import pytest

from reliab.assessment.rebuilt_error.difference_draws import draw_differences
from reliab.assessment.rebuilt_error.lapped_transform import analyse
from reliab.assessment.rebuilt_error.noise import estimate_noise
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.signals import converter_step
from reliab.vocabulary import Metric

STEP = 0.01
DRAWS = 256


@pytest.mark.parametrize(("size", "hop"), [(101, 16), (97, 22), (60, 30), (500, 64)])
def test_lapped_transform_and_back(by_javascript, size, hop):
    values = np.cumsum(np.random.default_rng(hop).standard_normal(size))
    (answer,) = by_javascript(("lapped", {"values": values.tolist(), "hop": hop}))
    np.testing.assert_allclose(answer["coefficients"], analyse(values, hop), atol=1e-10)
    np.testing.assert_allclose(answer["history"], values, atol=1e-10)


def test_steps_of_a_rounded_reading(by_javascript):
    motion = np.sin(np.arange(0.0, 20.0, 0.01))
    readings = [0.05 * np.round(motion / 0.05), motion, np.round(motion, 4)]
    answers = by_javascript(*[("rounding", {"values": reading.tolist()}) for reading in readings])
    assert answers == pytest.approx([converter_step(reading) for reading in readings], rel=1e-9)
    assert answers[0] == pytest.approx(0.05)


def test_weights_interval_and_probability_of_draws(by_javascript):
    errors = np.abs(0.03 + 0.02 * np.random.default_rng(1).standard_normal((2, DRAWS)))
    spread = Spread(rms=errors[0], mte=errors[1], mean=np.zeros(1), deviation=np.zeros(1))
    (answer,) = by_javascript(("spread", {"rms": errors[0].tolist(), "mte": errors[1].tolist()}))
    for name in Metric:
        assert answer[name]["interval"] == pytest.approx(spread.interval(name), rel=1e-12)
        assert answer[name]["probability"] == pytest.approx(spread.probability_below(0.03, name), rel=1e-12)


def readings():
    """Command and reading: white noise, slow noise beside it, and a sensor that reads in coarse steps."""
    time = np.arange(3000) * STEP
    generator = np.random.default_rng(5)
    command = 0.01 * np.sin(7.0 * time) * np.sin(0.1 * time) ** 2 * (1.0 + 0.3 * np.sin(1.3 * time))
    moved = 0.99 * np.interp(time - 0.004, time, command)
    white = 5e-5 * generator.standard_normal(time.size)
    slow = np.convolve(
        generator.standard_normal(time.size + 199), np.exp(-0.05 * np.arange(200)), mode="valid"
    )
    yield "white", command, moved + white
    yield "slow", command, moved + 0.2 * white + 3e-5 * slow
    yield "steps", command, 2e-4 * np.round(moved / 2e-4)


@pytest.mark.parametrize(
    ("command", "read"), [case[1:] for case in readings()], ids=["white", "slow", "steps"]
)
def test_draws_have_the_moments_of_python(by_javascript, command, read):
    """Mean and standard deviation over the draws at each sample, for both kinds of draws."""
    noise = estimate_noise(command, read, STEP)
    python = draw_differences(command, read, noise, 1.0, 2, DRAWS, 0)
    again = draw_differences(command, read, noise, 1.0, 2, DRAWS, 1)
    question = {"command": command.tolist(), "measured": read.tolist(), "step": STEP, "every": 2}
    (page,) = by_javascript(("draws", {**question, "frequency": 1.0, "draws": DRAWS}))
    page = np.array(page)
    assert page.shape == python.shape
    for kind in (slice(0, None, 2), slice(1, None, 2)):
        spread = python[kind].std(axis=0)
        typical = np.sqrt(np.mean(spread**2))
        unlike = np.sqrt(np.mean((page[kind].mean(axis=0) - python[kind].mean(axis=0)) ** 2)) / typical
        by_chance = np.sqrt(np.mean((again[kind].mean(axis=0) - python[kind].mean(axis=0)) ** 2)) / typical
        assert by_chance < 0.3
        assert unlike < 1.5 * by_chance
        ratio = np.sqrt(np.mean(page[kind].std(axis=0) ** 2)) / typical
        assert ratio == pytest.approx(1.0, abs=0.05)
