"""Recognition of a record that was scaled, reversed, trimmed, padded or resampled.

What stands around the strongest swing of a record stays when any of that is done to it. Its correlations with
fixed patterns have signs, 256 bits, that differ in proportion to the angle between two such stretches
(Charikar 2002); those of unrelated records differ in half of the bits. No record can be rebuilt from them.

Charikar, M. S. (2002). Similarity estimation techniques from rounding algorithms. *Proceedings of the 34th
ACM Symposium on Theory of Computing*, 380-388.
"""

from collections.abc import Iterable
from functools import cache

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.motions.motion import Motion

_CORNER = 4.0  # Hz, above which filters and time steps of two versions of a record differ
_OF_SAMPLING = 0.4  # the same as a share of the sampling rate, for long steps
_REACH = 3.0  # s, on either side of the strongest swing
_POINTS = 151
_BITS = 256
_ALIKE = 36  # bits that may differ in a copy; the most alike of 200 unrelated records differ in 46


def outline_of(motion: Motion) -> str:
    """Describe the strongest swing of a record in 64 hexadecimal digits, whatever its scale and length.

    >>> t = np.arange(0.0, 30.0, 0.01)
    >>> record = np.sin(t**1.5) * np.exp(-(((t - 12.0) / 4.0) ** 2))
    >>> motion, copy = (
    ...     Motion(name=name, acceleration=values, time_step=0.01)
    ...     for name, values in (("record", record), ("copy", -1.7 * record[500:2300]))
    ... )
    >>> are_copies([outline_of(motion)], [outline_of(copy)]).tolist()
    [[True]]
    """
    rate = 1.0 / motion.time_step
    low_pass = scipy.signal.butter(2, min(_CORNER, _OF_SAMPLING * rate), fs=rate, output="sos")
    swings = scipy.signal.sosfilt(low_pass, motion.acceleration)
    times = motion.time_step * np.arange(swings.size)
    place = int(np.abs(swings).argmax())
    around = times[place] + np.linspace(-_REACH, _REACH, _POINTS)
    stretch = np.interp(around, times, swings, left=0.0, right=0.0) * np.sign(swings[place])
    return np.packbits(_patterns() @ stretch > 0.0).tobytes().hex()


def are_copies(outlines: Iterable[str], others: Iterable[str]) -> NDArray[np.bool_]:
    """Whether records are copies of others by their outlines, shape (records, others)."""
    signs, others_signs = (
        np.array([2.0 * np.unpackbits(np.frombuffer(bytes.fromhex(text), np.uint8)) - 1.0 for text in texts])
        for texts in (outlines, others)
    )
    return np.asarray(0.5 * (_BITS - signs @ others_signs.T) <= _ALIKE)


@cache
def _patterns() -> Array:
    """Patterns without likeness to each other, the same on every machine, shape (bits, points)."""
    number, place = np.arange(1, _BITS + 1)[:, None], np.arange(1, _POINTS + 1)[None, :]
    return np.asarray(np.cos(np.pi * np.sqrt(number + 1.0) * place**2))
