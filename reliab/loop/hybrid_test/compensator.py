"""The socket between command and actuator into which delay compensators plug."""

from abc import ABC, abstractmethod
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.loop.effects.kernel import Kernel


class Compensator(ABC):
    """Something that changes the command before it is sent to the actuator.

    Attributes
    ----------
    kernel : Kernel
        Called once a step as `kernel(motion, measured, step, coefficients, state)` with the displacement,
        velocity and acceleration of the command, which it changes, and the last measured displacement [m].
        Returns nothing of interest.
    """

    kernel: ClassVar[Kernel]

    @abstractmethod
    def coefficients(self, step: float) -> NDArray[np.float64]:
        """Return what the kernel reads, for a step [s]."""
