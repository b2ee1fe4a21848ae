"""A reading that stands still now and then: the sensor, or the line from it, drops out.

Noise and motion make every sample differ from the one before it. A run of equal samples is an event where the
model that explains the tests best moves on, at frequencies at which it is judged, by much more than the
reading usually changes from one sample to the next, or the model misses it. Equal samples at the start or end
of a record are rest, and a few events that contain almost none of the residual are no explanation.
"""

from dataclasses import dataclass

import numpy as np
from scipy import signal

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem

_FEWEST_SAMPLES = 5
_FEWEST_EVENTS = 3
_TIMES = 4.0  # of what the reading usually differs by
_SHARE = 0.01  # of the channel's RMS
_LEAST_OF_REMAINDER = 0.05  # share of the energy that the model leaves


@dataclass(frozen=True, kw_only=True)
class Standstill:
    """How often and for how long a reading stands still."""

    events: int  # Number of events in all tests
    seconds: float  # Median of their lengths [s]


def standstill(problem: Problem, best: Fit) -> Standstill | None:
    """Find where the channel of a block stands still although the model moves on."""
    lengths: list[int] = []
    inside = whole = 0.0
    for test, residual in problem.residuals(best.space, best.coordinates).items():
        read = problem.block.measured(test)
        expected = _judged(read - residual, problem.block.highest / problem.block.rate)
        events = _held(read, expected, max(problem.steps[test], float(np.median(np.abs(residual)))))
        lengths += [end - begin for begin, end in events]
        inside += sum(float((residual[begin:end] ** 2).sum()) for begin, end in events)
        whole += float((residual**2).sum())
    if len(lengths) < _FEWEST_EVENTS or inside < _LEAST_OF_REMAINDER * whole:
        return None
    return Standstill(events=len(lengths), seconds=float(np.median(lengths)) / problem.block.rate)


def _judged(expected: Array, highest: float) -> Array:
    """Keep of what a model expects the part below the highest frequency, in units of the sampling rate."""
    return np.asarray(signal.sosfiltfilt(signal.butter(4, highest, fs=1.0, output="sos"), expected))


def _held(read: Array, expected: Array, usual: float) -> list[tuple[int, int]]:
    """First sample of each event in a test and the one after the last."""
    changes = np.diff(read)
    edges = np.concatenate([[0], np.flatnonzero(changes) + 1, [read.size]])
    if changes.any():
        usual = max(usual, float(np.median(np.abs(changes[changes != 0.0]))))
    least = _TIMES * usual + _SHARE * float(read.std())
    events = []
    for begin, end in zip(edges[1:-2].tolist(), edges[2:-1].tolist(), strict=True):
        if end - begin >= _FEWEST_SAMPLES and float(np.ptp(expected[begin:end])) > least:
            events.append((begin, end))
    return events
