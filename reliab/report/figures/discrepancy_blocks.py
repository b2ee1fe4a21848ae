"""The loop, with the blocks in which the model lacks an effect."""

from collections.abc import Collection, Mapping
from typing import Any, Final

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from reliab.report.axes import plain
from reliab.report.style import BLUE, GREY, INK, VERMILION, blank, styled
from reliab.vocabulary import Block

_HEIGHT: Final = 62.0
_LINE: Final = 1.0
_HALF: Final = (1.7, 0.75)
_PLACES: Final = {
    Block.EXCITATION: (1.9, 4.2),
    Block.NUMERICAL: (6.7, 4.2),
    Block.ACTUATOR: (11.5, 4.2),
    Block.SENSOR: (14.2, 1.6),
    Block.SPECIMEN: (8.2, 1.6),
}
_NAMES: Final = {
    Block.EXCITATION: "excitation",
    Block.NUMERICAL: "numerical substructure",
    Block.ACTUATOR: "actuator",
    Block.SENSOR: "sensors",
    Block.SPECIMEN: "specimen",
}
_LOOKS: Final[dict[str, dict[str, Any]]] = {
    "lacking": {"facecolor": "#f7d9c6", "edgecolor": VERMILION, "linewidth": 2.4},
    "sound": {"facecolor": "white", "edgecolor": BLUE, "linewidth": 1.2},
    "unseen": {"facecolor": "white", "edgecolor": GREY, "linewidth": 1.0, "linestyle": (0, (3, 2))},
}


@styled
def discrepancy_blocks(*, lacking: Mapping[Block, str], observed: Collection[Block]) -> Figure:
    """Draw the loop and colour what is missing in which block.

    Returns blocks that lack an effect are filled, others framed, those that no channel shows dashed.
    """
    figure = blank(height=_HEIGHT)
    axes = figure.subplots()
    axes.set(xlim=(0.0, 16.2), ylim=(-0.4, 5.4), aspect="equal")
    axes.set_axis_off()
    _wires(axes)
    for block, place in _PLACES.items():
        kind = "lacking" if block in lacking else "sound" if block in observed else "unseen"
        _box(axes, place, _NAMES[block], lacking.get(block, ""), _LOOKS[kind])
    for k, (kind, text) in enumerate(
        (
            ("lacking", "something is missing"),
            ("sound", "observed, nothing missing"),
            ("unseen", "not observed"),
        )
    ):
        x = 0.4 + 5.3 * k
        axes.add_patch(FancyBboxPatch((x, -0.2), 0.5, 0.3, boxstyle="round,pad=0.03", **_LOOKS[kind]))
        axes.text(x + 0.75, -0.05, text, ha="left", va="center", fontsize=8.0)
    return figure


def _box(axes: Axes, centre: tuple[float, float], name: str, missing: str, look: dict[str, Any]) -> None:
    (x, y), (across, up) = centre, _HALF
    corner = (x - across, y - up)
    axes.add_patch(
        FancyBboxPatch(corner, 2.0 * across, 2.0 * up, boxstyle="round,pad=0.05", zorder=2.0, **look)
    )
    note: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 3.0}
    axes.text(x, y + (0.34 if missing else 0.0), name, **note)
    if missing:
        axes.text(x, y - 0.32, plain(missing), color=VERMILION, fontsize=8.0, fontweight="bold", **note)


def _wires(axes: Axes) -> None:
    _arrow(axes, [(3.7, 4.2), (4.9, 4.2)])
    _arrow(axes, [(8.5, 4.2), (9.7, 4.2)])
    _arrow(axes, [(13.3, 4.2), (14.2, 4.2), (14.2, 2.45)])
    _arrow(axes, [(13.7, 4.2), (13.7, 3.1), (10.9, 3.1), (10.9, 1.6), (10.0, 1.6)])
    _arrow(axes, [(6.4, 1.6), (4.4, 1.6), (4.4, 4.2), (4.9, 4.2)])
    for x, y, text, side in (
        (4.2, 4.4, "$a_g$", "center"),
        (9.1, 4.4, "$x_c$", "center"),
        (13.75, 4.4, "$x$", "center"),
        (5.3, 1.8, "$r$", "center"),
    ):
        axes.text(x, y, text, ha=side, va="bottom")


def _arrow(axes: Axes, points: list[tuple[float, float]]) -> None:
    *start, last = points
    axes.plot(*zip(*start, strict=True), color=INK, linewidth=_LINE, zorder=1.0)
    look = {"arrowstyle": "-|>", "color": INK, "linewidth": _LINE, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", last, start[-1], arrowprops=look, zorder=1.0)
