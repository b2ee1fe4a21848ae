"""Histories of a test with several actuators or one, from which its error is rebuilt."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.core.arrays import Array

_BAND_PERIOD_SHARE = 0.25  # of the period of the highest frequency of the motion that a step may be
_FEWEST_SWEPT = 4096  # samples up to which the motion's band, too, is resolved in responses of draws


@dataclass(frozen=True, kw_only=True, eq=False)
class Histories:
    """Histories of p actuators from which the error is rebuilt, without offsets of the sensors."""

    command: Array  # command, measured: x_c and the smoothed x_m at the sensors [m], shape (p, n)
    measured: Array
    # x_c minus the displacement whose force was fed back, at the interface [m]: x_c − x_m unless it was late
    fed_back: Array
    time_step: float  # Step [s]
    # x_c − x_m at the interface [m] under which the structure stood still before the first sample, shape (p,)
    standing: Array
    carry: Array  # Interface displacements of unit displacements of the sensors [-], shape (p, p)

    @cached_property
    def difference(self) -> Array:
        """x_c − x_m at the interface [m], shape (p, n)."""
        return np.asarray(self.carry @ (self.command - self.measured))

    @property
    def late(self) -> Array:
        """What a force that was fed back late adds to x_c − x_m at the interface [m], shape (p, n)."""
        return np.asarray(self.fed_back - self.difference)

    def thin(self, stride: int) -> "Histories":
        """Each `stride`-th sample."""
        return replace(
            self,
            command=np.ascontiguousarray(self.command[:, ::stride]),
            measured=np.ascontiguousarray(self.measured[:, ::stride]),
            fed_back=np.ascontiguousarray(self.fed_back[:, ::stride]),
            time_step=stride * self.time_step,
        )


def samples_in_step(structure_stride: int, noises: Sequence[SensorNoise], samples: int) -> int:
    """Return the number of samples of which one is enough while draws are swept.

    `structure_stride`: the number of which one resolves the structure's modes.
    """
    highest = max(noise.band for noise in noises)
    band_stride = max(int(_BAND_PERIOD_SHARE / (highest * noises[0].time_step)), 1)
    return min(structure_stride, max(band_stride, -(-samples // _FEWEST_SWEPT)))
