"""The boundary of one ground motion, traced straight from the loop."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import Contour, trace_contours
from reliab.indices.response_error import relative_error
from reliab.loop.engine import Loop
from reliab.vocabulary import Metric


def motion_contours(
    loop: Loop, thresholds: Sequence[float] = (0.05,), metric: Metric = Metric.RMS
) -> list[Contour]:
    """Contours of equal error of one ground motion and one structure.

    Parameters
    ----------
    loop : Loop
        Structure, record and window.
    thresholds : sequence of float, optional
        Errors on the contours [-], 5 % by default.
    metric : Metric, optional
        RMS^R (default) or MTE^R.

    Returns
    -------
    list of Contour
        Amplitude [-] and delay [s] along the contour of each threshold.
    """

    def error(
        amplitude: NDArray[np.float64], delay: NDArray[np.float64], _: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        return relative_error(loop.deviation(loop.cells(gain=amplitude, delay=delay)), metric)

    return trace_contours(error, np.asarray(thresholds, dtype=np.float64), loop.structure)
