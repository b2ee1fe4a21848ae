"""One structure and one error: what a criterion allows there, and the tests that it is asked about."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import scipy
import xarray as xr
from numpy.typing import NDArray

from reliab.core.vocabulary import MILLI, CurveName, Side
from reliab.criterion.ellipse_sample import is_ellipse, of_curve


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
        of_side = of_curve(ellipses, CurveName.ELLIPSE, side)
        at = of_side.sel(
            f=self.frequency, xi=self.damping_ratio, threshold=self.threshold, metric=self.metric
        )
        a, b = at["a"].values, at["b"].values
        known = is_ellipse(a, b)
        return np.where(known, a, np.nan), np.where(known, b, np.nan)


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
