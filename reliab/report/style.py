"""One style for all figures.

Colours are Okabe and Ito's, which people with any colour vision tell apart; lines also differ in dash
and marker, so that grey print stays readable. Figures are drawn for a column of 160 mm at the size in
which they are printed, as SVG whose bytes depend on nothing but what is drawn: text is drawn as paths
in fonts that come with matplotlib, identifiers are salted, no date is written.
"""

import functools
import io
import warnings
from collections.abc import Callable
from textwrap import fill
from typing import Any, Final, ParamSpec

import matplotlib as mpl
import numpy as np
import seaborn as sns
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.core.errors import InputError

COLUMN_WIDTH: Final = 160.0
"""Width of the text column of a report [mm]."""

INK: Final = "#202020"
GREY: Final = "#8a8a8a"
PALE: Final = "#c9c9c9"
BLUE, ORANGE, GREEN, VERMILION, PURPLE, BROWN = sns.color_palette("colorblind", 6).as_hex()

OLIVE: Final = "#7a7a00"

SEQUENTIAL: Final = "cividis"
"""Colour map that rises evenly in lightness, also for colour-blind readers and in grey print."""

_MILLIMETRES_PER_INCH: Final = 25.4
_NOTE_HEIGHT, _NOTE_LINE = 20.0, 90  # [mm], [characters]
_DASHES: Final[tuple[Any, ...]] = ("-", (0, (5, 1.6)), (0, (1.2, 1.2)), (0, (6, 1.4, 1.2, 1.4)), (0, (9, 3)))
_MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X", "p")
_COLOURS: Final = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, BROWN, INK, OLIVE)

RC: Final[dict[Any, Any]] = {
    "font.family": ["STIXGeneral", "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "axes.linewidth": 0.6,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.unicode_minus": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.6,
    "patch.linewidth": 0.6,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "legend.frameon": True,
    "legend.framealpha": 0.8,
    "legend.edgecolor": "none",
    "legend.fancybox": False,
    "legend.handlelength": 2.6,
    "figure.dpi": 100.0,
    "savefig.dpi": 300.0,
    "svg.fonttype": "path",
    "svg.hashsalt": "reliab",
    "path.simplify": True,
    "agg.path.chunksize": 20000,
}
"""What differs from matplotlib's defaults."""

_METADATA: Final[dict[str, dict[str, Any]]] = {
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None},
    ".png": {},
}
"""By the ending of a picture's file, what matplotlib must leave out for equal bytes."""

_Arguments = ParamSpec("_Arguments")


def apply_style(draw: Callable[_Arguments, Figure]) -> Callable[_Arguments, Figure]:
    """Draw a figure in the style of the reports, whatever style the caller uses.

    A figure that cannot be drawn must not cost the results that it shows: a note stands in its place,
    and a :class:`FigureWarning` says why.
    """

    @functools.wraps(draw)
    def in_style(*args: _Arguments.args, **kwargs: _Arguments.kwargs) -> Figure:
        with mpl.rc_context({**mpl.rcParamsDefault, **RC}):
            try:
                return draw(*args, **kwargs)
            except (InputError, Warning):
                raise
            except Exception as error:  # noqa: BLE001 - whatever fails, the rest of the report stands
                reason = f"{type(error).__name__}: {error}"
                name = getattr(draw, "__name__", "figure").replace("_", " ")
                warnings.warn(
                    f"The figure “{name}” could not be drawn ({reason})", FigureWarning, stacklevel=2
                )
                return _note(f"This figure could not be drawn ({reason}).")

    return in_style


class FigureWarning(UserWarning):
    """A figure could not be drawn; everything else is there."""


def _note(text: str) -> Figure:
    """Make a figure that holds a sentence only."""
    figure = Figure(figsize=(COLUMN_WIDTH / _MILLIMETRES_PER_INCH, _NOTE_HEIGHT / _MILLIMETRES_PER_INCH))
    figure.text(0.5, 0.5, fill(text, _NOTE_LINE), ha="center", va="center", color=VERMILION)
    return figure


def panels(
    rows: int = 1,
    columns: int = 1,
    *,
    height: float = 70.0,
    width: float = COLUMN_WIDTH,
    share_x: bool = False,
    share_y: bool = False,
    ratios: tuple[float, ...] | None = None,
    heights: tuple[float, ...] | None = None,
) -> tuple[Figure, NDArray[np.object_]]:
    """Make a figure with a grid of axes.

    `height`, `width`: size of the figure in print [mm].
    """
    figure = blank(height=height, width=width)
    axes = figure.subplots(
        rows,
        columns,
        squeeze=False,
        sharex=share_x,
        sharey=share_y,
        width_ratios=ratios,
        height_ratios=heights,
    )
    return figure, axes


def blank(*, height: float, width: float = COLUMN_WIDTH) -> Figure:
    """Make an empty figure of a size in print [mm]."""
    size = (width / _MILLIMETRES_PER_INCH, height / _MILLIMETRES_PER_INCH)
    return Figure(figsize=size, layout="constrained")


def line(rank: int, *, marker: bool = False) -> dict[str, Any]:
    """Colour, dash and marker of the line of a rank, told apart in grey print too."""
    look = {"color": _COLOURS[rank % len(_COLOURS)], "linestyle": _DASHES[rank % len(_DASHES)]}
    return {**look, "marker": _MARKERS[rank % len(_MARKERS)]} if marker else look


def svg(figure: Figure) -> bytes:
    """Draw a figure as SVG with reproducible bytes, as :func:`picture` does."""
    return picture(figure, ".svg")


def picture(figure: Figure, ending: str) -> bytes:
    """Draw a figure with bytes that depend on nothing but what is drawn.

    `ending`: ending of its file: ".svg", ".pdf" or ".png".
    """
    if ending not in _METADATA:
        message = f"no picture ends in {ending!r}"
        raise ValueError(message)
    target = io.BytesIO()
    with mpl.rc_context({**mpl.rcParamsDefault, **RC}):
        figure.savefig(target, format=ending.removeprefix("."), metadata=_METADATA[ending])
    return target.getvalue()


def letters(axes: NDArray[np.object_], titles: tuple[str, ...] = ()) -> None:
    """Letter axes (a), (b), … with an optional title each, row by row."""
    for rank, place in enumerate(axes.ravel()):
        title = f" {titles[rank]}" if rank < len(titles) else ""
        place.set_title(f"({chr(ord('a') + rank)}){title}", loc="left")
