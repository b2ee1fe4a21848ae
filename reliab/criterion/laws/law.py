"""What every law of frequency and damping can do, where it holds, and what its numbers must be."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.vocabulary import MILLI


def scales(frequency: ArrayLike, damping_ratio: ArrayLike) -> tuple[Array, Array]:
    """Ellipse parameters of a structure for α = β = 1.

    Near resonance the error of a test depends on the complex actuator error over the damping alone. To first
    order the ellipse is therefore a = α ξ², b = β (ξ/ω₀)², with α and β depending on how long and how
    broad-band the motion is, and hardly on the structure.

    `frequency`, `damping_ratio`: structures [Hz, -], broadcast against each other. Returns ξ² [-] and (ξ/ω₀)²
    [ms²].

    >>> a, b = scales(1.0, 0.02)
    >>> round(float(a), 6), round(float(b), 3)
    (0.0004, 10.132)
    """
    f, xi = np.broadcast_arrays(
        np.asarray(frequency, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
    )
    return xi**2, MILLI**2 * (xi / (2.0 * np.pi * f)) ** 2


_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Validity:
    """Ranges outside of which a law refuses to answer.

    >>> Validity(frequency=(0.25, 2.0), damping_ratio=(0.02, 0.02)).require(1.0, 0.05)
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: The law does not hold for this damping ratio, only at 0.02; found 0.05. ...
    """

    frequency: tuple[float, float]  # Least and greatest natural frequency [Hz]
    damping_ratio: tuple[float, float]  # Least and greatest damping ratio [-]
    threshold: float | None = None  # The one error [-] that the law is for; None leaves it to the criterion
    metric: str | None = None  # The one metric that the law is for; None leaves it to the criterion

    def require(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> None:
        """Raise an error where a structure lies outside.

        `frequency`, `damping_ratio` [Hz, -].
        """
        _require("natural frequency", frequency, self.frequency, " Hz")
        _require("damping ratio", damping_ratio, self.damping_ratio, "")

    def require_error(self, threshold: float, metric: str) -> None:
        """Raise an error where the law is for another threshold or metric.

        `threshold` [-].
        """
        if self.threshold is not None and not np.isclose(threshold, self.threshold, rtol=_ROUNDING):
            raise InputError(
                f"The law is for an error of {self.threshold:g} only",
                value=f"{threshold:g}",
                remedy="Choose another law, or derive a criterion from ellipses at that threshold",
            )
        if self.metric is not None and metric != self.metric:
            raise InputError(
                f"The law is for the metric {self.metric} only",
                value=metric,
                remedy="Choose another law, or derive a criterion from ellipses of that metric",
            )


def _require(name: str, value: ArrayLike, bounds: tuple[float, float], unit: str) -> None:
    values = np.atleast_1d(np.asarray(value, dtype=np.float64))
    low, high = bounds
    is_inside = (values >= low * (1.0 - _ROUNDING)) & (values <= high * (1.0 + _ROUNDING))
    if not is_inside.all():
        range_text = f"at {low:g}{unit}" if low == high else f"between {low:g} and {high:g}{unit}"
        raise InputError(
            f"The law does not hold for this {name}, only {range_text}",
            value=f"{values[~is_inside].flat[0]:g}{unit}",
            remedy="Choose another law, or derive a criterion from ellipses of that structure",
        )


LARGEST = 1e30
"""Beyond any structure and any boundary, and its square is still a number."""

_REMEDY = "Derive the criterion again; few motions give limits of zero, never negative ones"


def validate_limits(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return limits as an array, or say what is wrong with them."""
    limits = _numbers(f"limits {name}", values)
    if limits.shape != shape:
        raise InputError(
            f"The limits {name} of a law must have one number for each structure, shape {shape}",
            value=f"shape {limits.shape}",
            remedy=_REMEDY,
        )
    wrong = ~((limits >= 0.0) & (limits <= LARGEST))
    if wrong.any():
        raise InputError(
            f"The limits {name} of a law must be finite, at most {LARGEST:g}, and not negative",
            value=limits[wrong].flat[0],
            remedy=_REMEDY,
        )
    return limits


