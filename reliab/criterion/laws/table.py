"""A table of limits, interpolated in dimensionless form between the structures that were simulated."""

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.criterion.laws.law import Law, Limits, Validity, scales, validate_grid, validate_limits


def tents(nodes: Array, x: Array) -> Array:
    """Weights of nodes in a linear interpolation over ln x.

    `nodes` (nodes,); `x` any shape; returns (..., nodes).

    >>> tents(np.array([1.0, 4.0, 16.0]), np.array([2.0, 16.0])).tolist()
    [[0.5, 0.5, 0.0], [0.0, 0.0, 1.0]]
    """
    if nodes.size == 1:
        return np.ones((*x.shape, 1))
    grid, logarithm = np.log(nodes), np.clip(np.log(x), np.log(nodes[0]), np.log(nodes[-1]))
    return np.stack([np.interp(logarithm, grid, unit) for unit in np.eye(nodes.size)], axis=-1)


@dataclass(frozen=True, kw_only=True)
class TabulatedLimits(Law):
    """Limits of a grid of structures; of a single one, as in equation (12), in the simplest case.

    Between grid points ln(a/ξ²) and ln(bω₀²/ξ²) are linear in ln f and ln ξ.

    >>> grid = {"frequencies": (1.0, 2.0), "damping_ratios": (0.02,)}
    >>> law = TabulatedLimits(**grid, a=((1e-4,), (1e-4,)), b=((4.0,), (1.0,)))
    >>> [float(limit.round(6)) for limit in law.limits(np.sqrt(2.0), 0.02)]
    [0.0001, 2.0]
    """

    name: ClassVar[str] = "table"
    equation: ClassVar[str] = "a/ξ² and bω₀²/ξ² interpolated between simulated structures"

    frequencies: tuple[float, ...]  # frequencies, damping_ratios: The grid [Hz, -], increasing
    damping_ratios: tuple[float, ...]
    # a, b: Limits [-] and [ms²], shape (frequencies, damping ratios); zero where no test is accepted
    a: tuple[tuple[float, ...], ...]
    b: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        frequencies = validate_grid("natural frequencies", self.frequencies)
        damping_ratios = validate_grid("damping ratios", self.damping_ratios)
        for name, limits in (("a", self.a), ("b", self.b)):
            validate_limits(name, limits, (frequencies.size, damping_ratios.size))

    @classmethod
    def fit(cls, frequencies: ArrayLike, damping_ratios: ArrayLike, a: ArrayLike, b: ArrayLike) -> Self:
        """Keep limits a [-] and b [ms²], shape (frequencies, damping ratios), as they are."""
        return cls(
            frequencies=tuple(np.asarray(frequencies, dtype=np.float64).tolist()),
            damping_ratios=tuple(np.asarray(damping_ratios, dtype=np.float64).tolist()),
            a=tuple(tuple(row) for row in np.asarray(a, dtype=np.float64).tolist()),
            b=tuple(tuple(row) for row in np.asarray(b, dtype=np.float64).tolist()),
        )

    @property
    def validity(self) -> Validity:
        """The hull of the grid."""
        return Validity(
            frequency=(self.frequencies[0], self.frequencies[-1]),
            damping_ratio=(self.damping_ratios[0], self.damping_ratios[-1]),
        )

    def _limits(self, f: Array, xi: Array) -> Limits:
        f_weights = tents(np.asarray(self.frequencies), f)
        xi_weights = tents(np.asarray(self.damping_ratios), xi)
        nodes = scales(np.asarray(self.frequencies)[:, None], np.asarray(self.damping_ratios)[None, :])
        a, b = (
            scale * _geometric_mean(np.asarray(limits) / node_values, f_weights, xi_weights)
            for limits, node_values, scale in zip((self.a, self.b), nodes, scales(f, xi), strict=True)
        )
        return a, b


def _geometric_mean(values: Array, f_weights: Array, xi_weights: Array) -> Array:
    """Weighted geometric mean over the grid; zero where a value that counts is zero."""
    weights = f_weights[..., :, None] * xi_weights[..., None, :]
    zero = ((weights > 0.0) & (values == 0.0)).any(axis=(-2, -1))
    logarithms = np.log(np.where(values > 0.0, values, 1.0))
    return np.where(zero, 0.0, np.exp((weights * logarithms).sum(axis=(-2, -1))))
