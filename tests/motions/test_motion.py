"""A ground motion: checks and outline."""

import hashlib
import pickle
import struct
from dataclasses import replace

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion, are_copies, arias_times, outline_of, resample

G = STANDARD_GRAVITY


def motion(**changes: object) -> Motion:
    arguments: dict[str, object] = {"name": "a", "acceleration": [0.0, 1.0, -2.0], "time_step": 0.5} | changes
    return Motion(**arguments)


def test_samples_are_a_read_only_contiguous_copy() -> None:
    original = np.arange(10.0)[::2]
    duplicate = motion(acceleration=original).acceleration
    original[0] = 7.0
    assert duplicate[0] == 0.0
    assert duplicate.dtype == np.float64
    assert duplicate.flags.c_contiguous
    with pytest.raises(ValueError, match="read-only"):
        duplicate[0] = 1.0


def test_properties_follow_from_the_samples() -> None:
    record = motion()
    assert record.duration == 1.0
    assert record.peak_acceleration == 2.0
    assert record.times.tolist() == [0.0, 0.5, 1.0]


def test_a_motion_without_event_is_an_event_of_its_own() -> None:
    assert motion().event == "a"
    assert motion(event="KOBE").event == "KOBE"


def test_checksum_is_of_little_endian_doubles() -> None:
    expected = hashlib.sha256(struct.pack("<4d", 0.5, 0.0, 1.0, -2.0)).hexdigest()
    assert motion().checksum == expected
    assert motion(name="b").checksum == expected
    assert motion(time_step=0.25).checksum != expected


def test_equal_motions_are_equal_and_hash_alike() -> None:
    assert motion() == motion()
    assert hash(motion()) == hash(motion())
    assert motion() != motion(event="other")
    assert motion() != motion(acceleration=[0.0, 1.0, -2.5])
    assert motion() != "a"


def test_a_motion_survives_pickling() -> None:
    assert pickle.loads(pickle.dumps(motion())) == motion()  # noqa: S301 - our own bytes


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"acceleration": [1.0]}, "at least two samples"),
        ({"acceleration": [[1.0, 2.0]]}, "one-dimensional"),
        ({"acceleration": [0.0, np.nan]}, r"finite number; found nan at sample 1"),
        ({"acceleration": [-np.inf, 0.0]}, r"finite number; found -inf at sample 0"),
        ({"acceleration": [0.0, -5.01 * G]}, r"above 5 g; found 5.01 g"),
        ({"time_step": 0.0}, "time step must be between"),
        ({"time_step": -0.01}, "time step must be between"),
        ({"time_step": np.nan}, "time step must be between"),
        ({"time_step": np.inf}, "time step must be between"),
        ({"name": ""}, "must have a name"),
    ],
)
def test_invalid_motion_is_refused(changes: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        motion(**changes)


def test_a_peak_of_five_g_is_allowed() -> None:
    assert motion(acceleration=[0.0, 5.0 * G]).peak_acceleration == 5.0 * G


@pytest.fixture(scope="module")
def motions():
    return list(load_motions("synthetic")[:20])


def outlines_of(motions):
    return [outline_of(motion.acceleration, motion.time_step) for motion in motions]


def significant_duration(motion, low, high):
    begin, end = arias_times(motion.acceleration, motion.time_step, [low, high]) / motion.time_step
    return motion.acceleration[round(begin) : round(end) + 1]


@pytest.mark.parametrize(
    "change",
    [
        lambda motion: replace(motion, acceleration=1.7 * motion.acceleration),
        lambda motion: replace(motion, acceleration=-motion.acceleration),
        lambda motion: replace(motion, acceleration=significant_duration(motion, 0.02, 0.98)),
        lambda motion: replace(
            motion, acceleration=np.concatenate([np.zeros(500), motion.acceleration, np.zeros(900)])
        ),
        lambda motion: resample(motion, 1024.0),
    ],
    ids=["scaled", "reversed", "trimmed", "padded", "resampled"],
)
def test_a_copy_is_recognised_and_no_other_record(motions, change):
    outlines = outlines_of(motions)
    copies = outlines_of(map(change, motions))
    result = are_copies(outlines, copies)
    assert not result[~np.eye(len(motions), dtype=bool)].any()
    assert result.diagonal().sum() >= len(motions) - 1  # of two equal swings the other may be the strongest


@pytest.mark.slow
def test_no_two_of_a_hundred_real_records_are_copies(real_motions_folder):
    outlines = outlines_of(load_motions(real_motions_folder))
    np.testing.assert_array_equal(are_copies(outlines, outlines), np.eye(len(outlines), dtype=bool))
