"""Parameters of effects: name, units, and the size to expect in a given campaign."""

import math
from dataclasses import dataclass

from reliab.errors import InputError


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
    >>> scales.of((("force", 1.0), ("velocity", -1.0)))
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

    def of(self, exponents: tuple[tuple[str, float], ...]) -> float:
        """Product of powers of the scales."""
        return float(math.prod(float(getattr(self, name)) ** exponent for name, exponent in exponents))


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
        return scales.of(self.scale)

    def coordinate(self, value: float, scales: Scales) -> float:
        """Coordinate in which the parameter is fitted: itself if signed, else its logarithm."""
        relative = value / self.unit(scales)
        return relative - self.neutral if self.signed else math.log(relative)

    def value(self, coordinate: float, scales: Scales) -> float:
        """SI value at a coordinate."""
        relative = coordinate + self.neutral if self.signed else math.exp(coordinate)
        return relative * self.unit(scales)

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
