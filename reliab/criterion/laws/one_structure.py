"""No law at all: limits of the one structure whose ellipses were traced, as in equation (12)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.laws.law import Law, Limits
from reliab.criterion.laws.validity import Validity


@dataclass(frozen=True, kw_only=True)
class OneStructure(Law):
    """Constant limits, valid for a single structure.

    Parameters
    ----------
    a, b : float
        Ellipse parameters [-] and [ms²].
    frequency, damping_ratio : float
        The structure [Hz, -].

    Examples
    --------
    >>> law = OneStructure(a=5.3e-5, b=1.04, frequency=1.0, damping_ratio=0.02)
    >>> [float(limit) for limit in law.limits(1.0, 0.02)]
    [5.3e-05, 1.04]
    """

    name: ClassVar[str] = "one_structure"
    equation: ClassVar[str] = "(A − 1)²/a + d²/b ≤ 1"

    a: float
    b: float
    frequency: float
    damping_ratio: float

    @property
    def validity(self) -> Validity:
        """The structure itself."""
        return Validity(
            frequency=(self.frequency, self.frequency),
            damping_ratio=(self.damping_ratio, self.damping_ratio),
        )

    def _limits(self, f: NDArray[np.float64], xi: NDArray[np.float64]) -> Limits:
        del f, xi
        return np.asarray(self.a), np.asarray(self.b)
