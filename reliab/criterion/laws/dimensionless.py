"""Dimensionless limits that vary slowly with frequency and damping."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.criterion.laws.law import Limits, LogLinearLaw, scales

_REFERENCE_DAMPING = 0.05


@dataclass(frozen=True, kw_only=True)
class Dimensionless(LogLinearLaw):
    """a = α ξ², b = β (ξ/ω₀)², with ln α and ln β quadratic in ln f and ln ξ.

    The physics gives the powers of ξ and ω₀; the remainder varies by a factor of about three over
    f 0.25–2 Hz and ξ 0.02–0.10, where a and b themselves move over four decades. Six terms each:
    1, φ, η, φ², φη, η² with φ = ln(f / 1 Hz) and η = ln(ξ / 0.05).

    >>> f, xi = np.array([0.25, 0.5, 1.0, 2.0]), np.array([0.02, 0.05, 0.1])
    >>> a, b = scales(f[:, None], xi[None, :])
    >>> law = Dimensionless.fit(f, xi, 0.2 * a, 0.1 * b)
    >>> np.exp([law.coefficients_a[0], law.coefficients_b[0]]).round(6)  # α and β at 1 Hz and 5 %
    array([0.2, 0.1])
    """

    name: ClassVar[str] = "dimensionless"
    equation: ClassVar[str] = "a = α(f, ξ) ξ², b = β(f, ξ) (ξ/ω₀)²"

    @classmethod
    def terms_of(cls, frequencies: Array, damping_ratios: Array) -> Array:
        """Terms of ln α and ln β over a grid [Hz, -], shape (F, X, 6)."""
        return cls._terms(*np.meshgrid(frequencies, damping_ratios, indexing="ij"))[0]

    @staticmethod
    def _terms(f: Array, xi: Array) -> tuple[Array, Array]:
        phi, eta = np.log(f), np.log(xi / _REFERENCE_DAMPING)
        terms = np.stack([np.ones_like(phi), phi, eta, phi**2, phi * eta, eta**2], axis=-1)
        return terms, terms

    @staticmethod
    def _references(f: Array, xi: Array) -> Limits:
        return scales(f, xi)
