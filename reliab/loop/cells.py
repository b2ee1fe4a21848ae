"""Many actuators before one structure: the cells of a grid, solved side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.loop.blocks import block_length
from reliab.loop.dominant_pole import ModalLoop, modal_loop, reduction_loss
from reliab.loop.pole_recursion import recursion
from reliab.loop.stability import critical_delay
from reliab.loop.structure import Structure


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Actuators of given gains and delays before one structure.

    What does not depend on the ground motion (poles, residues, validity of the reduction) is worked
    out once and kept.

    Parameters
    ----------
    structure : Structure
        The structure under test.
    gain, delay : numpy.ndarray
        Actuator gain k_p [-], positive, and delay τ [s], not negative, shape (cells,) each.

    Raises
    ------
    InputError
        If a gain or a delay is outside its range.
    """

    structure: Structure
    gain: NDArray[np.float64]
    delay: NDArray[np.float64]

    def __post_init__(self) -> None:
        for name, values, lowest in (("gains", self.gain, 1e-6), ("delays", self.delay, 0.0)):
            wrong = ~(np.isfinite(values) & (values >= lowest))
            if wrong.any():
                raise InputError(
                    f"Actuator {name} must be finite, positive gains and delays of zero or more",
                    value=values[wrong][0],
                    remedy="Give gains as measured over command amplitude and delays in seconds",
                )

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the delay of each cell is below the critical delay."""
        return self.delay < critical_delay(self.structure, self.gain)

    @cached_property
    def modal(self) -> ModalLoop:
        """The loop of each cell, reduced to its dominant pole pair."""
        return modal_loop(self.structure, self.gain, self.delay)

    @cached_property
    def coefficients(self) -> NDArray[np.float64]:
        """Coefficients of the recursion of each cell, for blocks of the structure's own length."""
        return recursion(self.modal, block_length(self.structure))

    @cached_property
    def reduction(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """What the reduction loses and what is sought, by frequency band, shape (bands, cells)."""
        return reduction_loss(self.structure, self.gain, self.delay, self.modal)
