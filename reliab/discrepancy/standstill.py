"""A reading that stands still now and then: the sensor, or the line from it, drops out.

Noise and motion make every sample differ from the one before it. A run of equal samples is an event where the
model that explains the tests best moves on by much more than the steps of the converter.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fit import Fit, Problem

Array = NDArray[np.float64]

_FEWEST_SAMPLES = 5
_FEWEST_EVENTS = 3
_STEPS = 4.0  # of the converter
_SHARE = 0.01  # of the channel's RMS


@dataclass(frozen=True, kw_only=True)
class Standstill:
    """How often and for how long a reading stands still.

    Attributes
    ----------
    events : int
        Number of events in all tests.
    seconds : float
        Median of their lengths [s].
    """

    events: int
    seconds: float


def standstill(problem: Problem, best: Fit) -> Standstill | None:
    """Find where the channel of a block stands still although the model moves on.

    Parameters
    ----------
    problem : Problem
        A block and its tests.
    best : Fit
        The model that explains them best.

    Returns
    -------
    Standstill or None
        None where there are not three events.
    """
    lengths: list[int] = []
    for test, left in problem.residuals(best.space, best.coordinates).items():
        read = problem.block.measured(test)
        lengths += _held(read, read - left, problem.steps[test])
    if len(lengths) < _FEWEST_EVENTS:
        return None
    return Standstill(events=len(lengths), seconds=float(np.median(lengths)) / problem.block.rate)


def _held(read: Array, expected: Array, step: float) -> list[int]:
    """Lengths of the events in a test, in samples."""
    edges = np.concatenate([[0], np.flatnonzero(np.diff(read)) + 1, [read.size]])
    least = _STEPS * step + _SHARE * float(read.std())
    found = []
    for begin, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        if end - begin >= _FEWEST_SAMPLES and float(np.ptp(expected[begin:end])) > least:
            found.append(end - begin)
    return found
