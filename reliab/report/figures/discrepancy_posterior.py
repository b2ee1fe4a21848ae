"""Posterior of a model's parameters, in pairs."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report.axes import plain
from reliab.report.style import BLUE, INK, PALE, VERMILION, panels, styled

_SIDE, _LARGEST = 40.0, 160.0
_BINS = 30
_LONGEST_LINE = 24
_INTERVAL = (0.05, 0.95)
_SHARES = (0.9, 0.5)  # of the draws inside the contours


@styled
def discrepancy_posterior(
    names: Sequence[str], draws: NDArray[np.float64], *, before: NDArray[np.float64] | None = None
) -> Figure:
    """Draw every parameter and every pair of them.

    Returns densities with 90 % intervals on the diagonal, contours of 50 and 90 % below it.
    """
    count = len(names)
    size = min(_SIDE * count + 20.0, _LARGEST)
    figure, axes = panels(count, count, height=min(size, 0.9 * _LARGEST), width=size)
    believed = np.full(count, np.nan) if before is None else before
    for row in range(count):
        for column in range(count):
            place = axes[row, column]
            if column > row:
                place.set_axis_off()
                continue
            if row == column:
                _alone(place, draws[:, row], believed[row])
            else:
                _pair(place, draws[:, column], draws[:, row])
            _labelled(place, names, row, column)
    return figure


def _alone(place: Axes, values: NDArray[np.float64], believed: float) -> None:
    place.hist(values, bins=_BINS, density=True, histtype="stepfilled", facecolor=PALE, edgecolor=BLUE)
    for end in np.quantile(values, _INTERVAL):
        place.axvline(end, color=INK, linewidth=0.8, linestyle=(0, (4, 2)))
    low, high = place.get_xlim()
    if low <= believed <= high:
        place.axvline(believed, color=VERMILION, linewidth=1.0)
    place.set_yticks([])


def _pair(place: Axes, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    place.plot(x[::4], y[::4], ".", color=BLUE, markersize=1.0, alpha=0.3, rasterized=True)
    counts, across, up = np.histogram2d(x, y, bins=_BINS // 2)
    ordered = np.sort(counts.ravel())[::-1]
    inside = np.cumsum(ordered) / ordered.sum()
    levels = sorted({float(ordered[np.searchsorted(inside, share)]) for share in _SHARES})
    centres = (0.5 * (edges[1:] + edges[:-1]) for edges in (across, up))
    place.contour(*centres, counts.T, levels=levels, colors=INK, linewidths=0.8)


def _labelled(place: Axes, names: Sequence[str], row: int, column: int) -> None:
    last = row == len(names) - 1
    place.tick_params(labelbottom=last, labelleft=column == 0 and row > 0)
    place.locator_params(axis="x", nbins=3)
    place.ticklabel_format(useOffset=False, axis="x")
    if last:
        place.set_xlabel(_wrapped(names[column]))
        place.tick_params(axis="x", rotation=30.0)
    if column == 0 and row > 0:
        place.set_ylabel(_wrapped(names[row]))


def _wrapped(name: str) -> str:
    return "\n".join(plain(part) for part in textwrap.wrap(name, _LONGEST_LINE))
