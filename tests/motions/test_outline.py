"""Copies of records are recognised by their outlines, whatever was done to them."""

from dataclasses import replace

import numpy as np
import pytest

from reliab.motions.intensity import arias_times
from reliab.motions.loading import load_motions
from reliab.motions.motion import resample
from reliab.motions.outline import are_copies, outline_of


@pytest.fixture(scope="module")
def motions():
    return list(load_motions("synthetic")[:20])


def between(motion, low, high):
    begin, end = arias_times(motion.acceleration, motion.time_step, [low, high]) / motion.time_step
    return motion.acceleration[round(begin) : round(end) + 1]


@pytest.mark.parametrize(
    "change",
    [
        lambda motion: replace(motion, acceleration=1.7 * motion.acceleration),
        lambda motion: replace(motion, acceleration=-motion.acceleration),
        lambda motion: replace(motion, acceleration=between(motion, 0.02, 0.98)),
        lambda motion: replace(
            motion, acceleration=np.concatenate([np.zeros(500), motion.acceleration, np.zeros(900)])
        ),
        lambda motion: resample(motion, 1024.0),
    ],
    ids=["scaled", "reversed", "trimmed", "padded", "resampled"],
)
def test_a_copy_is_recognised_and_no_other_record(motions, change):
    outlines = [outline_of(motion) for motion in motions]
    copies = [outline_of(change(motion)) for motion in motions]
    found = are_copies(outlines, copies)
    assert not found[~np.eye(len(motions), dtype=bool)].any()
    assert found.diagonal().sum() >= len(motions) - 1  # of two equal swings the other may be the strongest


@pytest.mark.slow
def test_no_two_of_a_hundred_real_records_are_copies(real_motions_folder):
    outlines = [outline_of(motion) for motion in load_motions(real_motions_folder)]
    np.testing.assert_array_equal(are_copies(outlines, outlines), np.eye(len(outlines), dtype=bool))
