"""What an effect is: its parameters, its place in the hybrid test, and the base classes it derives from."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields
from enum import StrEnum
from typing import ClassVar, Self

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import Block
from reliab.effects.kernel import Kernel


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Peak values of the tests at hand; every bound and prior is a multiple of these.

    Parameters
    ----------
    displacement, velocity, acceleration : float
        Peaks of the motion [m, m/s, m/s²].
    force : float
        Peak of the force [N].
    duration : float
        Length of the longest test [s].

    Examples
    --------
    >>> scales = Scales(displacement=0.1, velocity=0.5, acceleration=3.0, force=200.0, duration=40.0)
    >>> scales.product((("force", 1.0), ("velocity", -1.0)))
    400.0
    """

    displacement: float
    velocity: float
    acceleration: float
    force: float
    duration: float

    def __post_init__(self) -> None:
        for name in ("displacement", "velocity", "acceleration", "force", "duration"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise InputError(
                    f"The scale of {name} must be positive and finite",
                    value=value,
                    remedy="Leave out tests in which nothing moves",
                )

    def product(self, exponents: tuple[tuple[str, float], ...]) -> float:
        """Product of powers of the scales."""
        return float(math.prod(float(getattr(self, name)) ** exponent for name, exponent in exponents))


_ROUNDING = 1e-15  # of a dimensionless parameter, which is then zero


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter of an effect.

    Its prior is a normal distribution about zero for a parameter that may have either sign and a lognormal
    one for a positive parameter; both are cut at the bounds.

    Parameters
    ----------
    name : str
        Name with the unit, as in files and on the effect itself ("force_n").
    units : str
        Unit as it is displayed ("N").
    meaning : str
        What it is, in a few words.
    scale : tuple of (str, float), optional
        Powers of the campaign's scales whose product makes the parameter dimensionless.
    signed : bool, optional
        Whether it may be negative.
    neutral : float, optional
        Dimensionless value without effect, for a signed parameter.
    typical : float, optional
        Dimensionless size to expect: standard deviation of a normal prior, median of a lognormal one.
    spread : float, optional
        Standard deviation of the logarithm of a positive parameter.
    precise : bool, optional
        Whether it is a ratio of times: simulation and machine differ by a share of its departure from no
        effect and by a phase, not by a share of the whole value.
    lower, upper : float
        Dimensionless bounds.
    starts : tuple of float
        Dimensionless values from which a fit starts.
    """

    name: str
    units: str
    meaning: str
    scale: tuple[tuple[str, float], ...] = ()
    signed: bool = False
    neutral: float = 0.0
    typical: float = 1.0
    spread: float = 1.5
    precise: bool = False
    lower: float
    upper: float
    starts: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.lower < self.upper:
            raise InputError(
                f"The lower bound of {self.name} must be below the upper one",
                value=f"{self.lower} and {self.upper}",
                remedy="Exchange them",
            )
        if not (self.signed or self.lower > 0.0):
            raise InputError(
                f"The lower bound of {self.name} must be positive, unless the parameter is signed",
                value=self.lower,
                remedy="Give a small positive bound or say signed=True",
            )

    def unit(self, scales: Scales) -> float:
        """SI value of the dimensionless one."""
        return scales.product(self.scale)

    def coordinate(self, value: float, scales: Scales) -> float:
        """Coordinate in which the parameter is fitted: itself if signed, else its logarithm."""
        relative = value / self.unit(scales)
        return relative - self.neutral if self.signed else math.log(relative)

    def value(self, coordinate: float, scales: Scales) -> float:
        """SI value at a coordinate."""
        relative = coordinate + self.neutral if self.signed else math.exp(coordinate)
        return relative * self.unit(scales) if abs(relative) > _ROUNDING else 0.0

    def derivative(self, coordinate: float, scales: Scales) -> float:
        """Differentiate the SI value by the coordinate."""
        return self.unit(scales) * (1.0 if self.signed else math.exp(coordinate))

    @property
    def coordinate_bounds(self) -> tuple[float, float]:
        """Bounds of the coordinate."""
        if self.signed:
            return self.lower - self.neutral, self.upper - self.neutral
        return math.log(self.lower), math.log(self.upper)

    @property
    def coordinate_prior(self) -> tuple[float, float]:
        """Mean and standard deviation of the normal prior of the coordinate."""
        return (0.0, self.typical) if self.signed else (math.log(self.typical), self.spread)


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
    moved_before : float
        Largest displacement of the specimen in earlier tests [m].
    """

    step: float
    stiffness: float = 0.0
    damping: float = 0.0
    moved_before: float = 0.0


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
    members : tuple of type, optional
        Effects that this one is composed of, under whose names a diagnosis reports it.
    remembers_peaks : bool, optional
        Whether it depends on the largest displacement so far, and not on the present motion alone.
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
    members: ClassVar["tuple[type[Effect], ...]"] = ()
    remembers_peaks: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for parameter in self.parameters:
            value = getattr(self, parameter.name)
            require_physical(
                "number",
                value,
                zero=parameter.signed,
                signed=parameter.signed,
                label=f"parameter {parameter.name} of {self.name}",
                remedy=f"Give {parameter.meaning} in {parameter.units}",
            )

    @property
    def values(self) -> Array:
        """Parameters in order, SI units."""
        return np.array([getattr(self, parameter.name) for parameter in self.parameters], dtype=np.float64)

    @classmethod
    def label(cls) -> str:
        """Name under which a diagnosis reports the effect."""
        return str(cls.reported_name or cls.name)

    @classmethod
    def from_values(cls, values: Array) -> Self:
        """Build the effect from its parameters in order."""
        names = [field.name for field in fields(cls)]
        return cls(**dict(zip(names, map(float, values), strict=True)))

    def coefficients(self, setting: Setting) -> Array:
        """Return the kernel's coefficients; the parameters themselves unless an effect overrides this."""
        del setting
        return self.values


class SteppedEffect(Effect):
    """An effect that acts step by step."""

    kernel: ClassVar[Kernel]


class RecordEffect(Effect):
    """An effect on the ground acceleration as a whole."""

    @abstractmethod
    def applied(self, acceleration: Array, step: float) -> Array:
        """Return the ground acceleration that acted [m/s²], given the recorded one and its step [s]."""


class LinearEffect(SteppedEffect):
    """An effect on the piston's motion that has a transfer function."""

    @abstractmethod
    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function [-] from the motion without to the motion with the effect at s [rad/s]."""
