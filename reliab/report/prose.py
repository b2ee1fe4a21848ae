"""Running text of a report: literal text, mathematics, references, and how reports say things.

A plain string is always literal: nothing in it is taken for markup, whatever characters it has, so that
names and notes from a user's files are safe. The few marks of :func:`prose` are read in the template
that an author writes, never in the values that are put into it.
"""

import numbers
import re
import string
import unicodedata
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.criterion.methods.registry import METHODS

_MARKS: Final = re.compile(
    r"\$(?P<math>[^$]+)\$|\*(?P<strong>[^*]+)\*|@(?P<label>[a-z0-9]+(?:[:_-][a-z0-9]+)*)"
)
_SPACES: Final = re.compile(r"\s+")
_LONG_WORD: Final = re.compile(r"\S{41,}")
_PLACES_TO_BREAK: Final = re.compile(r"(?<=[/\\_.:;,=&?-])(?=\S)|(?<=\S{20})(?=\S)")
_ZERO_WIDTH_SPACE: Final = "\u200b"
_SET_SCRIPTS: Final = (
    (0x0000, 0x06FF),  # Latin, Greek, Cyrillic, Armenian, Hebrew, Arabic
    (0x0900, 0x097F),  # Devanagari
    (0x10A0, 0x10FF),  # Georgian
    (0x1D00, 0x2BFF),  # more Latin and Greek, punctuation, arrows, signs
    (0xFB00, 0xFDFF),  # ligatures, Hebrew and Arabic forms
    (0x1D400, 0x1D7FF),  # mathematical letters
)
"""Characters for which the fonts that come with typst have pictures; others would be set as boxes."""

_SIGNS: Final = re.compile(r"""(?:[A-Za-z0-9\s.,!'"|()\[\]_^=<>+*/-]|\\/)*""")
_WORD: Final = re.compile(r'"[^"]*"|[A-Za-z][A-Za-z0-9]+(?:\.[A-Za-z0-9]+)*')
_GREEK: Final = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega "
    "Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
)
_MORE_SYMBOLS: Final = (
    "abs approx arg bold cos dif dot dot.double exp frac hat in infinity integral lr ln log max min norm "
    "overline plus.minus prod quad sin sqrt sum tan tilde times upright"
)
_SINGLE_CHARACTERS: Final = frozenset(f"{_GREEK} {_MORE_SYMBOLS}".split())


@dataclass(frozen=True, kw_only=True)
class Math:
    """Mathematics in a line, in typst's notation."""

    source: str  # For example "(A - 1)^2 / a"; of known words and signs only

    def __post_init__(self) -> None:
        require_formula(self.source)


@dataclass(frozen=True, kw_only=True)
class Strong:
    """Emphasised literal text."""

    text: str  # The text


@dataclass(frozen=True, kw_only=True)
class Reference:
    """Reference to a figure, table, equation, section or source of the same document."""

    label: str  # The label of what is referred to


Piece = str | Math | Strong | Reference
Prose = str | tuple[Piece, ...]
"""Literal text, or pieces of text in their order."""


def prose(template: str, **values: object) -> tuple[Piece, ...]:
    """Make running text from a template with a few marks.

    `$…$` is mathematics in typst's notation, `*…*` emphasis, `@label` a reference, and `{name}` or
    `{name:format}` the value of that name, which is always literal. Mathematics is evaluated, so that
    only numbers and other mathematics can be put into it.

    >>> prose("{share} of *{name}* lie within $a$, see @fig:limits.", share="95 %", name="a*b$")
    ('95 % of ', Strong(text='a*b$'), ' lie within ', Math(source='a'), ', see ',
     Reference(label='fig:limits'), '.')
    """
    return tuple(filter(None, _pieces(template, values)))


def literal(text: str) -> str:
    r"""Clean literal text: no control characters, single spaces, places to break in very long words.

    Characters of scripts that the fonts of reports lack, such as Chinese, stand as their numbers.

    >>> literal("two\nlines\x00")
    'two lines'
    >>> print(literal("地震"))
    \u5730\u9707
    """
    printable = "".join(_set_as(character) for character in text if _is_set(character))
    single = _SPACES.sub(" ", printable)
    return _LONG_WORD.sub(lambda word: _PLACES_TO_BREAK.sub(_ZERO_WIDTH_SPACE, word[0]), single)


def plain_text(text: Prose) -> str:
    """Text without mathematics set and without references, for those who cannot see a figure.

    >>> plain_text(prose("Where $a$ is small, see @fig:limits."))
    'Where a is small, see fig:limits.'
    """
    return literal("".join(_plain(piece) for piece in ((text,) if isinstance(text, str) else text)))


