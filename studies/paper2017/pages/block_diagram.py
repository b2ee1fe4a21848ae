"""The loop of a real-time hybrid simulation as a block diagram (Figure 1)."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyBboxPatch

from reliab.report import BLUE, INK, VERMILION, blank, styled

_HEIGHT = 52.0
_LINE = 1.0


@styled
def block_diagram() -> Figure:
    """Draw the loop: structure without its tested stiffness, actuator, specimen, feedback."""
    figure = blank(height=_HEIGHT)
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
