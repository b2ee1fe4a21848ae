"""One structure and one error: what a criterion is put to the test for."""

from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One structure and one error.

    Parameters
    ----------
    frequency, damping_ratio : float
        The structure [Hz, -].
    threshold : float
        Error on the boundary [-].
    metric : str
        Which error, "rms" or "mte".
    """

    frequency: float
    damping_ratio: float
    threshold: float
    metric: str

    def parameters(
        self, ellipses: xr.Dataset, *, side: int = 1
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Ellipses that were fitted to the boundaries of ground motions.

        Parameters
        ----------
        ellipses : xarray.Dataset
            Over (motion, f, xi, threshold, metric, curve).
        side : {1, -1}, optional
            Whether the ellipses of delays or those of leads.

        Returns
        -------
        a, b : numpy.ndarray
            Parameters [-] and [ms²], shape (motions,); NaN where there is no ellipse.
        """
        at = ellipses.sel(
            f=self.frequency,
            xi=self.damping_ratio,
            threshold=self.threshold,
            metric=self.metric,
            curve="ellipse",
        )
        a, b = at["a"].values, at["b"].values
        known = np.isfinite(a) & np.isfinite(b) & (a > 0.0) & (b > 0.0)
        return np.where(known, a, np.nan), np.where(known, b, np.nan)
