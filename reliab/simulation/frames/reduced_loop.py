"""A frame with one actuator under one ground motion, solved with the pole pairs of the test."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.simulation.deviation import Deviation, peak_of_history, summary
from reliab.simulation.excitation import Excitation
from reliab.simulation.frames.loop_poles import PoleLoop, pole_loop, transfer
from reliab.simulation.frames.mode_recursion import LANES, recursion, track
from reliab.structures import Partition, stability_limit
from reliab.structures.frames import undivided_response

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
