"""What deserves a look in the samples of a record: clipping, an offset, single spikes, gaps, copies.

Thresholds are far from what the corrected records of the FEMA P-695 sets and the synthetic suite reach: none
of them has two equal samples at a peak, a velocity that ends above 3 % of its peak, a spike more than 2.2
times as sharp as what surrounds it, or four equal samples in its strong part.
"""

from bisect import bisect_left, insort
from collections.abc import Iterator
from operator import itemgetter

import numpy as np

from reliab.core.arrays import Array
from reliab.core.significant_digits import significant

_FEWEST = 100  # samples, below which a record tells nothing of these
_EQUAL = 1e-6  # of the peak, up to which two samples are the same
_FLAT = 3  # equal samples that make a flat top
_EDGE = 0.02  # of the peak, by which a clipped top differs from the sample before or after it
_STEPS = 4  # of the resolution, by which it does so at least
_DRIFT = 0.5  # of the largest velocity without the drift, from which a final velocity is one
_SHARPNESS = 3.0  # times the sharpness of what surrounds it, from which a sample is a spike
_RETURN = 0.5  # of its sharpness, by which the samples before and after a spike may differ
_SURROUNDINGS = 50  # samples before and after
_LEAST_SPIKE = 0.1  # of the peak
_HELD = 10  # equal samples in the strong part that are held
_STRONG = (0.05, 0.95)  # of the squared acceleration
_WINDOW = 100  # samples before and after the peak, by which copies are recognised
_ROUNDING = 2e-3  # of the peak, by which copies differ where texts round them


def find_flaws(acceleration: Array, time_step: float) -> Iterator[tuple[str, str]]:
    """Yield each flaw of a record with what to do about it.

    `acceleration` (n,) [m/s²]; `time_step` [s].
    """
    if acceleration.size < _FEWEST:
        return
    peak = float(np.abs(acceleration).max())
    runs = _equal_runs(acceleration, _EQUAL * peak)
    steps = np.diff(np.unique(acceleration))
    edge = max(_EDGE * peak, _STEPS * float(steps[steps > _EQUAL * peak].min(initial=peak)))
    tops = [run for run in runs if _is_clipped(acceleration, run, _EQUAL * peak, edge)]
    if tops:
        samples = sum(stop - start for start, stop in tops)
        value = f"flat tops, {samples} samples at the largest values: clipped by the recorder"
        yield value, "Leave it out: the peaks are lost"
    yield from _find_drift(acceleration, time_step)
    yield from _find_spikes(acceleration, time_step, peak)
    energy = np.cumsum((acceleration - acceleration.mean()) ** 2)
    strong = np.searchsorted(energy, np.array(_STRONG) * energy[-1])
    held = [
        run
        for run in runs
        if run not in tops and run[1] - run[0] >= _HELD and strong[0] <= run[0] < strong[1]
    ]
    if held:
        start, stop = max(held, key=lambda run: run[1] - run[0])
        value = f"{significant(float(acceleration[start]))} m/s² held from {start * time_step:.2f} s"
        remedy = "Compare it with the original record"
        yield f"{value} for {stop - start} samples: a gap that was filled?", remedy


def _equal_runs(acceleration: Array, tolerance: float) -> list[tuple[int, int]]:
    """First sample, and the one after the last, of each run of equal samples."""
    equal = np.abs(np.diff(acceleration)) <= tolerance
    edges = np.flatnonzero(np.diff(np.concatenate([[False], equal, [False]]).astype(np.int8)))
    return [(int(start), int(stop) + 1) for start, stop in edges.reshape(-1, 2) if stop + 1 - start >= _FLAT]


def _is_clipped(acceleration: Array, run: tuple[int, int], tolerance: float, edge: float) -> bool:
    """Tell whether a run of equal samples is an extreme that the record enters or leaves with a jump."""
    start, stop = run
    value = acceleration[start]
    if min(abs(value - acceleration.max()), abs(value - acceleration.min())) > tolerance:
        return False
    around = acceleration[[max(start - 1, 0), min(stop, acceleration.size - 1)]]
    return bool(np.abs(around - value).max() >= edge)


def _find_drift(acceleration: Array, time_step: float) -> Iterator[tuple[str, str]]:
    steps = 0.5 * (acceleration[1:] + acceleration[:-1]) * time_step
    velocity = np.concatenate([[0.0], np.cumsum(steps)])
    final = float(velocity[-1])
    largest = float(np.abs(velocity - final * np.linspace(0.0, 1.0, velocity.size)).max())
    if abs(final) > _DRIFT * largest:
        offset = significant(final / (time_step * (acceleration.size - 1)))
        value = f"velocity that ends at {significant(final)} m/s: an offset of {offset} m/s², or a cut"
        yield value, "Correct the baseline, or leave it out"


def _find_spikes(acceleration: Array, time_step: float, peak: float) -> Iterator[tuple[str, str]]:
    """Find samples that stand alone, far from those before and after, which are much alike."""
    at_rest = np.pad(acceleration, 1)
    sharpness = np.abs(acceleration - 0.5 * (at_rest[:-2] + at_rest[2:]))
    padded = np.pad(sharpness, _SURROUNDINGS + 1)  # a spike makes the samples beside it sharp, too
    windows = np.lib.stride_tricks.sliding_window_view(padded, _SURROUNDINGS).max(axis=1)
    around = np.maximum(windows[: sharpness.size], windows[_SURROUNDINGS + 3 :])
    returns = np.abs(at_rest[2:] - at_rest[:-2]) < _RETURN * sharpness
    spikes = np.flatnonzero(returns & (sharpness > np.maximum(_SHARPNESS * around, _LEAST_SPIKE * peak)))
    if spikes.size:
        sample = int(spikes[np.abs(acceleration[spikes]).argmax()])
        more = f" and {spikes.size - 1} more" if spikes.size > 1 else ""
        height = significant(float(acceleration[sample]))
        value = f"a single spike of {height} m/s² at {sample * time_step:.2f} s{more}"
        yield value, "Remove it if it is none of the ground"


class Copies:
    """Records seen so far, in which copies are recognised, be they scaled, reversed or cut.

    >>> copies, record = Copies(), np.array([0.0, 1.0, -3.0, 0.5])
    >>> copies.find("one", record, 0.01), copies.find("two", -2 * record, 0.01)
    (None, ('one', -2.0))
    """

    def __init__(self) -> None:
        self._seen: dict[float, list[tuple[float, str, float, Array]]] = {}

    def find(self, name: str, acceleration: Array, time_step: float) -> tuple[str, float] | None:
        """Return an earlier record of which this is a copy, and the factor between them; else remember it."""
        largest = int(np.abs(acceleration).argmax())
        peak = float(acceleration[largest])
        shape = np.pad(acceleration, _WINDOW)[largest : largest + 2 * _WINDOW + 1] / (peak or 1.0)
        after = float(shape[_WINDOW + 1])
        records = self._seen.setdefault(round(time_step, 9), [])  # sorted by the sample after the peak
        first = bisect_left(records, after - _ROUNDING, key=itemgetter(0))
        for its_after, original, its_peak, its_shape in records[first:]:
            if its_after > after + _ROUNDING:
                break
            if np.abs(its_shape - shape).max() <= _ROUNDING:
                return original, peak / its_peak
        insort(records, (after, name, peak, shape), key=itemgetter(0))
        return None
