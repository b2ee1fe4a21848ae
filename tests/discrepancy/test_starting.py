"""Records that begin in motion are judged after their first swing; ends that nothing answers are left out."""

import numpy as np
import pytest

from reliab.discrepancy.campaign.campaign import Stretch
from reliab.discrepancy.segment import skip_end, skip_transient
from reliab.simulation.hybrid_test.open_loop import Motion3

STEP = 0.005
TIME = np.arange(0.0, 20.0, STEP)


def begin_of(displacement):
    stretch = Stretch(test=0, begin=0, end=TIME.size)
    return skip_transient([stretch], [Motion3.interpolate(displacement, STEP)])[0].begin * STEP


def test_record_from_rest_counts_whole():
    assert begin_of(np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 20.0) ** 2) == 0.0


@pytest.mark.parametrize("phase", [0.0, 1.0, 2.5])
def test_record_from_motion_counts_after_a_swing(phase):
    assert 1.0 <= begin_of(np.sin(2.0 * np.pi * TIME + phase)) <= 1.6


def test_a_slow_start_takes_at_most_a_fifth():
    assert begin_of(np.sin(2.0 * np.pi * 0.05 * TIME)) == pytest.approx(4.0, abs=0.01)


def test_a_stretch_within_a_record_keeps_its_begin():
    inner = Stretch(test=0, begin=700, end=TIME.size)
    assert skip_transient([inner], [Motion3.interpolate(np.sin(TIME), STEP)]) == (inner,)


def test_earlier_free_vibration_is_waited_for():
    stretch = Stretch(test=0, begin=0, end=TIME.size)
    moving = [Motion3.interpolate(np.cos(2.0 * np.pi * TIME + 1.0), STEP)]
    assert skip_transient([stretch], moving, 3.0)[0].begin * STEP == pytest.approx(3.0, abs=STEP)
    assert skip_transient([stretch], moving, 60.0)[0].begin * STEP == pytest.approx(4.0, abs=STEP)  # a fifth
    resting = [Motion3.interpolate(np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 20.0) ** 2, STEP)]
    assert skip_transient([stretch], resting, 3.0)[0].begin == 0


@pytest.mark.parametrize(
    ("unanswered_time", "end"),
    [(0.0, 20.0), (0.2, 19.8), (30.0, 16.0)],
    ids=["none", "short", "a fifth at most"],
)
def test_unanswered_end_is_left_out(unanswered_time, end):
    motions = [Motion3.interpolate(np.sin(TIME), STEP)]
    stretch, inner = Stretch(test=0, begin=0, end=TIME.size), Stretch(test=0, begin=100, end=400)
    late = Stretch(test=0, begin=TIME.size - 2, end=TIME.size)
    shortened_stretch, kept_stretch, last = skip_end([stretch, inner, late], motions, unanswered_time)
    assert shortened_stretch.begin == 0
    assert shortened_stretch.end * STEP == pytest.approx(end, abs=STEP)
    assert kept_stretch == inner
    assert last == late
