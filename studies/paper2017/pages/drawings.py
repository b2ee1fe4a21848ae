"""Drawings to no scale: the loop as blocks (Figure 1), and the frame with the spring that is tested (16)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch, Rectangle

from reliab.report.style import BLUE, INK, PALE, VERMILION, apply_style, blank

_LINE = 1.0


@apply_style
def block_diagram() -> Figure:
    """Draw the loop: structure without its tested stiffness, actuator, specimen, feedback."""
    figure = blank(height=52.0)
    axes = figure.subplots()
    axes.set(xlim=(0.0, 16.0), ylim=(-0.2, 5.0), aspect="equal")
    axes.set_axis_off()
    axes.add_patch(Circle((2.2, 3.5), 0.28, facecolor="white", edgecolor=INK, linewidth=_LINE))
    axes.text(1.78, 3.72, "+", ha="right", va="bottom")
    axes.text(2.45, 3.05, "−", ha="left", va="top")
    _box(axes, (5.0, 3.5), "numerical substructure\n$m\\ddot{x} + c\\dot{x}$", BLUE)
    _box(axes, (10.8, 3.5), "actuator\n$k_p\\,e^{-\\tau s}$", VERMILION)
    _box(axes, (7.9, 0.8), "experimental substructure\nstiffness $k$", VERMILION)
    _arrow(axes, [(0.3, 3.5), (1.9, 3.5)])
    _arrow(axes, [(2.5, 3.5), (3.2, 3.5)])
    _arrow(axes, [(6.8, 3.5), (9.0, 3.5)])
    _arrow(axes, [(12.6, 3.5), (15.6, 3.5)])
    _arrow(axes, [(13.9, 3.5), (13.9, 0.8), (9.7, 0.8)])
    _arrow(axes, [(6.1, 0.8), (2.2, 0.8), (2.2, 3.2)])
    for x, y, text in (
        (1.0, 3.7, "$-m\\,a_g$"),
        (7.9, 3.7, "command $x_c$"),
        (14.3, 3.7, "measured $x_m$"),
        (4.1, 1.0, "restoring force $r$"),
    ):
        axes.text(x, y, text, ha="center", va="bottom")
    return figure


def _box(axes: Axes, centre: tuple[float, float], text: str, colour: str) -> None:
    x, y = centre
    corner = (x - 1.75, y - 0.65)
    axes.add_patch(
        FancyBboxPatch(
            corner, 3.5, 1.3, boxstyle="round,pad=0.05", facecolor="white", edgecolor=colour, linewidth=1.4
        )
    )
    axes.text(x, y, text, ha="center", va="center")


def _arrow(axes: Axes, points: list[tuple[float, float]]) -> None:
    *start, last = points
    if len(start) > 1:
        axes.plot(*zip(*start, strict=True), color=INK, linewidth=_LINE)
    style = {"arrowstyle": "-|>", "color": INK, "linewidth": _LINE, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", last, start[-1], arrowprops=style)


_COILS = 7


@apply_style
def frame() -> Figure:
    """Draw the frame (numerical substructure) and the spring (experimental substructure)."""
    figure = blank(height=48.0)
    axes = figure.subplots()
    axes.set(xlim=(-1.2, 12.8), ylim=(-1.3, 4.6), aspect="equal")
    axes.set_axis_off()
    _draw_frame(axes)
    _draw_spring(axes)
    _straight_arrow(axes, (3.6, 4.1), (5.4, 4.1), VERMILION)
    axes.text(4.5, 4.2, "$x$", color=VERMILION, ha="center", va="bottom")
    _straight_arrow(axes, (0.2, -0.95), (2.0, -0.95), INK)
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


def _straight_arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.2})
