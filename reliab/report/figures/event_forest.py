"""Motions by earthquake: how much of the scatter lies between earthquakes (forest plot)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.criterion import EllipseSample
from reliab.criterion.event_components import event_components
from reliab.report.axes import A_PARAMETER, B_PARAMETER, label_logarithmic, legend_below, plain
from reliab.report.style import BLUE, GREY, INK, VERMILION, letters, panels, styled
from reliab.significant import percent

_MARGIN, _ROW = 28.0, 3.7
_TALLEST = 205.0
_NORMAL_95 = 1.96
_LONGEST = 24  # characters of the name of an earthquake


@styled
def event_forest(sample: EllipseSample, *, limits: tuple[float, float]) -> Figure:
    """Draw every motion in the row of its earthquake, with the mean of the earthquake.

    The mean has a 95 % interval from the scatter of motions within earthquakes.
    """
    events = np.unique(sample.events)
    means = [sample.log_a[sample.events == event].mean() for event in events]
    order = events[np.argsort(means)[::-1]]
    figure, axes = panels(1, 2, height=min(_MARGIN + _ROW * order.size, _TALLEST), share_y=True)
    shares = event_components(np.stack([sample.log_a, sample.log_b], axis=1), sample.events)
    titles = tuple(
        f"{name}, {percent(share, decimals=0)} between earthquakes"
        for name, share in zip(("$a$", "$b$"), shares.event_share, strict=True)
    )
    letters(axes, titles)
    spreads = np.sqrt(shares.within)
    for k, (place, values) in enumerate(zip(axes[0], (sample.a, sample.b), strict=True)):
        _draw(place, values, sample.events, order, float(spreads[k]), limits[k])
    axes[0, 0].set_yticks(np.arange(order.size), [plain(str(event), longest=_LONGEST) for event in order])
    axes[0, 0].set_ylim(-0.7, order.size - 0.3)
    axes[0, 0].set_xlabel(A_PARAMETER)
    axes[0, 1].set_xlabel(B_PARAMETER)
    if order.size * _ROW + _MARGIN > _TALLEST:
        axes[0, 0].tick_params(axis="y", labelsize=5.0)
    legend_below(figure, axes[0, 0])
    return figure


def _draw(
    axes: Axes,
    values: NDArray[np.float64],
    events: NDArray[np.str_],
    order: NDArray[np.str_],
    spread: float,
    limit: float,
) -> None:
    rows = np.argmax(events[:, None] == order[None, :], axis=1)
    counts = np.bincount(rows)
    mean = np.bincount(rows, weights=np.log(values)) / counts
    reach = _NORMAL_95 * spread / np.sqrt(counts)
    axes.plot(values, rows, "o", color=GREY, markersize=3.0, fillstyle="none", label="motion")
    low, high = np.exp(mean - reach), np.exp(mean + reach)
    axes.hlines(
        np.arange(order.size), low, high, color=BLUE, linewidth=1.1, label="mean of the earthquake, 95 %"
    )
    axes.plot(np.exp(mean), np.arange(order.size), "s", color=BLUE, markersize=3.4)
    axes.axvline(
        float(np.exp(np.log(values).mean())),
        color=INK,
        linewidth=0.8,
        linestyle=(0, (1, 2)),
        label="all motions",
    )
    if limit > 0.0:
        axes.axvline(limit, color=VERMILION, linewidth=1.2, linestyle=(0, (5, 1.6)), label="criterion")
    axes.set_xscale("log")
    label_logarithmic(axes.xaxis)
