"""What engines take and give: the ground acceleration, and statistics of the deviation x_m − x_I.

The stepping engines keep a `Track` of each cell: the sum of squares, the last two deviations, and
the largest deviation with its two neighbours, through which a parabola finds the peak between
samples.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """A piecewise-linear ground acceleration and the part of it over which errors are computed.

    Raises InputError if the window is empty or reaches beyond the record.
    """

    # Ground acceleration a_g [m/s²], shape (n,); the structure is at rest at the first sample
    acceleration: Array
    time_step: float  # Step between samples [s]
    # Begin and end of the window [s] on the record's own time axis; the whole record by default
    window: tuple[float, float] = (0.0, -1.0)

    def __post_init__(self) -> None:
        duration = (self.acceleration.size - 1) * self.time_step
        begin, end = self.window
        if end < 0.0:
            end = duration
            object.__setattr__(self, "window", (begin, end))
        if not 0.0 <= begin < end <= duration * (1.0 + 1e-9):
            raise InputError(
                "The window must lie inside the record and not be empty",
                value=f"{begin:g} s to {end:g} s of a record of {duration:g} s",
                remedy="Give a window within the record, or use a longer record",
            )

    @property
    def window_duration(self) -> float:
        """Length of the window [s]."""
        return self.window[1] - self.window[0]

    def since(self, time: float) -> "Excitation":
        """Leave out what is more than a sample before a time [s]; the window stays on the same samples."""
        first = max(0, int(time / self.time_step) - 1)
        begin, end = (edge - first * self.time_step for edge in self.window)
        return Excitation(
            acceleration=self.acceleration[first:], time_step=self.time_step, window=(begin, end)
        )

    def band_power(self, edges: Array) -> Array:
        """Power of the record in frequency bands.

        `edges`: edges of the bands [Hz], increasing, shape (bands + 1,). Returns share of each band in the
        record's sum of squares [-], shape (bands,).
        """
        frequency, cumulative = self._cumulative_power
        share: Array = np.diff(np.interp(edges, frequency, cumulative))
        return share

    @cached_property
    def _cumulative_power(self) -> tuple[Array, Array]:
        """Frequencies [Hz] and the share of the record's sum of squares below them [-]."""
        power = np.asarray(np.abs(np.fft.rfft(self.acceleration)) ** 2, dtype=np.float64)
        cumulative = np.concatenate([[0.0], np.cumsum(power)])
        frequency = (np.arange(cumulative.size) - 0.5) / (self.acceleration.size * self.time_step)
        return frequency.astype(np.float64), cumulative / cumulative[-1]


TRACKS = 6
_SQUARES, _, LATEST, _LEFT, _PEAK, _RIGHT = range(TRACKS)
"""Rows of a track. The latest before the window is NaN, so that a peak at its begin is not refined."""

Track = tuple[float, float, float, float, float, float]
"""Numbers kept for one cell: sum of squares, the last two deviations, the largest with its two neighbours."""


@dataclass(frozen=True, kw_only=True)
class Deviation:
    """How far the measured displacement x_m strays from the exact response x_I over a window."""

    mean_square: Array  # Mean of (x_m − x_I)² [m²], shape (cells,)
    peak: Array  # Largest |x_m − x_I| [m], shape (cells,)
    ideal_peak: float  # Largest |x_I| [m]

    def put(self, cells: NDArray[np.intp] | NDArray[np.bool_], solved_cells: "Deviation") -> None:
        """Fill in the values of some cells, as another engine solved them."""
        self.mean_square[cells], self.peak[cells] = solved_cells.mean_square, solved_cells.peak


@compiled
def _higher(
    highest: tuple[float, float, float], latest: tuple[float, float, float]
) -> tuple[float, float, float]:
    """Return whichever of two triples of neighbouring samples has the larger middle value in modulus."""
    up = abs(latest[1]) > abs(highest[1])
    return (
        latest[0] if up else highest[0],
        latest[1] if up else highest[1],
        latest[2] if up else highest[2],
    )


@compiled
def end_weight(block: int, blocks: int, end: float) -> float:
    """Weight of the value at the end of a block by the trapezoidal rule; the last block has length `end`."""
    if block + 1 == blocks:
        return 0.5 * end
    return 0.5 + 0.5 * end if block + 2 == blocks else 1.0


@compiled
def follow(track: Track, now: float, weight: float) -> Track:
    """Add one deviation, with its weight in the trapezoidal rule, to the statistics."""
    squares, previous, latest, left, peak, right = track
    left, peak, right = _higher((left, peak, right), (previous, latest, now))
    return squares + weight * now * now, latest, now, left, peak, right


@compiled
def follow_four(track: Track, p: float, q: float, r: float, s: float) -> Track:
    """Add four consecutive deviations inside the window to the statistics."""
    squares, w, x, left, peak, right = track
    triple = _higher((left, peak, right), (w, x, p))
    triple = _higher(triple, (x, p, q))
    triple = _higher(triple, (p, q, r))
    left, peak, right = _higher(triple, (q, r, s))
    return squares + (p * p + q * q) + (r * r + s * s), r, s, left, peak, right


def summary(tracks: Array, intervals: float, ideal_peak: float) -> Deviation:
    """Turn the tracks of all lanes into the statistics of the window.

    `ideal_peak` [m].
    """
    inner = refine_peaks(tracks[_LEFT], tracks[_PEAK], tracks[_RIGHT])
    peak = np.fmax(inner, np.abs(tracks[LATEST]))
    return Deviation(mean_square=tracks[_SQUARES] / intervals, peak=peak, ideal_peak=ideal_peak)


@compiled
def refine_peak(left: float, middle: float, right: float) -> float:
    """Largest modulus of the parabola through a sampled extreme value and its neighbours."""
    curvature = left + right - 2.0 * middle
    rise = -((right - left) ** 2) / (8.0 * curvature)
    # Around an extreme value the vertex rises by at most an eighth of the curvature.
    return abs(middle + rise) if abs(rise) <= 0.125 * abs(curvature) else abs(middle)


@compiled
def refine_peaks(left: Array, middle: Array, right: Array) -> Array:
    """Largest moduli of the parabolas of many cells."""
    peaks = np.empty(middle.size)
    for i in range(middle.size):
        peaks[i] = refine_peak(left[i], middle[i], right[i])
    return peaks


def peak_of_history(history: Array) -> float:
    """Largest modulus of a sampled history, refined between samples.

    `history`: samples, shape (n,), n ≥ 2. Returns the peak in the unit of the samples.

    >>> peak_of_history(np.array([0.0, -0.75, -1.0, -0.75]))
    1.0
    """
    peak_index = int(np.argmax(np.abs(history)))
    if peak_index in (0, history.size - 1):
        return float(abs(history[peak_index]))
    return refine_peak(history[peak_index - 1], history[peak_index], history[peak_index + 1])