def _plain(piece: Piece) -> str:
    match piece:
        case str():
            return piece
        case Math():
            return formula(piece.source)
        case Strong():
            return piece.text
        case Reference():
            return piece.label


def words_of(text: Prose) -> str:
    """Text for a screen: mathematics in letters and signs, sources by their labels in brackets.

    >>> words_of(prose("Where $alpha <= 1$, as in @guo2017, see @fig:limits."))
    'Where α ≤ 1, as in [guo2017], see the figure or table.'
    """
    return "".join(_words(piece) for piece in ((text,) if isinstance(text, str) else text))


def _words(piece: Piece) -> str:
    match piece:
        case Math():
            return formula(piece.source)
        case Reference() if ":" in piece.label:
            return "the figure or table"
        case Reference():
            return f"[{piece.label}]"
        case _:
            return _plain(piece)


_SYMBOLS: Final = {
    "alpha": "α", "beta": "β", "delta": "δ", "Delta": "Δ", "xi": "ξ", "tau": "τ", "omega": "ω", "phi": "φ",
    "gamma": "γ", "lambda": "λ", "sigma": "σ", "epsilon": "ε", "sqrt": "√", "times": "×", "dot": "·",
    "quad": " ", "plus.minus": "±",
    "lt.eq": "≤", "gt.eq": "≥", "approx": "≈", "minus": "−", "sum": "Σ", "pi": "π",
}  # fmt: skip
_WORD_OF_FORMULA: Final = re.compile(r"\.?[A-Za-z]+(?:\.[a-z]+)?")


def formula(source: str) -> str:
    """Write a formula of typst in letters and signs.

    >>> formula("alpha k <= sqrt(a)"), formula("lr((2 dot 10^(-5)))")
    ('α k ≤ √(a)', '(2 · 10^-5)')
    """
    signs = _WORD_OF_FORMULA.sub(lambda word: _SYMBOLS.get(word.group(), word.group()), source)
    text = signs.replace('"', "").replace("\\/", "/").replace("<=", "≤").replace(">=", "≥")
    return re.sub(r"\blr\((\([^()]*\))\)", r"\1", re.sub(r"\^\((-?\d+)\)", r"^\1", text))


def references(text: Prose) -> Iterator[str]:
    """Labels that a text refers to."""
    pieces = () if isinstance(text, str) else text
    for piece in pieces:
        if isinstance(piece, Reference):
            yield piece.label


def _set_as(character: str) -> str:
    if character.isspace():
        return " "
    if any(first <= ord(character) <= last for first, last in _SET_SCRIPTS):
        return character
    return character.encode("unicode_escape").decode()


def _is_set(character: str) -> bool:
    return character.isspace() or unicodedata.category(character) not in {"Cc", "Cf", "Cs", "Co", "Cn"}


def _pieces(template: str, values: dict[str, object]) -> Iterator[Piece]:
    end = 0
    for mark in _MARKS.finditer(template):
        yield _fill_template(template[end : mark.start()], values)
        end = mark.end()
        if mark["math"] is not None:
            yield Math(
                source=_fill_template(
                    mark["math"], {name: _evaluable(value) for name, value in values.items()}
                )
            )
        elif mark["strong"] is not None:
            yield Strong(text=_fill_template(mark["strong"], values))
        else:
            yield Reference(label=mark["label"])
    yield _fill_template(template[end:], values)


class _PlaceholderError:
    """Stands for a text that may be used outside of mathematics only."""

    def __format__(self, _: str) -> str:
        message = "Only numbers and mathematics can be put into mathematics."
        raise TypeError(message)


def _evaluable(value: object) -> object:
    if isinstance(value, Math):
        return value.source
    return value if isinstance(value, numbers.Real) else _PlaceholderError()


def _fill_template(template: str, values: dict[str, object]) -> str:
    return string.Formatter().vformat(template, (), values)


def require_formula(source: str) -> None:
    """Refuse what is no formula, before it is evaluated.

    The template evaluates formulas, and typst's language can read files: `#read(…)`, or without a sign
    `std.read(…)`. A formula is therefore built of what is listed here and of nothing else, whoever wrote it.

    >>> require_formula('"RMS"^R = sqrt(x_m - x_I) / (max abs(x_I))')
    >>> require_formula('std.read("/etc/hosts")')
    Traceback (most recent call last):
    ...
    ValueError: A formula is built of numbers, letters, signs and known words, not of 'std.read'.
    """
    words = [word for word in _WORD.findall(source) if not word.startswith('"')]
    unknown = [word for word in words if word not in _SINGLE_CHARACTERS]
    if unknown or not _SIGNS.fullmatch(source):
        first = unknown[0] if unknown else source
        message = f"A formula is built of numbers, letters, signs and known words, not of {first!r}."
        raise ValueError(message)


