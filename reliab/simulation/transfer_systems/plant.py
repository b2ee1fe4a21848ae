"""Linear model of a transfer system and its specimen, from the sent command to piston and force."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.structures import Specimen


@dataclass(frozen=True, kw_only=True)
class Plant:
    """A linear model w' = A w + b u − e f, of which the piston's motion and the force are rows.

    u is the command that arrives, f the force [N] of the specimen's nonlinear effects.
    """

    dynamics: Array  # A [1/s], shape (states, states)
    command: Array  # b, shape (states,)
    nonlinear: Array  # e, shape (states,); zero where the specimen does not act back on the piston
    # displacement, velocity: Rows of the piston's displacement [m] and velocity [m/s], shape (states,)
    displacement: Array
    velocity: Array
    force: Array  # Row of the specimen's force [N], nonlinear effects left out unless `contains_nonlinear`
    # displacement_of_command, force_of_command: Direct part of the command in the displacement [-] and in
    # that force [N/m]
    displacement_of_command: float = 0.0
    force_of_command: float = 0.0
    contains_nonlinear: bool = False  # Whether the force row holds the force of nonlinear effects too
    delay: float = 0.0  # Delay [s] of the command before it arrives
    # Part of A that acts through the velocity row, A = A₀ + differenced ⊗ velocity; an emulation of a block
    # diagram may take that velocity by differences. Shape (states,)
    differenced: Array


class TransferSystem(ABC):
    """An actuator with its inner control: what turns a sent command into the motion of the piston."""

    @abstractmethod
    def plant(self, specimen: Specimen) -> Plant:
        """Model that drives a specimen."""

    @abstractmethod
    def transfer(self, s: NDArray[np.complex128], specimen: Specimen) -> NDArray[np.complex128]:
        """Measured over sent displacement [-] at s [rad/s] with a linear specimen."""
