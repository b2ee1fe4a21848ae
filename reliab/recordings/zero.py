"""Where a structure rests on the scale of its command: at zero, or elsewhere, as on the stroke of a piston.

A linear structure oscillates about the position in which it rests. An error over a peak that is counted from
elsewhere would be too small, and so would one whose peak is that of a move before the test.
"""

from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.recordings.behaviour import white_noise

_LEAST = 0.02  # of the command's span: another zero below which nothing is said
_FIRST_STEP_SHARE = 0.05  # of the largest step between samples: a first step of a command that begins at rest
_NEAR = 0.05  # of the span: distance of the mean from the first sample that may be motion
_PIECES, _STEADY = 8, 0.25  # of a command about another zero, and the scatter of their means over the mean
_MOVE: Final = 0.05  # of the span of a command: a move before or after a test, at least
_DWELL: Final = 0.2  # s that a command stands between a move and a test, at least
_STANDING: Final = 0.1  # of the mean speed of a move, up to which a command stands
_RETURN_SHARE: Final = 0.01  # of the span by which a command goes back when it no longer moves to a position
_ABOUT: Final = 0.1  # of the span of a test: distance of its mean along its path from the position before it
_NOISE: Final = 6.0  # of its standard deviation, which the difference of two samples hardly exceeds


def zero_of(command: Array) -> float:
    """Value about which a command oscillates, shape (n,); 0 where that is zero, or cannot be told.

    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> zero_of(0.1 + 0.003 * np.sin(time) ** 3), zero_of(np.cos(time))
    (0.1, 0.0)
    """
    first, mean, span = float(command[0]), float(command.mean()), float(np.ptp(command))
    steps = np.abs(np.diff(command))
    if steps[0] <= _FIRST_STEP_SHARE * steps.max():
        oscillates = abs(mean - first) <= abs(first) / 2.0
        zero = first if abs(mean - first) <= _NEAR * span else mean
    else:
        means = [float(piece.mean()) for piece in np.array_split(command, _PIECES)]
        steady = float(np.std(means)) < _STEADY * abs(mean)
        oscillates = steady or command.min() > 0.0 or command.max() < 0.0
        zero = mean
    return zero if oscillates and abs(zero) > _LEAST * span else 0.0


def extent_of_test(command: Array, time_step: float) -> tuple[int, int]:
    """Find the first sample of a test and the one behind its last, without moves to and from its position.

    A move goes one way, and the command stands before the test oscillates about where it ended. `time_step`
    [s].

    >>> time = np.arange(0.0, 30.0, 0.01)
    >>> test = 0.05 * np.clip(time / 5.0, 0.0, 1.0) + 0.02 * np.sin(6.0 * np.clip(time - 6.0, 0.0, 20.0))
    >>> extent_of_test(test, 0.01), extent_of_test(np.sin(time), 0.01)
    ((499, 3000), (0, 3000))
    """
    begin = _end_of_move(command, time_step)
    return begin, command.size - _end_of_move(command[begin:][::-1], time_step)


def _end_of_move(command: Array, time_step: float) -> int:
    """Find where a command stands after a move that begins with its first sample; 0 without such a move."""
    span, noise = float(np.ptp(command)), _NOISE * white_noise(command)
    stand = max(round(_DWELL / time_step), 8)
    first = float(np.median(command[:stand]))
    travel = command - first
    away = np.abs(travel) > _MOVE * span
    if not away.any():
        return 0
    travel = travel * np.sign(travel[np.argmax(away)])
    has_turned = np.maximum.accumulate(travel) - travel > _RETURN_SHARE * span + noise
    travel = travel[: int(np.argmax(has_turned))] if has_turned.any() else travel
    if stand >= travel.size:
        return 0
    mean_speed = travel / np.arange(1, travel.size + 1)
    ends = {"size": stand + 1, "origin": -((stand + 1) // 2)}  # of windows that begin with each sample
    ranges = scipy.ndimage.maximum_filter1d(travel, **ends) - scipy.ndimage.minimum_filter1d(travel, **ends)
    stands = ranges[:-stand] <= _STANDING * stand * mean_speed[:-stand] + noise
    places = np.flatnonzero(stands & away[: stands.size])
    runs = np.split(places, np.flatnonzero(np.diff(places) > 1) + 1)
    for run in sorted(runs, key=len, reverse=True) if places.size else ():
        level, test = float(np.median(command[run])), command[run[-1] :]
        path = np.abs(np.diff(test))
        oscillates = path.sum() > abs(level - first)
        if oscillates and abs(path @ (test[1:] - level)) <= _ABOUT * float(np.ptp(test)) * path.sum():
            near = np.abs(command[run] - level) <= _STANDING * _LEAST * span + noise
            return int(run[np.argmax(near)])
    return 0