ERRORS: Final = {Metric.RMS: Math(source='"RMS"^R'), Metric.MTE: Math(source='"MTE"^R')}
"""The errors of the whole test in mathematics."""

MEANINGS_OF_ERRORS: Final = {
    Metric.RMS: "the RMS of measured minus exact displacement over the peak (not the RMS) of the exact one",
    Metric.MTE: "the largest difference of measured and exact displacement over the peak of the exact one",
}
"""What each error of the whole test is, in a clause."""


def replace_arguments_by_options(sentence: str) -> str:
    """Write arguments that a sentence names as options of the command line, which a filed report came from.

    >>> replace_arguments_by_options("Give its `force_channel`; see `reliab calibrate`.")
    'Give its --force-channel; see `reliab calibrate`.'
    """
    return re.sub(r"`([a-z]\w*)`", lambda name: f"--{name[1].replace('_', '-')}", sentence)


def window_in_words(window: str) -> str:
    """Part of the record over which the error is computed.

    >>> window_in_words("record"), window_in_words("40")
    ('the whole record', 'the first 40 s of the record')
    """
    phrases = {
        "record": "the whole record",
        "arias": "5 % to 95 % of the Arias intensity of the record",
    }
    return phrases.get(window, f"the first {window} s of the record")


def meaning_of_confidence(method: str) -> str:
    """Say what a stated confidence means by the method of a name; a method of an older file by its name.

    >>> meaning_of_confidence("order_statistic")
    'a bound by order statistics, free of any distribution'
    """
    return METHODS[method].meaning if method in METHODS else method


def probability(value: float) -> str:
    """Write a probability in per cent, without claiming that anything is certain.

    >>> probability(0.988), probability(0.0), probability(1.0)
    ('98.8 %', 'below 0.1 %', 'above 99.9 %')
    """
    if value < _RARE:
        return f"below {percent(_RARE)}"
    return f"above {percent(1.0 - _RARE)}" if value > 1.0 - _RARE else percent(value)


def values(numbers: Sequence[float], unit: str = "") -> str:
    """Write several values: few of them one by one, many by their range.

    >>> values([0.02]), values([0.5, 1.0], "Hz"), values([0.25, 0.5, 0.75, 1.0, 1.25], "Hz")
    ('0.02', '0.5 and 1 Hz', '0.25 to 1.25 Hz (5 values)')
    """
    words, ending = [f"{number:g}" for number in numbers], f" {unit}" if unit else ""
    if len(words) > _MOST_LISTED:
        return f"{words[0]} to {words[-1]}{ending} ({len(words)} values)"
    return f"{join_words(words)}{ending}"


def join_words(words: Sequence[str]) -> str:
    """Join words with commas and a last "and".

    >>> join_words(["a", "b", "c"])
    'a, b and c'
    """
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def spell_out(name: str) -> str:
    """Write a name of the package as words.

    >>> spell_out("viscous_damping")
    'viscous damping'
    """
    return name.replace("_", " ")


def law_in_words(name: str) -> str:
    """Name a published law as readers of the paper know it; other names stay as they are.

    >>> law_in_words("guo_2017_18_corrected"), law_in_words("dirichlet")
    ('equation (18) corrected', 'dirichlet')
    """
    match = re.fullmatch(r"guo_2017_(\d+)(_corrected)?", name)
    if match is None:
        return name
    return f"equation ({match[1]}){' corrected' if match[2] else ''}"


def error_below(metric: str, threshold: float) -> tuple[Piece, ...]:
    """Write an error and its bound, "RMS^R below 5 %"."""
    return (ERRORS[Metric(metric)], f" below {percent(threshold)}")


def number(value: float, digits: int = 3) -> str:
    """Write a number for mathematics in typst's notation.

    >>> number(5.29e-5), number(1.048), number(0.0)
    ('5.29 dot 10^(-5)', '1.05', '0')
    """
    if value == 0.0 or not np.isfinite(value):
        return "oo" if value else "0"
    exponent = int(f"{value:.{digits - 1}e}".partition("e")[2])
    if _SMALLEST <= exponent <= _GREATEST:
        return f"{value:.{max(digits - 1 - exponent, 0)}f}"
    mantissa = f"{value:.{digits - 1}e}".partition("e")[0]
    return f"{mantissa} dot 10^({exponent})"


def ellipse(a: float, b: float) -> Math:
    """Write (A − 1)²/a + d²/b ≤ 1 with its numbers, in a line."""
    return Math(source=f"(A - 1)^2 \\/ lr(({number(a)})) + d^2 \\/ {number(b)} <= 1")


_MOST_LISTED = 4
_RARE = 1e-3
_SMALLEST, _GREATEST = -2, 3
