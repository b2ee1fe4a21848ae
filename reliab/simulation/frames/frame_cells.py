"""Actuators before one partitioned frame, and the error of the reduction to pole pairs for each."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.simulation.frames.loop_poles import PoleLoop, pole_loop, transfer
from reliab.structures import Partition
from reliab.structures.critical_delay import critical_delay

_COMPARED = 61

_HIGHEST = 100.0  # Hz, above which the content of records is neglected

_NO_DEVIATION = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class FrameCells:
    """Actuators of given gains and delays before one partitioned frame."""

    partition: Partition  # The partitioned frame
    # gain, delay: Actuator gain k_p [-], positive, and delay τ [s], negative for a lead, shape (cells,) each
    gain: Array
    delay: Array
    # Weights of the degrees of freedom in the response whose error counts; by default it is the measured
    # interface displacement
    output: Array | None = None

    def __post_init__(self) -> None:
        sound = np.isfinite(self.gain) & np.isfinite(self.delay) & (self.gain > 0.0)
        if not sound.all():
            raise InputError(
                "Actuator gains must be positive and finite, delays finite",
                value=f"{self.gain[~sound][0]:g} and {self.delay[~sound][0]:g} s",
                remedy="Give gains as measured over command amplitude and delays in seconds",
            )

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the delay of each cell is below the critical delay, as every lead is."""
        gains, places = np.unique(self.gain, return_inverse=True)
        limits = np.array([critical_delay(self.partition, gain)[0] for gain in gains.tolist()])
        return np.asarray(self.delay < limits[places])

    @cached_property
    def poles(self) -> PoleLoop:
        """Poles and residues of each cell."""
        return pole_loop(self.partition, self.gain, self.delay, self.output)

    @cached_property
    def frequencies(self) -> Array:
        """Frequencies [Hz] at which the reduction is compared with the exact loop, shape (bands,)."""
        modes = self.partition.frame.modes.frequency
        return np.geomspace(0.1 * modes[0], max(_HIGHEST, 4.0 * modes[0]), _COMPARED)

    @cached_property
    def reduction(self) -> tuple[Array, Array]:
        """Squared moduli of the reduction's error and of the deviation [s⁴], shape (bands, cells)."""
        s = (2j * np.pi * self.frequencies).astype(np.complex128)
        exact = transfer(self.partition, self.gain, self.delay, s, self.output)
        ideal = transfer(self.partition, np.ones(1), np.zeros(1), s, self.output)
        lost = np.abs(exact - self.poles.transfer(s)) ** 2
        sought = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
        return np.where(np.isfinite(lost), lost, np.inf), sought
