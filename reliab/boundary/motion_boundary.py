"""The boundary of one ground motion, traced straight from the loop."""

import numpy as np
from numpy.typing import NDArray

from reliab.boundary.contour import Contour, trace_contour
from reliab.indices.response_error import relative_error
from reliab.loop.engine import Loop
from reliab.vocabulary import Metric


def motion_contour(loop: Loop, *, threshold: float = 0.05, metric: Metric = Metric.RMS) -> Contour:
    """Contour of equal error of one ground motion, one structure.

    Parameters
    ----------
    loop : Loop
        Structure, record and window.
    threshold : float, optional
        Error on the contour [-], 5 % by default.
    metric : Metric, optional
        RMS^R (default) or MTE^R.

    Returns
    -------
    Contour
        Amplitude [-] and delay [s] along the contour.
    """

    def error(amplitude: NDArray[np.float64], delay: NDArray[np.float64]) -> NDArray[np.float64]:
        return relative_error(loop.deviation(loop.cells(gain=amplitude, delay=delay)), metric)

    return trace_contour(error, threshold, time_scale=1.0 / loop.structure.circular_frequency)
