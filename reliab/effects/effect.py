"""Base classes of the effects that are simulated, fitted and reported."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from reliab.effects.kernel import Kernel
from reliab.effects.parameter import Parameter
from reliab.errors import InputError
from reliab.vocabulary import Block


class Role(StrEnum):
    """Where in the hybrid test an effect is plugged in, and what its kernel returns or changes."""

    DELAY = "delay"
    """Given the command's motion, returns a delay [s] that adds to the actuator's."""
    PISTON = "piston"
    """Changes the motion on its way from the delayed command to the piston; its return value is ignored."""
    FORCE = "force"
    """Given the piston's motion, returns a force [N] that adds to that of the linear specimen."""
    DISPLACEMENT_READING = "displacement_reading"
    """Given the piston's motion, returns what the sensor adds to the displacement [m]."""
    FORCE_READING = "force_reading"
    """Given the piston's motion, returns what the sensor adds to the force [N]."""
    RECORD = "record"
    """Acts on the whole ground acceleration before the test; has no kernel."""
    INTEGRATION = "integration"
    """Acts on the numerical substructure; has no kernel."""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """Properties of the test that an effect may need.

    Parameters
    ----------
    step : float
        Step of the simulation [s].
    stiffness : float
        Stiffness of the linear specimen [N/m].
    damping : float
        Damping coefficient of the linear specimen [N·s/m].
    """

    step: float
    stiffness: float = 0.0
    damping: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Effect(ABC):
    """An effect that may be missing from the model of a hybrid test.

    A subclass is a frozen dataclass whose fields are its parameters, in order and in SI units, with the
    names of `parameters`. Another package adds its own under the entry-point group ``reliab.effects``.

    Attributes
    ----------
    name : str
        Unique name, as files and reports call it.
    block : Block
        Part of the loop to which it belongs.
    role : Role
        Where it is plugged in.
    description : str
        What it does, in words of a laboratory engineer.
    parameters : tuple of Parameter
        Units, bounds and priors of the fields.
    reported_name : str, optional
        Name under which a diagnosis reports it, where variants of an effect share one.
    position : str, optional
        Position within its block, given only where variants differ in it.
    refines : type, optional
        Simpler effect, with its parameters first, of which this one is a special form; it is tried only as a
        replacement of that effect.
    limiting_cases : tuple of type, optional
        Simpler effects that this one resembles at an end of its parameters' ranges.
    """

    name: ClassVar[str]
    block: ClassVar[Block]
    role: ClassVar[Role]
    description: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    reported_name: ClassVar[str] = ""
    position: ClassVar[str] = ""
    refines: ClassVar["type[Effect] | None"] = None
    limiting_cases: ClassVar["tuple[type[Effect], ...]"] = ()

    def __post_init__(self) -> None:
        for parameter in self.parameters:
            value = getattr(self, parameter.name)
            if not np.isfinite(value):
                raise InputError(
                    f"The parameter {parameter.name} of {self.name} must be finite",
                    value=value,
                    remedy=f"Give {parameter.meaning} in {parameter.units}",
                )
            if not (parameter.signed or value > 0.0):
                raise InputError(
                    f"The parameter {parameter.name} of {self.name} must be positive",
                    value=value,
                    remedy=f"Give {parameter.meaning} in {parameter.units}",
                )

    @property
    def values(self) -> NDArray[np.float64]:
        """Parameters in order, SI units."""
        return np.array([getattr(self, parameter.name) for parameter in self.parameters], dtype=np.float64)

    @classmethod
    def label(cls) -> str:
        """Name under which a diagnosis reports the effect."""
        return str(cls.reported_name or cls.name)

    @classmethod
    def of(cls, values: NDArray[np.float64]) -> Self:
        """Build the effect from its parameters in order."""
        names = [field.name for field in fields(cls)]
        return cls(**dict(zip(names, map(float, values), strict=True)))

    def coefficients(self, setting: Setting) -> NDArray[np.float64]:
        """Return the kernel's coefficients; the parameters themselves unless an effect overrides this."""
        del setting
        return self.values


class SteppedEffect(Effect):
    """An effect that acts step by step."""

    kernel: ClassVar[Kernel]


class RecordEffect(Effect):
    """An effect on the ground acceleration as a whole."""

    @abstractmethod
    def applied(self, acceleration: NDArray[np.float64], step: float) -> NDArray[np.float64]:
        """Return the ground acceleration that acted [m/s²], given the recorded one and its step [s]."""


class LinearEffect(SteppedEffect):
    """An effect on the piston's motion that has a transfer function."""

    @abstractmethod
    def transfer(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Transfer function [-] from the motion without to the motion with the effect at s [rad/s]."""
