"""The paper's frame with a spring: what is simulated and what is tested (Figure 16)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from reliab.report import BLUE, INK, PALE, VERMILION, blank, styled

_HEIGHT = 48.0
_COILS = 7


@styled
def frame() -> Figure:
    """Draw the frame (numerical substructure) and the spring (experimental substructure)."""
    figure = blank(height=_HEIGHT)
    axes = figure.subplots()
    axes.set(xlim=(-1.2, 12.8), ylim=(-1.3, 4.6), aspect="equal")
    axes.set_axis_off()
    _draw_frame(axes)
    _draw_spring(axes)
    _arrow(axes, (3.6, 4.1), (5.4, 4.1), VERMILION)
    axes.text(4.5, 4.2, "$x$", color=VERMILION, ha="center", va="bottom")
    _arrow(axes, (0.2, -0.95), (2.0, -0.95), INK)
    axes.text(2.15, -0.95, "ground acceleration $a_g$", va="center")
    return figure


def _draw_frame(axes: Axes) -> None:
    look = {"color": BLUE, "linewidth": 2.4, "solid_capstyle": "butt"}
    for x in (0.5, 4.5):
        axes.plot([x, x], [0.0, 3.0], **look)
        _support(axes, x)
    axes.add_patch(Rectangle((0.2, 3.0), 4.6, 0.55, facecolor=PALE, edgecolor=BLUE, linewidth=1.4))
    axes.text(2.5, 3.27, "mass $m$", ha="center", va="center")
    axes.text(
        2.5, 1.55, "numerical substructure:\nframe of stiffness $k_n$", ha="center", va="center", color=BLUE
    )


def _draw_spring(axes: Axes) -> None:
    x = np.linspace(5.6, 8.6, 4 * _COILS + 1)
    y = 3.27 + 0.28 * np.sin(np.linspace(0.0, 2.0 * np.pi * _COILS, x.size))
    axes.plot([4.8, 5.6], [3.27, 3.27], color=VERMILION, linewidth=1.6)
    axes.plot(x, y, color=VERMILION, linewidth=1.6)
    axes.plot([8.6, 9.4], [3.27, 3.27], color=VERMILION, linewidth=1.6)
    axes.plot([9.4, 9.4], [2.5, 4.05], color=INK, linewidth=1.4)
    for y0 in np.linspace(2.5, 3.9, 6):
        axes.plot([9.4, 9.7], [y0, y0 + 0.25], color=INK, linewidth=0.7)
    axes.text(
        7.2,
        2.0,
        "experimental substructure:\nspring of stiffness $k_e$",
        ha="center",
        va="center",
        color=VERMILION,
    )


def _support(axes: Axes, x: float) -> None:
    axes.plot([x - 0.55, x + 0.55], [0.0, 0.0], color=INK, linewidth=1.4)
    for x0 in np.linspace(x - 0.5, x + 0.35, 5):
        axes.plot([x0, x0 - 0.2], [0.0, -0.3], color=INK, linewidth=0.7)


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.2})