def validate_grid(name: str, values: ArrayLike) -> Array:
    """Return the frequencies or damping ratios of a law, or say what is wrong with them."""
    grid = _numbers(name, values)
    increasing = grid.ndim == 1 and grid.size > 0 and bool((np.diff(grid) > 0.0).all())
    if not (increasing and grid[0] >= 1.0 / LARGEST and grid[-1] <= LARGEST):
        raise InputError(
            f"The {name} of a law must be positive, finite, at most {LARGEST:g}, and increasing",
            value=str(np.asarray(values).tolist()),
            remedy="Derive the criterion again",
        )
    return grid


def validate_coefficients(name: str, values: ArrayLike, terms: int) -> None:
    """Refuse coefficients that are not finite, or not as many as the law has terms."""
    coefficients = _numbers(f"coefficients of {name}", values)
    if coefficients.shape != (terms,) or not np.isfinite(coefficients).all():
        raise InputError(
            f"The law's coefficients of {name} must be {terms} finite numbers",
            value=str(np.asarray(values).tolist()),
            remedy="Derive the criterion again",
        )


def _numbers(name: str, values: ArrayLike) -> Array:
    try:
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"The {name} of a law must be numbers in rows of one length",
            value=str(error),
            remedy="Derive the criterion again",
        ) from error


Limits = tuple[Array, Array]
"""Ellipse parameters a [-] and b [ms²]."""


class Law(ABC):
    """How the limits a and b depend on the structure."""

    name: ClassVar[str]  # How the law is called on the command line
    equation: ClassVar[str]  # The law in the paper's notation
    # Whether the law, as it is printed, holds for delays of either sign
    counts_leads_as_lags: ClassVar[bool] = False

    @property
    @abstractmethod
    def validity(self) -> Validity:
        """Where the law holds."""

    def limits(self, frequency: ArrayLike, damping_ratio: ArrayLike) -> Limits:
        """Limits of structures.

        `frequency` [Hz]; `damping_ratio` [-].
        """
        self.validity.require(frequency, damping_ratio)
        f, xi = np.broadcast_arrays(
            np.asarray(frequency, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
        )
        a, b = self._limits(f, xi)
        return (
            validate_limits("a", np.broadcast_to(a, f.shape), f.shape),
            validate_limits("b", np.broadcast_to(b, f.shape), f.shape),
        )

    @abstractmethod
    def _limits(self, f: Array, xi: Array) -> tuple[ArrayLike, ArrayLike]:
        """Limits inside the validity; f and xi have one shape, to which theirs can be broadcast."""


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
            validate_grid(name, np.unique(bounds))
        terms = self._terms(np.ones(1), np.ones(1))
        for name, coefficients, law_terms in zip(
            ("a", "b"), (self.coefficients_a, self.coefficients_b), terms, strict=True
        ):
            validate_coefficients(name, coefficients, law_terms.shape[-1])

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
            _require_positive(validate_limits(name, limits, (grid_f.size, grid_xi.size)))
        coefficients = (
            np.linalg.lstsq(terms, np.log(np.ravel(limits) / reference), rcond=None)[0]
            for terms, limits, reference in zip(
                cls._terms(f, xi), (a, b), cls._references(f, xi), strict=True
            )
        )
        a_coefficients, b_coefficients = (tuple(values.tolist()) for values in coefficients)
        return cls(
            coefficients_a=a_coefficients,
            coefficients_b=b_coefficients,
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
            "At a structure the limits are zero, which no law of f and ξ can follow",
            value=f"limits of zero at {int((limits == 0.0).sum())} structures",
            remedy="Give more motions or a lower confidence, or keep the limits as a table",
        )
