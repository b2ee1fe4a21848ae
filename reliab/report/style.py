"""One style for all figures: colours, and what axes are called with their units.

Colours are Okabe and Ito's, which people with any colour vision tell apart; lines also differ in dash
and marker, so that grey print stays readable. Figures are drawn for a column of 160 mm at the size in
which they are printed, as SVG whose bytes depend on nothing but what is drawn: text is drawn as paths
in fonts that come with matplotlib, identifiers are salted, no date is written.
"""

import functools
import io
import warnings
from collections.abc import Callable
from functools import cache
from textwrap import fill
from typing import Any, Final, ParamSpec

import matplotlib as mpl
import numpy as np
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font
from matplotlib.ft2font import FT2Font
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter
from numpy.typing import ArrayLike, NDArray

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import Metric

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


_STEPS = ((1, 2, 3, 4, 5, 6, 7, 8, 9), (1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,))
_LEAST_PLAIN, _GREATEST_PLAIN = 1e-2, 1e4


AMPLITUDE: Final = "Amplitude $A$ [-]"
DELAY: Final = "Equivalent delay $d$ [ms]"
A_PARAMETER: Final = "Ellipse parameter $a$ [-]"
B_PARAMETER: Final = "Ellipse parameter $b$ [ms²]"
AMPLITUDE_LIMIT: Final = r"Amplitude error $\sqrt{a}$ [-]"
DELAY_LIMIT: Final = r"Delay $\sqrt{b}$ [ms]"
FREQUENCY: Final = "Natural frequency $f$ [Hz]"
DAMPING_RATIO: Final = r"Damping ratio $\xi$ [-]"
TIME: Final = "Time $t$ [s]"
DISPLACEMENT: Final = "Displacement [mm]"
DENSITY_A: Final = "Probability density of $a$ [-]"
DENSITY_B: Final = "Probability density of $b$ [1/ms²]"
SHARE: Final = "Share of motions [-]"

ERRORS: Final = {Metric.RMS: "$RMS^R$", Metric.MTE: "$MTE^R$"}
"""How the errors of the whole test are written."""


def plain(text: str, *, longest: int = 60) -> str:
    r"""Text of a user, so that no character of it is taken for mathematics, drawn as a box or out of place.

    `longest`: number of characters after which it is cut. Returns the text for a label; characters that the
    fonts lack stand as their numbers.

    >>> print(plain("A$b 地"))
    A\$b \u5730
    >>> print(plain("A name that is long", longest=6))
    A nam…
    """
    drawable = "".join(_substitute_glyph(character) for character in " ".join(text.split()))
    short = drawable if len(drawable) <= longest else f"{drawable[: longest - 1]}…"
    return short.replace("$", r"\$")


def _substitute_glyph(character: str) -> str:
    if character.isprintable() and any(font.get_char_index(ord(character)) for font in _fonts()):
        return character
    return character.encode("unicode_escape").decode()


@cache
def _fonts() -> tuple[FT2Font, ...]:
    """Fonts of the figures, the first of which with a character draws it."""
    return tuple(get_font(findfont(name)) for name in RC["font.family"])


def name_axes(axes: Axes, x: str, y: str) -> None:
    """Name both axes; each name ends with its unit in brackets."""
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def legend_below(figure: Figure, *axes: Axes, columns: int = 4) -> None:
    """Put one legend for all axes below them, where it can cover nothing; each name stands once."""
    entries = [entry for place in axes for entry in zip(*place.get_legend_handles_labels(), strict=True)]
    handles_by_name = {name: handle for handle, name in reversed(entries)}
    names = list(dict.fromkeys(name for _, name in entries))
    handles = [handles_by_name[name] for name in names]
    figure.legend(handles, names, loc="outside lower center", ncols=min(columns, len(names)))


def ellipse_line(a: ArrayLike, b: ArrayLike, *, points: int = 121) -> tuple[NDArray[np.float64], ...]:
    """Upper halves of ellipses (A − 1)²/a + d²/b = 1."""
    angle = np.linspace(0.0, np.pi, points).reshape(-1, *(1,) * np.ndim(a))
    return 1.0 + np.sqrt(a) * np.cos(angle), np.sqrt(b) * np.sin(angle)


def scientific(value: float) -> str:
    r"""Write a number for a label, with a power of ten where it is very small or large.

    >>> scientific(5.29e-5), scientific(1.048), scientific(0.977)
    ('$5.29\\times10^{-5}$', '1.05', '0.977')
    """
    text = significant(value, 3)
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    return rf"${mantissa}\times10^{{{int(exponent)}}}$"


def label_logarithmic(*axes: Axis, largest_count: int = 5) -> None:
    """Label a logarithmic axis with a few round numbers."""
    for axis in axes:
        low, high = axis.get_view_interval()
        axis.set_major_locator(FixedLocator(round_numbers(low, high, largest_count).tolist()))
        axis.set_major_formatter(FuncFormatter(_write_tick))
        axis.set_minor_formatter(NullFormatter())


def round_numbers(low: float, high: float, largest_count: int) -> NDArray[np.float64]:
    """Round numbers that lie about evenly on a logarithmic scale.

    >>> round_numbers(0.8, 40.0, 6).tolist(), round_numbers(2.9e-5, 7.1e-5, 5).round(6).tolist()
    ([1.0, 2.0, 5.0, 10.0, 20.0], [3e-05, 4e-05, 5e-05, 6e-05, 7e-05])
    """
    decades = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    ticks = np.empty(0)
    for steps in _STEPS:
        candidates = (10.0 ** decades[:, None] * np.asarray(steps)).ravel()
        ticks = candidates[(candidates >= low) & (candidates <= high)]
        if ticks.size <= largest_count:
            break
    return np.asarray(ticks[:: -(-ticks.size // largest_count) if ticks.size else 1])


def _write_tick(value: float, _: int | None = None) -> str:
    if _LEAST_PLAIN <= value < _GREATEST_PLAIN:
        return f"{value:g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    factor = "" if mantissa == "1" else rf"{mantissa}\times"
    return rf"${factor}10^{{{int(exponent)}}}$"


def mark(axes: Axes, text: str, position: tuple[float, float], **look: Any) -> None:  # noqa: ANN401 - matplotlib's
    """Write a short note at a place inside the axes, in shares of their width and height."""
    axes.text(*position, text, transform=axes.transAxes, **{"fontsize": 8.0, "va": "top", **look})
