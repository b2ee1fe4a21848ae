"""A test is judged over the part of its ground motion that it saw, wherever that begins."""

from types import SimpleNamespace

import numpy as np
import pytest

from reliab.assessment import own_motion
from reliab.assessment.assess import assess
from reliab.assessment.tracking_index import LEVEL
from reliab.core.vocabulary import Side
from reliab.motions.motion import Motion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)


@pytest.fixture(scope="module")
def simulate(simulate_rig):
    return simulate_rig


@pytest.fixture(scope="module")
def motion(ground_motions):
    return ground_motions[3]


def assess_motion(test, motion, *, ground=False, begin=0.0, **options):
    first = round(begin * 256.0)
    recording = Recording(
        command=test.command[first:],
        measured=test.measured[first:],
        time_step=1.0 / 256.0,
        ground=test.ground[first:] if ground else None,
    )
    return assess(recording, ONE_HERTZ, motion=motion, **options)


def error_of(test, begin):
    first = round(begin * 256.0)
    error = (test.measured - test.ideal)[first:]
    return np.sqrt(np.mean(error**2)) / np.abs(test.ideal[first:]).max()


def test_a_test_shorter_than_its_record_is_judged_over_its_own_duration(motion, simulate):
    test = simulate(motion.acceleration, motion.time_step, seconds=25.0, delay=0.002)
    own_value = assess_motion(test, motion).placement
    assert own_value.window == pytest.approx((0.0, 25.0), abs=0.01)
    assert own_value.error == pytest.approx(test.rms, rel=0.02)


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("ground", [False, True])
def test_test_beginning_in_motion_is_found_in_its_record(motion, ground, simulate):
    test = simulate(motion.acceleration, motion.time_step, seconds=30.0, gain=0.998, delay=0.0008)
    own_value = assess_motion(test, motion, begin=7.0, ground=ground).placement
    assert own_value.alignment.matched
    assert own_value.alignment.begin == pytest.approx(7.0, abs=0.01)
    assert not own_value.alignment.from_rest
    assert own_value.alignment.by == ("ground acceleration" if ground else "response")
    assert own_value.error == pytest.approx(error_of(test, 7.0), rel=0.05)


@pytest.mark.slow
def test_a_part_of_the_record_from_rest_is_found_too(motion, simulate):
    first = 8.3
    later = np.interp(np.arange(0.0, 20.0, motion.time_step) + first, motion.times, motion.acceleration)
    test = simulate(later, motion.time_step, seconds=19.9, gain=0.997, delay=0.0005)
    own_value = assess_motion(test, motion).placement
    assert own_value.alignment.begin == pytest.approx(first, abs=0.01)
    assert own_value.alignment.from_rest
    assert own_value.error == pytest.approx(test.rms, rel=0.05)


def test_rest_before_the_record_belongs_to_the_test(motion, simulate):
    still = np.concatenate([np.zeros(round(5.0 / motion.time_step)), motion.acceleration])
    test = simulate(still, motion.time_step, delay=0.001)
    own_value = assess_motion(test, motion).placement
    assert own_value.alignment.begin == pytest.approx(-5.0, abs=0.01)
    assert own_value.error == pytest.approx(test.rms, rel=0.03)


def test_another_motion_is_said_not_to_be_found(motion, ground_motions, simulate):
    second = ground_motions[0]
    result = assess_motion(simulate(second.acceleration, second.time_step, seconds=25.0, delay=0.001), motion)
    assert not result.placement.alignment.matched
    assert any("was not found in the record" in warning for warning in result.warnings)


def test_a_scaled_record_is_found_by_shape_and_said_so(motion, simulate):
    test = simulate(0.3 * motion.acceleration, motion.time_step, seconds=25.0, delay=0.001)
    result = assess_motion(test, motion)
    assert result.placement.alignment.begin == pytest.approx(0.0, abs=0.01)
    assert any("has the shape, but not the size" in warning for warning in result.warnings)


@pytest.mark.slow
def test_a_lead_is_judged_by_the_exact_loop_that_leads(motion, simulate):
    test = simulate(motion.acceleration, motion.time_step, seconds=30.0, lead=0.002)
    result = assess_motion(test, motion)
    assert result.tracking.delay < 0.0
    assert result.placement.error == pytest.approx(test.rms, rel=0.03)
    mirror = simulate(motion.acceleration, motion.time_step, seconds=30.0, delay=0.002)
    assert mirror.rms > 1.15 * test.rms  # |d| would have overstated it
    assert result.placement.b > assess_motion(mirror, motion).placement.b


def test_own_motion_may_be_longer_or_shorter_than_the_test(motion, simulate):
    short = Motion(name="short", acceleration=motion.acceleration[:2000], time_step=motion.time_step)
    test = simulate(short.acceleration, short.time_step, seconds=short.duration + 10.0, delay=0.001)
    assert assess_motion(test, short).placement.error == pytest.approx(test.rms, rel=0.03)


def test_interval_on_the_own_motion_follows_draws_of_gain_and_delay(monkeypatch):
    class Boundary:
        """Whose error is the gain's distance from one, and grows with the delay."""

        def __init__(self, **_given):
            pass

        def error(self, gain, delay):
            return np.abs(gain - 1.0) + delay

        def index(self, _gain, _delay):
            return 0.5

        def ellipse(self, side):
            return (1.0, 2.0) if side is Side.LAG else (3.0, 4.0)

    monkeypatch.setattr(own_motion, "OwnBoundary", Boundary)
    monkeypatch.setattr(own_motion, "_excitation", lambda *_given: (None, (1.0, 9.0)))
    draws = np.stack([1.0 + np.linspace(0.01, 0.05, 101), np.full(101, 0.002)])
    for delay, ellipse in ((0.002, (1.0, 2.0)), (-0.002, (3.0, 4.0))):
        tracking = SimpleNamespace(amplitude=1.03, delay=delay, draws=draws)
        question = SimpleNamespace(structure=None, threshold=0.042, metric="rms")
        placement = own_motion.place_on_own(SimpleNamespace(name="m"), tracking, None, question)
        ends = 0.012 + 0.04 * np.array([0.5 - 0.5 * LEVEL, 0.5 + 0.5 * LEVEL])
        np.testing.assert_allclose(placement.error_interval, ends)
        assert placement.error == pytest.approx(0.03 + delay)
        np.testing.assert_allclose(placement.index_interval, 0.5 * (ends / placement.error) ** 2)
        assert placement.probability == pytest.approx(np.mean(draws[0] - 1.0 + 0.002 <= 0.042))
        assert (placement.a, placement.b) == ellipse
