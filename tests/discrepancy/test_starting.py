"""Records that begin in motion are judged after their first swing; ends that nothing answers are left out."""

import numpy as np
import pytest

from reliab.discrepancy.campaign.campaign import Stretch
from reliab.discrepancy.spectra.segment import skip_end, skip_transient
from reliab.simulation.hybrid_test.open_loop import Motion3

STEP = 0.005
TIME = np.arange(0.0, 20.0, STEP)


def begin_of(displacement):
    whole = Stretch(test=0, begin=0, end=TIME.size)
    return skip_transient([whole], [Motion3.interpolate(displacement, STEP)])[0].begin * STEP


def test_a_record_that_starts_at_rest_counts_whole():
    assert begin_of(np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 20.0) ** 2) == 0.0


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.5])
def test_a_record_that_starts_in_motion_counts_after_a_swing(phase):
    assert 1.0 <= begin_of(np.sin(2.0 * np.pi * TIME + phase)) <= 1.6


def test_a_slow_start_takes_at_most_a_fifth():
    assert begin_of(np.sin(2.0 * np.pi * 0.05 * TIME)) == pytest.approx(4.0, abs=0.01)


def test_a_stretch_within_a_record_keeps_its_begin():
    inner = Stretch(test=0, begin=700, end=TIME.size)
    assert skip_transient([inner], [Motion3.interpolate(np.sin(TIME), STEP)]) == (inner,)


def test_a_free_vibration_that_started_before_is_waited_for():
    whole = Stretch(test=0, begin=0, end=TIME.size)
    moving = [Motion3.interpolate(np.cos(2.0 * np.pi * TIME + 1.0), STEP)]
    assert skip_transient([whole], moving, 3.0)[0].begin * STEP == pytest.approx(3.0, abs=STEP)
    assert skip_transient([whole], moving, 60.0)[0].begin * STEP == pytest.approx(4.0, abs=STEP)  # a fifth
    resting = [Motion3.interpolate(np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 20.0) ** 2, STEP)]
    assert skip_transient([whole], resting, 3.0)[0].begin == 0


@pytest.mark.parametrize(
    ("unanswered", "end"), [(0.0, 20.0), (0.2, 19.8), (30.0, 16.0)], ids=["none", "short", "a fifth at most"]
)
def test_the_end_that_nothing_answers_is_left_out(unanswered, end):
    motions = [Motion3.interpolate(np.sin(TIME), STEP)]
    whole, inner = Stretch(test=0, begin=0, end=TIME.size), Stretch(test=0, begin=100, end=400)
    late = Stretch(test=0, begin=TIME.size - 2, end=TIME.size)
    shortened, kept, last = skip_end([whole, inner, late], motions, unanswered)
    assert shortened.begin == 0
    assert shortened.end * STEP == pytest.approx(end, abs=STEP)
    assert kept == inner
    assert last == late
