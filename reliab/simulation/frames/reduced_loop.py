"""A frame with one actuator under one ground motion, solved with the pole pairs of the test.

Many actuators are stepped side by side, by one recursion of two states for each pole pair. A pair
z' = pz + a_g with residue r is exact for a ground acceleration that is linear in each step. With
E = e^(ph) and the weights F₀, F₁ of both ends of a step its displacement y = −2Re(rz) obeys::

    y₊₊ = 2Re(E)y₊ − |E|²y − 2Re(rF₁)a₊₊ − 2Re(rF₀ − rE*F₁)a₊ + 2Re(rE*F₀)a
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.deviation import LATEST, TRACKS, Deviation, follow, peak_of_history, summary
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.loop_poles import PoleLoop, pole_loop, transfer
from reliab.simulation.linear_loop.blocks import ramp_weights
from reliab.structures.critical_delay import stability_limit
from reliab.structures.frames.frame import undivided_response
from reliab.structures.partition import Partition

LANES = 64
"""Cells that advance side by side."""

_COEFFICIENTS = 7


def recursion(loop: PoleLoop, step: float) -> Array:
    """Coefficients of every pair and of the remainder.

    `step` [s].
    Returns shape (modes + 1, 7, cells): of the last two displacements, of the ground at the end of this step,
    at its begin and a step before, the displacement a step before the record for which its first sample acts
    as a jump, and of the ground at the end of the next step. The last row is the remainder.
    """
    early, late, decay = ramp_weights(loop.poles, step)
    r, back = loop.residues, loop.residues * decay.conj()
    jump = 2.0 * (back * late).real
    squared = np.abs(decay) ** 2
    pairs = np.stack(
        [
            2.0 * decay.real,
            -squared,
            -2.0 * (r * late).real,
            jump - 2.0 * (r * early).real,
            2.0 * (back * early).real,
            jump / squared,
            np.zeros_like(jump),
        ],
        axis=1,
    )
    return np.concatenate([pairs, _remainder(loop, step)[np.newaxis]])


def _remainder(loop: PoleLoop, step: float) -> Array:
    """Coefficients of the remainder, shape (7, cells): a first-order lag, or the ground some time ahead."""
    remainder = np.zeros((_COEFFICIENTS, loop.remainder.size))
    ahead = np.maximum(-loop.remainder_time, 0.0) / step
    remainder[2], remainder[6] = -loop.remainder * (1.0 - ahead), -loop.remainder * ahead
    lags = loop.remainder_time > 0.0
    if lags.any():
        pole = -1.0 / loop.remainder_time[lags]
        early, late, decay = ramp_weights(pole, step)
        static = -loop.remainder[lags] * pole
        remainder[0, lags], remainder[2, lags], remainder[3, lags] = decay, -static * late, -static * early
    return remainder


@compiled
def track(ground: Array, ideal: Array, first: int, coefficients: Array) -> Array:
    """Step cells from rest and track their deviation from the sample `first` on, shape (tracks, cells)."""
    cells = coefficients.shape[2]
    tracks = np.empty((TRACKS, cells))
    for begin in range(0, cells, LANES):
        lanes = slice(begin, begin + LANES)
        copy_rows(_track_lanes(ground, ideal, first, coefficients[:, :, lanes]), tracks[:, lanes])
    return tracks


@compiled
def _track_lanes(  # noqa: C901 - one compiled loop
    ground: Array, ideal: Array, first: int, coefficients: Array
) -> Array:
    pairs, last = coefficients.shape[0] - 1, ground.size - 1
    k = np.empty((pairs + 1, _COEFFICIENTS, LANES))
    for p in range(pairs + 1):
        copy_rows(coefficients[p], k[p])
    t = np.zeros((TRACKS, LANES))
    for j in range(LANES):
        t[LATEST, j] = np.nan
    x, y, remainder, total = (
        np.zeros((pairs, LANES)),
        np.zeros((pairs, LANES)),
        np.zeros(LANES),
        np.zeros(LANES),
    )
    # y lies one step before x; it starts where a jump at the first sample puts it.
    for p in range(pairs):
        for j in range(LANES):
            y[p, j] = k[p, 5, j] * ground[0]
    for i in range(last + 1):
        now, after = ground[i], ground[min(i + 1, last)]
        before = ground[i - 1] if i > 0 else 0.0
        earlier = ground[i - 2] if i > 1 else 0.0
        for j in range(LANES):
            remainder[j] = k[pairs, 0, j] * remainder[j] + k[pairs, 2, j] * now
            remainder[j] += k[pairs, 3, j] * before + k[pairs, 6, j] * after
            total[j] = remainder[j]
        if i > 0:
            for p in range(pairs):
                for j in range(LANES):
                    moved = k[p, 0, j] * x[p, j] + k[p, 1, j] * y[p, j]
                    moved += k[p, 2, j] * now + k[p, 3, j] * before + k[p, 4, j] * earlier
                    y[p, j] = x[p, j]
                    x[p, j] = moved
                    total[j] += moved
        if i >= first:
            weight = 0.5 if i in (first, last) else 1.0
            exact = ideal[i]
            for j in range(LANES):
                track_of = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                track_of = follow(track_of, total[j] - exact, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track_of
    return t


_COMPARED = 61
_HIGHEST = 100.0  # Hz, above which the content of records is neglected
_NO_DEVIATION = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class ReducedLoop:
    """A frame with one actuator under one ground motion, whose test is reduced to pole pairs."""

    excitation: Excitation  # Record and window
    partition: Partition
    output: Array | None  # Weights of the degrees of freedom, shape (n,); None for the measured interface
    step: float  # s, the record's divided by a whole number

    def poles(self, gain: Array, delay: Array) -> PoleLoop:
        """Poles and residues of the test with actuators of gains [-] and delays [s], shape (cells,)."""
        return pole_loop(self.partition, gain, delay, self.output)

    def deviation(self, poles: PoleLoop) -> Deviation:
        """Deviation of the output; infinite where the test is unstable and poles could not be followed."""
        ground, first = self._sampled
        cells = poles.remainder.size
        with np.errstate(all="ignore"):  # a violently unstable cell may overflow, or its poles be unknown
            coefficients = recursion(poles, self.step)
            filled = np.pad(coefficients, ((0, 0), (0, 0), (0, -cells % LANES)), mode="edge")
            tracks = track(ground, self._ideal, first, np.ascontiguousarray(filled))[:, :cells]
            deviation = summary(tracks, float(ground.size - 1 - first), peak_of_history(self._ideal[first:]))
        return replace(
            deviation,
            mean_square=np.nan_to_num(deviation.mean_square, nan=np.inf, posinf=np.inf),
            peak=np.nan_to_num(deviation.peak, nan=np.inf, posinf=np.inf),
        )

    def stable(self, gain: Array, delay: Array) -> NDArray[np.bool_]:
        """Whether each delay is below the critical delay, as every lead is."""
        gains, places = np.unique(gain, return_inverse=True)
        limits = np.array([stability_limit(self.partition, one).delay for one in gains.tolist()])
        return np.asarray(delay < limits[places])

    def error(self, poles: PoleLoop, gain: Array, delay: Array) -> Array:
        """Relative error of RMS^R that the reduction causes for this record [-], shape (cells,)."""
        s = (2j * np.pi * self._frequencies).astype(np.complex128)
        exact = transfer(self.partition, gain, delay, s, self.output)
        ideal = transfer(self.partition, np.ones(1), np.zeros(1), s, self.output)
        neglected = np.abs(exact - poles.transfer(s)) ** 2
        neglected = np.where(np.isfinite(neglected), neglected, np.inf)
        total = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
        with np.errstate(invalid="ignore"):
            error = np.sqrt(self._band_power @ neglected / np.maximum(self._band_power @ total, 1e-300))
        return np.where(np.isnan(error), np.inf, error)

    @cached_property
    def _sampled(self) -> tuple[Array, int]:
        """Ground acceleration at the steps up to the end of the window, and the step at which it begins."""
        begin, end = self.excitation.window
        times = self.step * np.arange(round(end / self.step) + 1)
        recorded = self.excitation.time_step * np.arange(self.excitation.acceleration.size)
        return np.interp(times, recorded, self.excitation.acceleration), round(begin / self.step)

    @cached_property
    def _ideal(self) -> Array:
        """Exact response of the output [m] at the steps."""
        floors = undivided_response(self.partition.frame, self._sampled[0], self.step)
        seen = self.partition.direction if self.output is None else self.output
        return np.ascontiguousarray(seen @ floors)

    @cached_property
    def _frequencies(self) -> Array:
        """Frequencies [Hz] at which the reduction is compared with the exact loop, shape (bands,)."""
        modes = self.partition.frame.modes.frequency
        return np.geomspace(0.1 * modes[0], max(_HIGHEST, 4.0 * modes[0]), _COMPARED)

    @cached_property
    def _band_power(self) -> Array:
        half = np.sqrt(self._frequencies[1] / self._frequencies[0])
        return self.excitation.band_power(np.append(self._frequencies / half, self._frequencies[-1] * half))
