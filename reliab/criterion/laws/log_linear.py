"""Laws that are linear in their logarithms, and how they are fitted to limits."""

from abc import abstractmethod
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.criterion.laws.law import (
    Law,
    Limits,
    Validity,
    checked_coefficients,
    checked_grid,
    checked_limits,
)


@dataclass(frozen=True, kw_only=True)
class LogLinearLaw(Law):
    """Limits ln(a/a₀) and ln(b/b₀) linear in terms of the structure."""

    coefficients_a: tuple[float, ...]  # coefficients_a, coefficients_b: Factors of the terms
    coefficients_b: tuple[float, ...]
    # frequency, damping_ratio: Least and greatest value [Hz, -] of the structures that the law was fitted to
    frequency: tuple[float, float]
    damping_ratio: tuple[float, float]

    def __post_init__(self) -> None:
        for name, bounds in (("natural frequencies", self.frequency), ("damping ratios", self.damping_ratio)):
            checked_grid(name, np.unique(bounds))
        terms = self._terms(np.ones(1), np.ones(1))
        for name, coefficients, of_law in zip(
            ("a", "b"), (self.coefficients_a, self.coefficients_b), terms, strict=True
        ):
            checked_coefficients(name, coefficients, of_law.shape[-1])

    @classmethod
    def fit(cls, frequencies: ArrayLike, damping_ratios: ArrayLike, a: ArrayLike, b: ArrayLike) -> Self:
        """Fit by least squares of logarithms.

        `frequencies`, `damping_ratios` [Hz, -].
        Returns the law, valid within the grid; terms that the grid cannot separate share their effect.
        """
        grid_f, grid_xi = (
            np.asarray(frequencies, dtype=np.float64),
            np.asarray(damping_ratios, dtype=np.float64),
        )
        f, xi = (grid.ravel() for grid in np.meshgrid(grid_f, grid_xi, indexing="ij"))
        for name, limits in (("a", a), ("b", b)):
            _require_positive(checked_limits(name, limits, (grid_f.size, grid_xi.size)))
        coefficients = (
            np.linalg.lstsq(terms, np.log(np.ravel(limits) / reference), rcond=None)[0]
            for terms, limits, reference in zip(
                cls._terms(f, xi), (a, b), cls._references(f, xi), strict=True
            )
        )
        of_a, of_b = (tuple(values.tolist()) for values in coefficients)
        return cls(
            coefficients_a=of_a,
            coefficients_b=of_b,
            frequency=(float(grid_f.min()), float(grid_f.max())),
            damping_ratio=(float(grid_xi.min()), float(grid_xi.max())),
        )

    @property
    def validity(self) -> Validity:
        """The structures that the law was fitted to."""
        return Validity(frequency=self.frequency, damping_ratio=self.damping_ratio)

    def _limits(self, f: Array, xi: Array) -> Limits:
        (terms_a, terms_b), (reference_a, reference_b) = self._terms(f, xi), self._references(f, xi)
        a = reference_a * np.exp(terms_a @ np.asarray(self.coefficients_a))
        b = reference_b * np.exp(terms_b @ np.asarray(self.coefficients_b))
        return a, b

    @staticmethod
    @abstractmethod
    def _terms(f: Array, xi: Array) -> tuple[Array, Array]:
        """Terms of a and of b, shape (..., terms) each."""

    @staticmethod
    @abstractmethod
    def _references(f: Array, xi: Array) -> Limits:
        """Return a₀ [-] and b₀ [ms²]."""


def _require_positive(limits: Array) -> None:
    if (limits == 0.0).any():
        raise InputError(
            "A law of f and ξ needs positive limits at every structure",
            value=f"limits of zero at {int((limits == 0.0).sum())} structures",
            remedy="Give more motions or a lower confidence, or keep the limits as a table",
        )
