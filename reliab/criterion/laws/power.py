"""Power law of frequency and damping."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.criterion.laws.law import Limits, LogLinearLaw


@dataclass(frozen=True, kw_only=True)
class Power(LogLinearLaw):
    """a = c f^p ξ^q and b = c′ f^p′ ξ^q′.

    >>> xi = np.array([0.02, 0.05])
    >>> law = Power.fit([1.0, 2.0], xi, 0.3 * np.stack([xi, xi]) ** 2, np.stack([xi, xi / 4.0]))
    >>> np.round(law.coefficients_b, 6)[1:] + 0.0  # exponents of f and ξ
    array([-2.,  1.])
    """

    name: ClassVar[str] = "power"
    equation: ClassVar[str] = "a = c f^p ξ^q, b = c′ f^p′ ξ^q′"

    @staticmethod
    def _terms(f: Array, xi: Array) -> tuple[Array, Array]:
        terms = np.stack([np.ones_like(f), np.log(f), np.log(xi)], axis=-1)
        return terms, terms

    @staticmethod
    def _references(f: Array, xi: Array) -> Limits:
        del xi
        return np.ones_like(f), np.ones_like(f)
