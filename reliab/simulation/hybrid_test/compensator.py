"""Base class of delay compensators, which act between command and actuator."""

from abc import ABC, abstractmethod
from typing import ClassVar

from reliab.core.arrays import Array
from reliab.effects.kernel import Kernel


class Compensator(ABC):
    """A delay compensator: it changes the command before it is sent to the actuator.

    A subclass is a frozen dataclass; `studies/laboratory/compensators/` holds those of the studies.
    """

    name: ClassVar[str]  # Unique name, as files call it
    # Called once a step with the motion of the command (displacement, velocity, acceleration), which it
    # changes, and the last measured displacement [m]; arguments: motion, measured, step, coefficients, state
    kernel: ClassVar[Kernel]

    @abstractmethod
    def coefficients(self, step: float) -> Array:
        """Return what the kernel reads, for a step [s]."""
