"""Three curves fitted to the contour of 5 % RMS^R (Figure 10)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from reliab.boundary import Contour, Curve
from reliab.report import AMPLITUDE, DELAY, INK, line, name_axes, panels, styled
from reliab.significant import significant
from reliab.vocabulary import MILLI

_HEIGHT = 68.0
_POINTS = 201


@styled
def curve_fits(contour: Contour, curves: Sequence[Curve]) -> Figure:
    """Draw a contour of equal error with the curves fitted to it.

    `contour`: amplitude [-] and delay [s] along the contour. Result: delay [ms] over amplitude [-]; the
    legend gives each fitting error [ms⁴].
    """
    figure, axes = panels(height=_HEIGHT, width=120.0)
    place = axes[0, 0]
    margin = 0.1 * np.ptp(contour.amplitude)
    amplitude = np.linspace(contour.amplitude[0] - margin, contour.amplitude[-1] + margin, _POINTS)
    for rank, curve in enumerate(curves):
        name = f"{curve.name}, misfit {significant(curve.sse, 2)} ms⁴"
        place.plot(amplitude, MILLI * curve.delay(amplitude), label=name, **line(rank))
    place.plot(
        contour.amplitude,
        MILLI * contour.delay,
        "o",
        color=INK,
        markersize=3.0,
        fillstyle="none",
        label="contour",
    )
    place.set_ylim(0.0, 1.35 * MILLI * contour.delay.max())
    place.legend(loc="upper center", ncols=2)
    name_axes(place, AMPLITUDE, DELAY)
    return figure
