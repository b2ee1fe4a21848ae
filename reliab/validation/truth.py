"""The true error of a test: from the loop itself, from stored results, or from fitted ellipses.

Criteria are derived from curves fitted to the motions' boundaries. Whether they hold is checked on the error
itself, so that a badly fitting curve is not checked against itself: the loop is solved for the actuator of
each test, or its error is read from the stored grid of simulations where that resolves it. Only where neither
ground motions nor results are at hand, as for a printed table of ellipses, is the error taken from the
ellipses.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from typing import Final

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray

from reliab.core.vocabulary import MILLI, CurveName, Metric, Side
from reliab.criterion.ellipse_table import names_along
from reliab.criterion.population import is_ellipse, select_curve
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.structures.structure import Structure
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.contour import ErrorSurfaces
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One structure and one error."""

    frequency: float  # frequency, damping_ratio: The structure [Hz, -]
    damping_ratio: float
    threshold: float  # Error on the boundary [-]
    metric: str  # Which error, "rms" or "mte"

    def parameters(
        self, ellipses: xr.Dataset, *, side: Side = Side.LAG
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ellipses that were fitted to the boundaries of ground motions.

        Returns `a, b`: parameters [-] and [ms²] of the ellipses of least squares, shape (motions,); NaN where
        there is none.
        """
        side_ellipses = select_curve(ellipses, CurveName.ELLIPSE, side)
        cell_ellipses = side_ellipses.sel(
            f=self.frequency, xi=self.damping_ratio, threshold=self.threshold, metric=self.metric
        )
        a, b = cell_ellipses["a"].values, cell_ellipses["b"].values
        has_ellipse = is_ellipse(a, b)
        return np.where(has_ellipse, a, np.nan), np.where(has_ellipse, b, np.nan)


_EDGE_POINTS = 33


@dataclass(frozen=True, kw_only=True, eq=False)
class Actuators:
    """Amplitudes and delays of tests."""

    gain: NDArray[np.float64]  # Amplitude A [-], shape (tests,)
    delay: NDArray[np.float64]  # Equivalent delay d [s], shape (tests,); leads are negative


@dataclass(frozen=True, kw_only=True)
class Region:
    """Half an ellipse (A − 1)²/a + d²/b ≤ 1."""

    a: float  # a, b: Its parameters [-] and [ms²]; zero where no test but the perfect one is accepted
    b: float
    side: Side = Side.LAG  # Whether it holds for actuators that are late or early

    def accepts(self, tests: Actuators) -> NDArray[np.bool_]:
        """Which tests, all of this side, it accepts; shape (tests,)."""
        if not (self.a > 0.0 and self.b > 0.0):
            return np.zeros(tests.gain.size, dtype=np.bool_)
        index = np.square(tests.gain - 1.0) / self.a + np.square(MILLI * tests.delay) / self.b
        return np.asarray(index <= 1.0)

    def edge(self) -> Actuators:
        """Points on the edge, from the greatest amplitude over the greatest delay to the least amplitude.

        Returns 33 points, so close that the error between two of them exceeds that of both by less than 0.1
        %.
        """
        angle = np.linspace(0.0, np.pi, _EDGE_POINTS)
        delay = self.side.sign * np.sqrt(self.b) * np.sin(angle) / MILLI
        delay[[0, -1]] = 0.0
        return Actuators(gain=1.0 + np.sqrt(self.a) * np.cos(angle), delay=delay)


_SIZE: Final = 2.0


def draw_trials(
    ellipses: xr.Dataset, cell: Cell, count: int, *, side: Side = Side.LAG, seed: int = 0
) -> Actuators:
    """Draw tests for one structure, evenly over an ellipse of twice the typical size.

    The typical size is that of the geometric means of a and b over the motions, so that about a quarter of
    the tests would be good for the typical motion.
    """
    parameters = cell.parameters(ellipses, side=side)
    half_axes = _SIZE * np.exp([0.5 * np.nanmean(np.log(values)) for values in parameters])
    uniform = scipy.stats.qmc.Sobol(2, rng=seed).random_base2(max(count - 1, 0).bit_length())[:count]
    radius, angle = np.sqrt(uniform[:, 0]), np.pi * uniform[:, 1]
    return Actuators(
        gain=1.0 + half_axes[0] * radius * np.cos(angle),
        delay=side.sign * half_axes[1] * radius * np.sin(angle) / MILLI,
    )


class Truth(ABC):
    """Errors of tests under the ground motions on trial."""

    name: str  # Source of the errors: "simulated" or "ellipse"

    @abstractmethod
    def errors(
        self, cell: Cell, motion: int, gain: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Errors of tests under one ground motion, relative to the threshold.

        `gain` [-]; `delay` [s]; returns [-].
        Returns error over threshold [-], shape (tests,); above 1 a test is bad, NaN where it is not known.
        """


@dataclass(frozen=True, kw_only=True, eq=False)
class SimulatedTruth(Truth):
    """Errors from the loop, solved for each test.

    >>> record = np.sin(2 * np.pi * np.arange(0, 20, 0.01))
    >>> truth = SimulatedTruth(motions=[Motion(name="sine", acceleration=record, time_step=0.01)])
    >>> cell = Cell(frequency=1.0, damping_ratio=0.05, threshold=0.05, metric="rms")
    >>> truth.errors(cell, 0, np.array([1.0, 1.0]), np.array([0.0, 0.002])).round(2)
    array([0. , 1.5])
    """

    name = "simulated"

    motions: Sequence[Motion]  # The ground motions on trial, in their order
    window: Window = field(default_factory=Window)  # Part of the record over which errors are computed
    experimental_fraction: float = 1.0  # Share of the stiffness in the laboratory [-]

    def errors(
        self, cell: Cell, motion: int, gain: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Solve the loop for each test."""
        loop = Loop(
            excitation=excitation_of(self.motions[motion], self.window),
            structure=Structure(
                frequency=cell.frequency,
                damping_ratio=cell.damping_ratio,
                experimental_fraction=self.experimental_fraction,
            ),
        )
        deviation = loop.deviation(loop.cells(gain=gain, delay=delay))
        return np.asarray(relative_error(deviation, Metric(cell.metric)) / cell.threshold)


class StoredTruth(Truth):
    """Errors read between the cells of stored results."""

    name = "simulated"

    def __init__(self, results: xr.Dataset) -> None:
        self._surfaces = lru_cache(maxsize=1)(partial(_surfaces, results))

    def errors(
        self, cell: Cell, motion: int, gain: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Interpolate the stored errors; NaN outside of the stored grid."""
        surfaces = self._surfaces(cell.frequency, cell.damping_ratio, cell.metric)
        motion_indices = np.full(gain.size, motion, dtype=np.int64)
        return np.asarray(surfaces.error(gain, delay, motion_indices) / cell.threshold)


class EllipseTruth(Truth):
    """Errors from fitted ellipses, for use where nothing was simulated.

    The error over the threshold is taken for √((A−1)²/a + d²/b), which is 1 on the ellipse.
    """

    name = "ellipse"

    def __init__(self, ellipses: xr.Dataset) -> None:
        self._ellipses = ellipses

    def errors(
        self, cell: Cell, motion: int, gain: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Take the index of the motion's own ellipse; NaN where it has none."""
        index = np.full(gain.size, np.nan)
        for side in (Side(name) for name in names_along(self._ellipses, "side")):
            a, b = (float(values[motion]) for values in cell.parameters(self._ellipses, side=side))
            is_on_side = side.sign * delay >= 0.0
            index[is_on_side] = np.square(gain[is_on_side] - 1.0) / a
            index[is_on_side] += np.square(MILLI * delay[is_on_side]) / b
        return np.asarray(np.sqrt(index))


def _surfaces(results: xr.Dataset, f: float, xi: float, metric: str) -> ErrorSurfaces:
    errors = results.reliab.select_structure(f, xi)[metric].transpose("motion", "kp", "tau")
    return ErrorSurfaces(errors["kp"].values, errors["tau"].values, errors.values)
