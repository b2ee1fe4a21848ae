"""The single-degree-of-freedom structure of which one part is tested."""

import math
from dataclasses import dataclass

from reliab.errors import InputError

_FREQUENCIES = (0.01, 1e6)
_LEAST_RATIO = 1e-12
"""Limits far beyond any structure, within which powers and ratios of its numbers are numbers too."""


@dataclass(frozen=True, kw_only=True)
class Structure:
    """A linear elastic single-degree-of-freedom structure, divided for hybrid simulation.

    Parameters
    ----------
    frequency : float
        Natural frequency f of the whole structure [Hz].
    damping_ratio : float
        Inherent damping ratio ξ [-], in (0, 1).
    experimental_fraction : float, optional
        Share α of the stiffness that stands in the laboratory [-], in (0, 1]; the paper's worst
        case, and the default, is 1.

    Examples
    --------
    >>> Structure(frequency=1.0, damping_ratio=0.02).circular_frequency
    6.283185307179586
    """

    frequency: float
    damping_ratio: float
    experimental_fraction: float = 1.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.frequency) and self.frequency > 0.0):
            raise InputError(
                "The natural frequency must be positive and finite",
                value=f"{self.frequency} Hz",
                remedy="Give the frequency of the whole structure in hertz",
            )
        if not 0.0 < self.damping_ratio < 1.0:
            raise InputError(
                "The damping ratio must lie between 0 and 1",
                value=self.damping_ratio,
                remedy="Give a fraction of critical damping, 0.02 for 2 %",
            )
        if not 0.0 < self.experimental_fraction <= 1.0:
            raise InputError(
                "The share of the stiffness in the laboratory must lie in (0, 1]",
                value=self.experimental_fraction,
                remedy="Give the specimen's share of the total stiffness, 1 for all of it",
            )
        if not _FREQUENCIES[0] <= self.frequency <= _FREQUENCIES[1]:
            raise InputError(
                "The natural frequency must lie between 0.01 and 1e6 Hz",
                value=f"{self.frequency:g} Hz",
                remedy="Give the frequency of the whole structure in hertz",
            )
        for name, ratio in (
            ("damping ratio", self.damping_ratio),
            ("share of the stiffness in the laboratory", self.experimental_fraction),
        ):
            if ratio < _LEAST_RATIO:
                raise InputError(
                    f"The {name} must be at least {_LEAST_RATIO:g}",
                    value=ratio,
                    remedy="Give a fraction of 1",
                )

    @property
    def circular_frequency(self) -> float:
        """Natural circular frequency ω₀ [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @property
    def pole(self) -> complex:
        """Pole p = −ξω₀ + iω₀√(1 − ξ²) of the structure's own mode [1/s]."""
        xi = self.damping_ratio
        return self.circular_frequency * complex(-xi, math.sqrt(1.0 - xi**2))
