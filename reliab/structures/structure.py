"""The single-degree-of-freedom structure of which one part is tested."""

import math
from dataclasses import dataclass

from reliab.core.physical_range import require_physical


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
        require_physical("natural frequency", self.frequency)
        require_physical("damping ratio", self.damping_ratio)
        require_physical("share of the stiffness in the laboratory", self.experimental_fraction)

    @property
    def circular_frequency(self) -> float:
        """Natural circular frequency ω₀ [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @property
    def pole(self) -> complex:
        """Pole p = −ξω₀ + iω₀√(1 − ξ²) of the structure's own mode [1/s]."""
        xi = self.damping_ratio
        return self.circular_frequency * complex(-xi, math.sqrt(1.0 - xi**2))
