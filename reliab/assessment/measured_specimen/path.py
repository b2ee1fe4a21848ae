"""What a test shows of its specimen, and coefficients of elements that fit it.

Force and elements pass one filter. Near the ends of a test, where it reaches beyond what was recorded, they
are not compared: how a history goes on there is a guess, and differs between the two.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.measured_specimen.elements import Elements
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.core.arrays import Array
from reliab.signals.filters import REACH

_RIDGE = 1e-8  # of an element's own mean square
_UNEXCITED_SHARE = 1e-4  # of the most excited element, below which one bears next to nothing
_SAMPLES_PER_PERIOD = 4.0  # samples in a period of the highest frequency that is kept
_ITERATIONS = 100  # for each element


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredPath:
    """What is known of a specimen: the path along which it was moved, and its force."""

    displacement: Array  # Smoothed, shape (n,) [m]
    force: Array  # Smoothed, shape (n,) [N]
    time_step: float  # Step [s]
    noise: SensorNoise  # Its filter is passed by elements, too
    block: float  # Length of a block [s]
    noisy: float  # RMS of the noise of force and displacement within the band, over that of the force [-]

    @cached_property
    def energy_share(self) -> Array:
        """Work done on the specimen so far, to and fro, over that of the whole test, shape (n,)."""
        work = np.cumsum(np.abs(np.gradient(self.displacement) * (self.force - self.force.mean())))
        return np.asarray(work / work[-1])

    @property
    def largest(self) -> float:
        """Largest displacement [m]."""
        return float(np.abs(self.displacement).max())

    @cached_property
    def speed(self) -> float:
        """Largest speed [m/s]."""
        return float(np.abs(np.gradient(self.displacement, self.time_step)).max())

    @property
    def stride(self) -> int:
        """Number of samples of which one tells all that the filter passes."""
        return max(int(1.0 / (_SAMPLES_PER_PERIOD * self.noise.band * self.time_step)), 1)

    @property
    def reach(self) -> int:
        """Number of samples at either end that the filter sees only one side of."""
        reach = self.noise.filter.size // 2
        return reach if reach <= REACH * self.displacement.size else 0

    @cached_property
    def force_seen(self) -> Array:
        """Force that elements should have, as the channels see it [N], shape (m,)."""
        return np.asarray(self.thin(self.force))

    def thin(self, history: Array) -> Array:
        """Keep the samples of histories, shape (…, n), that are compared, shape (…, m)."""
        inner = slice(self.reach, history.shape[-1] - self.reach, self.stride)
        return np.ascontiguousarray(history[..., inner])

    @property
    def blocks(self) -> NDArray[np.int64]:
        """Number of the block of each sample that is fitted, shape (m,)."""
        times = np.arange(self.force_seen.size) * self.stride * self.time_step
        return np.asarray(times / self.block, dtype=np.int64)

    def responses(self, elements: Elements) -> Array:
        """Displacements of elements along the path, as the channels see them, shape (elements, m)."""
        return self.filter(elements.follow_path(self.displacement, self.time_step, self.energy_share))

    def filter(self, rows: Array) -> Array:
        """Histories, shape (rows, n), as the channels see them, shape (rows, m)."""
        if self.reach == 0:
            return self.thin(rows)
        ahead = -2 * self.reach % self.stride  # zeros that put the first whole sum on a sample that is kept
        filtered = scipy.signal.upfirdn(
            self.noise.filter, np.pad(rows, ((0, 0), (ahead, 0))), down=self.stride, axis=1
        )
        first = (ahead + 2 * self.reach) // self.stride
        return np.asarray(filtered[:, first : first + self.force_seen.size])


def fit(rows: Array, target: Array, weights: Array | None = None) -> Array:
    """Coefficients that are not negative and make rows, shape (elements, n), sum to what is wanted."""
    weighted = rows if weights is None else rows * weights
    squares = weighted @ rows.T
    scale = np.sqrt(np.diag(squares))
    scale = scale + _UNEXCITED_SHARE * float(scale.max())
    normal = squares / np.outer(scale, scale) + _RIDGE * np.eye(scale.size)
    root = np.linalg.cholesky(normal)
    aim = np.linalg.solve(root, weighted @ target / scale)
    return np.asarray(scipy.optimize.nnls(root.T, aim, maxiter=_ITERATIONS * scale.size)[0] / scale)
