"""Tests predicted without their earthquake, by one inverse of the covariance of all tests.

With the inverse P of the covariance and u = P y, the residual of tests e that are left out together is
P_ee⁻¹ u_e and its covariance P_ee⁻¹ (Rasmussen and Williams 2006, 5.4.2). Where an earthquake g is not
there at all, P_ee − P_eg P_gg⁻¹ P_ge and u_e − P_eg P_gg⁻¹ u_g take their places.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.rig.learning.variances import Variances, covariance, inverse_of

_SMALLEST = 1e-9


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Residuals of tests that are predicted without their earthquake."""

    inverse: Array  # Of the covariance of all tests
    solved: Array  # Times their values
    ordinary: Array  # Variance of an ordinary test less that of each, which the odd ones have more of
    events: NDArray[np.str_]

    @classmethod
    def of_tests(
        cls, standard: Array, among: Array, variances: Variances, events: NDArray[np.str_]
    ) -> "LeftOut":
        """Leave out each earthquake at the most probable variances."""
        noise = np.exp(2.0 * variances.mode[-1])
        matrix = covariance(among, variances.mode)
        matrix[np.diag_indices(standard.size)] += noise / variances.weights
        inverse, _ = inverse_of(matrix)
        return cls(
            inverse=inverse,
            solved=inverse @ standard,
            ordinary=noise * (1.0 - 1.0 / variances.weights),
            events=events,
        )

    @cached_property
    def members(self) -> list[NDArray[np.intp]]:
        """Places of the tests of each earthquake."""
        _, of_test = np.unique(self.events, return_inverse=True)
        ordered = np.argsort(of_test, kind="stable")
        return np.split(ordered, np.flatnonzero(np.diff(of_test[ordered])) + 1)

    @property
    def residuals(self) -> Array:
        """Residual of each test over its predicted spread."""
        return self._all[0]

    @property
    def spreads(self) -> Array:
        """Predicted spread of each test, if it is an ordinary one."""
        return self._all[1]

    def residuals_without(self, absent: NDArray[np.intp]) -> Array:
        """Return the same residuals if an earthquake had never been; zeros for its own tests."""
        taken = self.inverse[:, absent] @ np.linalg.inv(self.inverse[np.ix_(absent, absent)])
        return self._predicted(absent, taken)[0]

    @cached_property
    def _all(self) -> tuple[Array, Array]:
        return self._predicted(np.empty(0, dtype=np.intp), np.empty((self.solved.size, 0)))

    @cached_property
    def _by_size(self) -> list[NDArray[np.intp]]:
        """Places of the tests of all earthquakes of a size, shape (earthquakes, size) each."""
        sizes = np.array([places.size for places in self.members])
        return [
            np.array([self.members[index] for index in np.flatnonzero(sizes == size)])
            for size in np.unique(sizes)
        ]

    def _predicted(self, absent: NDArray[np.intp], taken: Array) -> tuple[Array, Array]:
        """Residuals over their spreads, and these, where what absent tests teach is taken away."""
        residuals, squares = np.zeros_like(self.solved), np.ones_like(self.solved)
        solved = self.solved - taken @ self.solved[absent]
        for every in self._by_size:
            places = every[~np.isin(every[:, 0], absent)]
            block = self.inverse[places[:, :, None], places[:, None, :]]
            across = self.inverse[:, absent][places]
            conditional = np.linalg.inv(block - taken[places] @ across.swapaxes(1, 2))
            residuals[places] = np.einsum("eij,ej->ei", conditional, solved[places])
            squares[places] = np.einsum("eii->ei", conditional) + self.ordinary[places]
        spreads = np.sqrt(np.maximum(squares, _SMALLEST))
        return residuals / spreads, spreads
