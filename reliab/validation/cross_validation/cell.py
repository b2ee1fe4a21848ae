"""One structure and one error, for which a criterion is tested."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.criterion import is_ellipse, of_curve
from reliab.vocabulary import CurveName, Side


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
