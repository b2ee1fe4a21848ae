"""Limits of a criterion over natural frequency and damping ratio."""

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FormatStrFormatter, NullLocator
from numpy.typing import NDArray

from reliab.report.axes import DAMPING_RATIO, FREQUENCY, name_axes
from reliab.report.style import INK, SEQUENTIAL, letters, panels, styled

_HEIGHT = 58.0
_MOST_LEVELS = 9
_EDGE = 0.06
_PREFERRED = ((1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8), (1, 1.5, 2.5, 4, 6), (1, 2, 5), (1, 3), (1,))
_SHADES = 25
_PALENESS = 0.42
_LEAST_SPACE = 0.085


@styled
def criterion_surfaces(
    frequencies: NDArray[np.float64],
    damping_ratios: NDArray[np.float64],
    amplitude_limit: NDArray[np.float64],
    delay_limit: NDArray[np.float64],
    *,
    simulated: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> Figure:
    """Draw lines of equal limits over the structures, both axes logarithmic.

    `frequencies` (F,) [Hz]; `damping_ratios` (X,) [-]; `amplitude_limit` (F, X) [%]; `delay_limit` (F, X)
    [ms].
    """
    figure, axes = panels(1, 2, height=_HEIGHT, share_y=True)
    letters(axes, (r"amplitude error $\sqrt{a}$ [%]", r"delay $\sqrt{b}$ [ms]"))
    for place, values in zip(axes[0], (amplitude_limit, delay_limit), strict=True):
        _draw(place, frequencies, damping_ratios, values.T)
        _tick(place, simulated)
    name_axes(axes[0, 0], FREQUENCY, DAMPING_RATIO)
    axes[0, 1].set_xlabel(FREQUENCY)
    return figure


def _draw(
    axes: Axes,
    frequencies: NDArray[np.float64],
    damping_ratios: NDArray[np.float64],
    values: NDArray[np.float64],
) -> None:
    positive = np.where(values > 0.0, values, np.nan)
    low, high = float(np.nanmin(positive)), float(np.nanmax(positive))
    axes.set(xscale="log", yscale="log")
    axes.set(xlim=(frequencies[0], frequencies[-1]), ylim=(damping_ratios[0], damping_ratios[-1]))
    shades = np.geomspace(low, high, _SHADES) if high > low else np.array([low, low * 1.01])
    axes.contourf(
        frequencies, damping_ratios, positive, levels=shades, colors=_colours(shades.size - 1), norm=LogNorm()
    )
    levels = _levels(low, high)
    if levels.size:
        lines = axes.contour(frequencies, damping_ratios, positive, levels=levels, colors=INK, linewidths=0.8)
        _label(axes, lines)
    axes.grid(visible=False)


def _tick(axes: Axes, simulated: tuple[NDArray[np.float64], NDArray[np.float64]]) -> None:
    for axis, nodes in zip((axes.xaxis, axes.yaxis), simulated, strict=True):
        axis.set_major_locator(FixedLocator(_spread(nodes)))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FormatStrFormatter("%g"))


def _levels(low: float, high: float) -> NDArray[np.float64]:
    """Preferred numbers between two limits, about evenly spaced on a logarithmic scale."""
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    inside = np.empty(0)
    for steps in _PREFERRED:
        numbers = np.outer(decades, steps).ravel()
        inside = numbers[(numbers > low) & (numbers < high)]
        if inside.size <= _MOST_LEVELS:
            break
    return inside


def _label(axes: Axes, lines: QuadContourSet) -> None:
    """Write the level on each line, except where the frame would cut it."""
    to_axes = axes.transData + axes.transAxes.inverted()
    for text in axes.clabel(lines, inline=False, fontsize=8.0, fmt="%g"):
        x, y = to_axes.transform(text.get_position())
        if min(x, 1.0 - x, y, 1.0 - y) < _EDGE:
            text.remove()
        else:
            text.set_bbox({"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6})


def _colours(count: int) -> list[tuple[float, ...]]:
    """Colours of rising lightness, pale enough for lines and numbers to stand on them."""
    shades = colormaps[SEQUENTIAL](np.linspace(0.0, 1.0, count))
    return [tuple(colour) for colour in (1.0 - _PALENESS * (1.0 - shades)).tolist()]


def _spread(nodes: NDArray[np.float64]) -> list[float]:
    """Nodes whose labels do not touch on a logarithmic axis; the first and the last always."""
    least = _LEAST_SPACE * np.log(nodes[-1] / nodes[0])
    nodes_apart = [float(nodes[0])]
    for node in nodes[1:-1].tolist():
        if np.log(node / nodes_apart[-1]) >= least and np.log(nodes[-1] / node) >= least:
            nodes_apart.append(node)
    return [*nodes_apart, float(nodes[-1])]
