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

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.core.vocabulary import MILLI, Metric, Side
from reliab.criterion.ellipse_table import names_along
from reliab.motions.motion import Motion
from reliab.simulation.engine import Loop
from reliab.structures.structure import Structure
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.contour import ErrorSurfaces
from reliab.tracking.indices.response_error import relative_error
from reliab.tracking.indices.window import Window
from reliab.validation.cross_validation.cell import Cell


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
        which = np.full(gain.size, motion, dtype=np.int64)
        return np.asarray(surfaces.error(gain, delay, which) / cell.threshold)


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
            of_side = side.sign * delay >= 0.0
            index[of_side] = np.square(gain[of_side] - 1.0) / a
            index[of_side] += np.square(MILLI * delay[of_side]) / b
        return np.asarray(np.sqrt(index))


def _surfaces(results: xr.Dataset, f: float, xi: float, metric: str) -> ErrorSurfaces:
    errors = results.reliab.at_structure(f, xi)[metric].transpose("motion", "kp", "tau")
    return ErrorSurfaces(errors["kp"].values, errors["tau"].values, errors.values)
