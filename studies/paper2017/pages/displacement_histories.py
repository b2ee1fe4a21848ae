"""Displacement histories: exact response and measured displacement.

Figures 2, 3, 5 and 7 of Guo and others (2017): the exact response, and the measured displacement at a
delay of 5 ms, at an amplitude of 0.99, and at both errors. Figure 17: the four cases of the application.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.core.vocabulary import MILLI, PERCENT
from reliab.report.document import Figure as RpFigure
from reliab.report.prose import Prose
from reliab.report.style import (
    BLUE,
    DISPLACEMENT,
    INK,
    PALE,
    TIME,
    VERMILION,
    apply_style,
    legend_below,
    letters,
    mark,
    panels as rp_panels,
    plain,
)

_PANEL_HEIGHT, _MARGIN = 32.0, 16.0
_HEADROOM = 1.45
_MOST_POINTS = 1000
_LEVELS = 100.0


@dataclass(frozen=True, kw_only=True, eq=False)
class HistoryPanel:
    """What one panel shows.

    `times`: times [s], shape (n,); `ideal`: exact response x_I [m], shape (n,); `measured`: measured
    displacement x_m [m]; without it only the exact response is drawn, shape (n,).
    """

    title: str
    times: NDArray[np.float64]
    ideal: NDArray[np.float64]
    measured: NDArray[np.float64] | None = None
    note: str = ""


@apply_style
def displacement_histories(histories: Sequence[HistoryPanel], *, columns: int = 1) -> Figure:
    """Draw exact response and measured displacement of several tests on one scale of time.

    Displacement [mm] over time [s].
    """
    rows = -(-len(histories) // columns)
    figure, axes = rp_panels(rows, columns, height=_MARGIN + _PANEL_HEIGHT * rows, share_x=True)
    letters(axes, tuple(plain(panel.title) for panel in histories))
    for place, history in zip(axes.ravel(), histories, strict=False):
        _draw(place, history)
    for place in axes.ravel()[len(histories) :]:
        place.set_axis_off()
    for place in axes[-1]:
        place.set_xlabel(TIME)
    richest = next((k for k, panel in enumerate(histories) if panel.measured is not None), 0)
    legend_below(figure, axes.ravel()[richest])
    return figure


def as_printed(history: HistoryPanel) -> HistoryPanel:
    """Keep what a print can show: fewer points, displacements rounded to a third of a line's width.

    Nothing is lost to the eye, and the ground motion cannot be found again by differentiating what is drawn.
    """
    times = np.linspace(history.times[0], history.times[-1], min(_MOST_POINTS, history.times.size))
    step = float(np.abs(history.ideal).max()) / _LEVELS

    def thinned(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(step * np.round(np.interp(times, history.times, values) / step))

    measured = None if history.measured is None else thinned(history.measured)
    return replace(history, times=times, ideal=thinned(history.ideal), measured=measured)


def _draw(axes: Axes, history: HistoryPanel) -> None:
    history = as_printed(history)
    curves = [history.ideal] if history.measured is None else [history.ideal, history.measured]
    # The exact response lies underneath, broad and pale, so that both remain visible where they agree.
    colour, width = (INK, 0.8) if history.measured is None else (PALE, 2.6)
    axes.plot(
        history.times, MILLI * history.ideal, color=colour, linewidth=width, label="exact response $x_I$"
    )
    if history.measured is not None:
        axes.plot(
            history.times,
            MILLI * history.measured,
            color=BLUE,
            linewidth=0.7,
            label="measured displacement $x_m$",
        )
        axes.plot(
            history.times,
            MILLI * (history.measured - history.ideal),
            color=VERMILION,
            linewidth=0.7,
            linestyle=(0, (2.0, 1.0)),
            label="difference $x_m - x_I$",
        )
    peak = MILLI * max(float(np.abs(values).max()) for values in curves)
    axes.set_ylim(-_HEADROOM * peak, _HEADROOM * peak)
    axes.set_xlim(history.times[0], history.times[-1])
    axes.set_ylabel(DISPLACEMENT)
    if history.note:
        mark(axes, plain(history.note), (0.985, 0.95), ha="right")


def case_histories(cases: xr.Dataset, *, caption: Prose, label: str, errors: bool = False) -> RpFigure:
    """Draw the exact response and the measured displacement of each case."""
    panels = [
        HistoryPanel(
            title=f"case {number}",
            times=cases["time"].values,
            ideal=cases["ideal"].sel(case=number).values,
            measured=cases["measured"].sel(case=number).values,
            note=f"RMS error {PERCENT * float(cases['rms'].sel(case=number)):.2f} %" if errors else "",
        )
        for number in cases["case"].values.tolist()
    ]
    return RpFigure(drawing=displacement_histories(panels), caption=caption, label=label)
