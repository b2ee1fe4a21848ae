"""The form of equations (13) and (16), fitted: b falls exponentially with frequency, both grow with ξ."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.criterion.laws.law import Limits, LogLinearLaw


@dataclass(frozen=True, kw_only=True)
class Exponential(LogLinearLaw):
    """a = k₃ξ, b = k₁ξ e^(−k₂f), the form of equation (18) with fitted factors.

    Kept for comparison: neither b over frequency nor a and b over damping have this form.

    >>> law = Exponential.fit([0.5, 1.0, 2.0], [0.02], [[1e-4]] * 3, np.exp([[-1.0], [-2.0], [-4.0]]))
    >>> round(-law.coefficients_b[1], 6)  # k₂
    2.0
    """

    name: ClassVar[str] = "exponential"
    equation: ClassVar[str] = "a = k₃ξ, b = k₁ξ e^(−k₂f)"

    @staticmethod
    def _terms(f: Array, xi: Array) -> tuple[Array, Array]:
        del xi
        constant = np.ones_like(f)
        return constant[..., None], np.stack([constant, f], axis=-1)

    @staticmethod
    def _references(f: Array, xi: Array) -> Limits:
        del f
        return xi, xi
