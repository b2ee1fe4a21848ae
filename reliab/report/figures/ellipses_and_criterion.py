"""The ellipses of all ground motions with that of the criterion (Figure 13)."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from reliab.criterion import EllipseSample
from reliab.report.axes import AMPLITUDE, DELAY, ellipse_line, legend_below, name_axes
from reliab.report.style import GREY, line, panels, styled

_HEIGHT = 84.0
_WIDEST = 0.98


@styled
def ellipses_and_criterion(sample: EllipseSample, criteria: Mapping[str, tuple[float, float]]) -> Figure:
    """Draw the boundary of every motion and the criteria that should lie inside of nearly all.

    Returns delay [ms] over amplitude [-]; early and late actuators mirror each other, so that one half is
    drawn.
    """
    figure, axes = panels(height=_HEIGHT)
    place = axes[0, 0]
    amplitude, delay = ellipse_line(sample.a, sample.b)
    thin = place.plot(amplitude, delay, color=GREY, linewidth=0.5, alpha=0.6)
    thin[0].set_label(f"{sample.n_motions} motions of {sample.n_events} earthquakes")
    for rank, (name, limits) in enumerate(criteria.items()):
        place.plot(*ellipse_line(*limits), label=name, **{**line(rank), "linewidth": 2.0})
    a, b = (float(np.quantile(values, _WIDEST)) for values in (sample.a, sample.b))
    place.set_xlim(1.0 - np.sqrt(a), 1.0 + np.sqrt(a))
    place.set_ylim(0.0, 1.05 * np.sqrt(b))
    name_axes(place, AMPLITUDE, DELAY)
    legend_below(figure, place)
    return figure
