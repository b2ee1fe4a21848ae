"""The ground acceleration as the engines see it: linear between samples, with a window of time."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from reliab.core.arrays import Array
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
