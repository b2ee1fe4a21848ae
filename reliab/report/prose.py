"""Running text of a report: literal text, mathematics, emphasis and references.

A plain string is always literal: nothing in it is taken for markup, whatever characters it has, so that
names and notes from a user's files are safe. The few marks of :func:`prose` are read in the template
that an author writes, never in the values that are put into it.
"""

import numbers
import re
import string
import unicodedata
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

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
