"""Learn from a test's own force what its specimen does, and say on held-out parts how well.

Coefficients are found by non-negative least squares over the smoothed force, elements whose size bears a part
are refined step by step, and four quarters of the test, made of short blocks, are predicted from the others.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.assessment.measured_specimen.elements import Elements, elements_of_family
from reliab.assessment.rebuilt_error.noise import SensorNoise

_REFINEMENTS = (1.15, 1.07, 1.035, 1.017)
_RIDGE = 1e-8  # of an element's own mean square
_UNEXCITED = 1e-4  # of the most excited element, below which one bears next to nothing
_QUARTERS = 4
_PER_BAND = 4.0  # samples in a period of the highest frequency that is kept
_ITERATIONS = 100  # for each element


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredPath:
    """What is known of a specimen: the path along which it was moved, and its force."""

    displacement: Array  # Smoothed, shape (n,) [m]
    force: Array  # Smoothed, shape (n,) [N]
    time_step: float  # Step [s]
    noise: SensorNoise  # Its filter is passed by elements, too
    block: float  # Length of a block [s]

    @cached_property
    def used(self) -> Array:
        """Work done on the specimen so far, to and fro, over that of the whole test, shape (n,)."""
        work = np.cumsum(np.abs(np.gradient(self.displacement) * (self.force - self.force.mean())))
        return np.asarray(work / work[-1])

    @property
    def every(self) -> int:
        """Number of samples of which one tells all that the filter passes."""
        return max(int(1.0 / (_PER_BAND * self.noise.band * self.time_step)), 1)

    @property
    def blocks(self) -> NDArray[np.int64]:
        """Number of the block of each sample that is fitted."""
        times = np.arange(0, self.displacement.size, self.every) * self.time_step
        return np.asarray(times / self.block, dtype=np.int64)

    def seen(self, rows: Array) -> Array:
        """Pass histories, shape (rows, n), through the filter of the channels, and thin them by `every`."""
        taps, thin = self.noise.filter, self.every
        reach = taps.size // 2
        if reach == 0 or reach >= rows.shape[1]:
            return np.ascontiguousarray(rows[:, ::thin])
        before = 2.0 * rows[:, :1] - rows[:, reach:0:-1]
        after = 2.0 * rows[:, -1:] - rows[:, -2 : -reach - 2 : -1]
        idle = np.zeros((rows.shape[0], -2 * reach % thin))
        passed = scipy.signal.upfirdn(taps, np.hstack([idle, before, rows, after]), down=thin, axis=1)
        first = (idle.shape[1] + 2 * reach) // thin
        return np.asarray(passed[:, first : first - (-rows.shape[1] // thin)])


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedSpecimen:
    """A specimen as one family of elements has learned it."""

    family: str  # Name of the family
    elements: Elements  # Those that bear a part
    coefficients: Array  # Of the elements [N/m], shape (elements,)
    held_out: float  # RMS of what held-out parts of the force leave unexplained, over that of the force [-]


def learn_specimen(path: MeasuredPath, family: str) -> LearnedSpecimen:
    """Learn a specimen with a family of elements."""
    step, used, wanted = path.time_step, path.used, path.force[:: path.every]
    largest = float(np.abs(path.displacement).max())
    speed = float(np.abs(np.gradient(path.displacement, step)).max())
    elements = elements_of_family(family, largest, speed)
    for ratio in _REFINEMENTS:
        coefficients = fit(path.seen(elements.along(path.displacement, step, used)), wanted)
        elements = elements.refined(coefficients, ratio)
    seen = path.seen(elements.along(path.displacement, step, used))
    coefficients = fit(seen, wanted)
    bears = coefficients > 0.0
    return LearnedSpecimen(
        family=family,
        elements=elements.only(bears),
        coefficients=coefficients[bears],
        held_out=_held_out(seen[bears], wanted, path.blocks),
    )


def fit(rows: Array, wanted: Array, weights: Array | None = None) -> Array:
    """Coefficients that are not negative and make rows, shape (elements, n), sum to what is wanted."""
    weighted = rows if weights is None else rows * weights
    squares = weighted @ rows.T
    scale = np.sqrt(np.diag(squares))
    scale = scale + _UNEXCITED * float(scale.max())
    normal = squares / np.outer(scale, scale) + _RIDGE * np.eye(scale.size)
    root = np.linalg.cholesky(normal)
    aim = np.linalg.solve(root, weighted @ wanted / scale)
    return np.asarray(scipy.optimize.nnls(root.T, aim, maxiter=_ITERATIONS * scale.size)[0] / scale)


def _held_out(rows: Array, wanted: Array, blocks: NDArray[np.int64]) -> float:
    """RMS of what quarters leave unexplained that had no part in the fit, over that of the force."""
    left = 0.0
    for quarter in range(_QUARTERS):
        outside = (blocks % _QUARTERS != quarter).astype(np.float64)
        missed = wanted - fit(rows, wanted, outside) @ rows
        left += float(np.sum((1.0 - outside) * missed**2))
    return float(np.sqrt(left / np.sum(wanted**2)))
