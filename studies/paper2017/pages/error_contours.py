"""Contours of equal error in the plane of amplitude and delay (Figure 9)."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.boundary import Contour
from reliab.report import AMPLITUDE, DELAY, ERRORS, letters, line, mark, name_axes, panels, styled
from reliab.vocabulary import MILLI, PERCENT, Metric

_HEIGHT = 62.0
_HEADROOM = 1.18


@styled
def error_contours(contours: Mapping[Metric, Mapping[float, Contour]]) -> Figure:
    """Draw contours of equal error, MTE^R and RMS^R side by side on the same scales.

    `contours`: contours by error and by threshold [-]. Result: delay [ms] over amplitude [-]; inside a
    contour the error is smaller.
    """
    figure, axes = panels(1, len(contours), height=_HEIGHT, share_x=True, share_y=True)
    letters(axes, tuple(ERRORS[metric] for metric in contours))
    for place, by_threshold in zip(axes[0], contours.values(), strict=True):
        for rank, (threshold, contour) in enumerate(by_threshold.items()):
            _draw(place, contour, f"{PERCENT * threshold:g} %", rank)
        name_axes(place, AMPLITUDE, DELAY)
        place.legend(loc="upper right", title="error of the test")
    drawn = [contour for of_metric in contours.values() for contour in of_metric.values()]
    axes[0, 0].set_ylim(0.0, _HEADROOM * MILLI * max(float(contour.delay.max()) for contour in drawn))
    mark(axes[0, 0], "inside: smaller error", (0.5, 0.12), ha="center")
    return figure


def _draw(axes: Axes, contour: Contour, name: str, rank: int) -> None:
    step = max(1, contour.amplitude.size // 16)
    axes.plot(
        contour.amplitude,
        MILLI * np.asarray(contour.delay),
        label=name,
        markevery=step,
        **line(rank, marker=True),
    )
