"""What axes are called, with their units, and what several figures draw alike."""

from functools import cache
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font
from matplotlib.ft2font import FT2Font
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter
from numpy.typing import ArrayLike, NDArray

from reliab.core.significant_digits import significant
from reliab.core.vocabulary import Metric
from reliab.report.style import RC

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
