"""What the name and the unit of a column say of it, and how likely a part of the test it is by them.

Ranks are small for the likeliest; None where a column cannot be the part.
"""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final, TypeVar

from reliab.recordings.behaviour import Likeness
from reliab.recordings.words import (
    ALTERATION_WORDS,
    CALCULATION_WORDS,
    COMMAND_ENDINGS,
    MEASURED_ENDINGS,
    NEUTRAL,
    QUANTITIES,
    ROLES,
    SIGNS,
    SYMBOLS,
    WEAK_ROLES,
    ChannelRole,
    Measurand,
    Unit,
    split_unit,
    unit_of,
)

_STEM: Final = re.compile(r"(?:\(\d+\)|\[\d+\]|\d+)+$")  # places in a matrix or a list behind its name


_Meaning = TypeVar("_Meaning", Measurand, ChannelRole)
_FLAG: Final = re.compile(r"^(?:at|new)(?=[A-Z])")  # atTarget: whether it was reached, not the target
_GERMAN: Final = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue"})
_TURKISH: Final = str.maketrans({"ö": "o", "ü": "u", "ı": "i", "Ö": "O", "Ü": "U", "İ": "I"})
_TURKISH_ONLY: Final = frozenset("çşğıÇŞĞİ")
_GAPS: Final = re.compile(
    r"[^A-Za-z0-9]+|(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])|(?<=[A-Za-z])(?=\d)|(?<=\d)(?=[A-Za-z])"
)
_LONGEST_NAME: Final = 200
_SHORTEST_GLUED, _LONGEST_WORD = 5, 40
_COORDINATES: Final = frozenset("xyzdus")

ROLELESS_RANK: Final = 8
"""Rank from which no word marks a displacement as measured."""

_WEAK_RANK, _ALTERED_RANK, _TABLE_RANK = 2, 4, 2
_LEAST_NOISE_RATIO = 3.0


def _meaning_by_word(words: Mapping[_Meaning, str]) -> dict[str, _Meaning]:
    return {word: meaning for meaning, word_list in words.items() for word in word_list.split()}


_QUANTITY_OF: Final = _meaning_by_word(QUANTITIES)


_ROLE_OF: Final = _meaning_by_word(ROLES)


_WEAK_ROLE_OF: Final = _meaning_by_word(WEAK_ROLES)


_ALTERATION_WORDS: Final = frozenset(ALTERATION_WORDS.split())


_LETTER_SUFFIXES: Final = frozenset(
    {
        *_ROLE_OF,
        *_WEAK_ROLE_OF,
        *(word for word in _QUANTITY_OF if _QUANTITY_OF[word] is Measurand.DISPLACEMENT),
    }
) - {"in", "pot", "is"}


_CALCULATION_WORDS: Final = frozenset(CALCULATION_WORDS.split())


_VOCABULARY: Final = frozenset(
    {*_QUANTITY_OF, *_ROLE_OF, *_WEAK_ROLE_OF, *_ALTERATION_WORDS, *NEUTRAL.split()}
)


_PRECEDENCE: Final = (  # of several quantities in a name: "Displacement error (mm)" is an error
    *(Measurand.ERROR, Measurand.VALVE, Measurand.VOLTAGE, Measurand.CURRENT, Measurand.VELOCITY),
    *(
        Measurand.ACCELERATION,
        Measurand.STRAIN,
        Measurand.PRESSURE,
        Measurand.TEMPERATURE,
        Measurand.ROTATION,
    ),
    *(Measurand.FORCE, Measurand.STATE, Measurand.TIME, Measurand.DISPLACEMENT, Measurand.COUNT),
)


@dataclass(frozen=True, kw_only=True)
class Meaning:
    """What the name and the unit of a column say."""

    column: str  # Its name in the file
    quantity: Measurand | None  # What it measures; None where nothing says so
    role: ChannelRole | None  # Its side of the transfer system; None where nothing says so
    weak: bool  # Whether the role rests on a word that often means something else
    is_altered: bool  # Whether a word says that the history was changed
    number: str  # Number of the actuator or channel; empty where the name has none
    unit: Unit | None  # Its unit, of the file or in the name


def describe(columns: Sequence[str], units: Mapping[str, str]) -> dict[str, Meaning]:
    """Say what names and units of all columns mean."""
    meanings = {column: _describe(column, unit_of(units.get(column, ""))) for column in columns}
    return {column: _role_by_ending(meaning, meanings) for column, meaning in meanings.items()}


def describe_columns(
    columns: Sequence[str], units: Mapping[str, str], *, has_names: bool
) -> dict[str, Meaning]:
    """Say what names and units mean; columns of one matrix have its name, which says nothing of any."""
    meanings = describe(columns, units)
    if has_names or len({_STEM.sub("", name) for name in meanings}) > 1:
        return meanings
    return {
        name: replace(
            meaning, quantity=meaning.unit.quantity if meaning.unit else None, role=None, is_altered=False
        )
        for name, meaning in meanings.items()
    }


def plain(name: str) -> str:
    """Letters and digits of a name, small, without what stands before its last point."""
    return re.sub(r"[^a-z0-9]+", "", _ascii(leaf(name)).lower())


def leaf(name: str) -> str:
    """Last part of a name such as `group.channel`; a point at its end or between digits ends no part."""
    return re.split(r"(?<=[^\d\s.])\.(?=[^\d\s.])", name)[-1]


def words_of(name: str) -> tuple[str, ...]:
    """Words of a name in small letters; those that were written without a gap are told from each other.

    >>> words_of("Act1_dispcmd"), words_of("Axial Displacement")
    (('act', '1', 'disp', 'cmd'), ('axial', 'displacement'))
    """
    parts = [part for part in _GAPS.split(_ascii(name)[:_LONGEST_NAME]) if part]
    text = "".join(parts).lower()
    if text in _VOCABULARY:  # "SetPoint", "LoadCell"
        return (text,)
    return tuple(word for part in parts for word in _split_compound(part.lower()))


@cache
def _split_compound(word: str) -> tuple[str, ...]:
    """Words of which one is put together, all of them known; itself where it is not."""
    if word in _VOCABULARY or len(word) > _LONGEST_WORD:
        return (word,)
    for letter, remainder in ((word[0], word[1:]), (word[-1], word[:-1])):  # xref, dmeas, cmdx
        if letter in _COORDINATES and remainder in _LETTER_SUFFIXES:
            return (letter, remainder)
    if len(word) < _SHORTEST_GLUED:
        return (word,)
    begins: dict[int, tuple[str, ...]] = {0: ()}
    for end in range(1, len(word) + 1):
        for begin in range(end - 2, -1, -1):  # longer words first
            if begin in begins and word[begin:end] in _VOCABULARY:
                candidate = (*begins[begin], word[begin:end])
                if end not in begins or len(candidate) < len(begins[end]):
                    begins[end] = candidate
    return begins.get(len(word), (word,))


_SIGN_WORDS: Final = {sign: word for word, signs in SIGNS.items() for sign in signs.split()}


_SIGN: Final = re.compile("|".join(sorted(_SIGN_WORDS, key=len, reverse=True)))


def _ascii(name: str) -> str:
    """Put words for signs, and plain letters for those with marks; ö is oe in German and o in Turkish."""
    if not name.isascii():
        name = _SIGN.sub(lambda sign: f" {_SIGN_WORDS[sign[0]]} ", unicodedata.normalize("NFKC", name))
    letters = name.translate(_TURKISH if _TURKISH_ONLY & set(name) else _GERMAN)
    plain_letters = unicodedata.normalize("NFKD", letters)
    return "".join(letter for letter in plain_letters if not unicodedata.combining(letter))


def _describe(column: str, stated_unit: Unit | None) -> Meaning:
    last = leaf(column)
    symbol = SYMBOLS.get(re.sub(r"\d+$", "", plain(last)))
    bare, unit_text = (last, None) if symbol else split_unit(last)
    if symbol is None and (shorter := SYMBOLS.get(re.sub(r"\d+$", "", plain(bare)))):
        symbol = shorter
    words, around = words_of(bare), words_of(column[: -len(last)] if last != column else "")
    role, weak = _role(words, around)
    if weak and role is ChannelRole.MEASURED and _CALCULATION_WORDS & {*words, *around}:
        role, weak = None, False  # "model output"
    quantity = _quantity(words) or _quantity(around)
    if symbol is not None:
        quantity, role, weak = symbol[0], symbol[1], False
    unit = stated_unit or unit_text
    return Meaning(
        column=column,
        quantity=_apply_unit(quantity, unit, words),
        role=role,
        weak=weak,
        is_altered=bool(_ALTERATION_WORDS & {*words, *around}) or bool(_FLAG.match(last)),
        number=_number(words, bare),
        unit=unit,
    )


def _apply_unit(quantity: Measurand | None, unit: Unit | None, words: Sequence[str]) -> Measurand | None:
    """Take what the unit says, but for errors, valves and states, which any unit may have."""
    if unit is None or quantity in {Measurand.ERROR, Measurand.VALVE}:
        return quantity
    if quantity is Measurand.STATE and unit.quantity is Measurand.TIME:  # "Time, default sample rate [s]"
        return Measurand.TIME if any(_QUANTITY_OF.get(word) is Measurand.TIME for word in words) else quantity
    return quantity if quantity is Measurand.STATE else unit.quantity


def _quantity(words: Sequence[str]) -> Measurand | None:
    quantities = {_QUANTITY_OF[word] for word in words if word in _QUANTITY_OF}
    return next((quantity for quantity in _PRECEDENCE if quantity in quantities), None)


def _role(words: Sequence[str], around: Sequence[str]) -> tuple[ChannelRole | None, bool]:
    """Role by the words of a name, else by those of its group, else by words that are weak."""
    for part, meanings, weak in (
        (words, _ROLE_OF, False),
        (around, _ROLE_OF, False),
        (words, _WEAK_ROLE_OF, True),
    ):
        roles = {meanings[word] for word in part if word in meanings}
        roles -= {ChannelRole.GROUND} if len(roles) > 1 else set()  # "table displacement command"
        if len(roles) == 1:
            return roles.pop(), weak
        if roles:
            return None, False  # "command feedback"
    return None, False


def _number(words: Sequence[str], bare: str) -> str:
    ending = re.search(r"[\s_.-]([xyz])$|(?<=[a-z])([XYZ])$", bare)
    digits = [word for word in words if word.isdigit()]
    return digits[-1] if digits else (ending[1] or ending[2]).lower() if ending else ""


def _role_by_ending(meaning: Meaning, meanings: Mapping[str, Meaning]) -> Meaning:
    """Tell x_d and x_m, or disp_c and disp_m, by their last letters, where both are there."""
    name = meaning.column
    if meaning.role is not None or len(name) < 3 or name[-2] != "_":  # noqa: PLR2004 - a letter, _ and a letter
        return meaning
    for endings, other_endings, role in (
        (COMMAND_ENDINGS, MEASURED_ENDINGS, ChannelRole.COMMAND),
        (MEASURED_ENDINGS, COMMAND_ENDINGS, ChannelRole.MEASURED),
    ):
        if name[-1].lower() in endings and any(name[:-1] + letter in meanings for letter in other_endings):
            return replace(
                meaning,
                role=role,
                unit=None if meaning.unit and meaning.unit.text == name[-1] else meaning.unit,
            )
    return meaning


def votes(likeness: Likeness) -> int:
    """Which of two histories is measured: 1 the second, -1 the first, 0 undecided.

    The one that follows, if it also carries more noise, or stands second and carries no less.
    """
    follows = 1 if likeness.lag > 0.0 else -1
    noisier = 0
    if not 1.0 / _LEAST_NOISE_RATIO < likeness.noise_ratio < _LEAST_NOISE_RATIO:
        noisier = 1 if likeness.noise_ratio > 1.0 else -1
    return follows if noisier == follows or (noisier == 0 and follows > 0) else 0


def _may_be(meaning: Meaning, quantity: Measurand) -> bool:
    return meaning.quantity in {None, quantity}


def _rank(meaning: Meaning) -> int:
    return (meaning.quantity is None) + _WEAK_RANK * meaning.weak + _ALTERED_RANK * meaning.is_altered


def rank_as_command(meaning: Meaning) -> int | None:
    """Rank a column as the commanded displacement."""
    if meaning.role is not ChannelRole.COMMAND or not _may_be(meaning, Measurand.DISPLACEMENT):
        return None
    return _rank(meaning)


def rank_as_measured(meaning: Meaning) -> int | None:
    """Rank a column as the measured displacement."""
    if not _may_be(meaning, Measurand.DISPLACEMENT):
        return None
    if meaning.role is ChannelRole.MEASURED:
        return _rank(meaning)
    if meaning.quantity is None or meaning.role is ChannelRole.COMMAND:
        return None
    return _rank(meaning) + ROLELESS_RANK + _TABLE_RANK * (meaning.role is ChannelRole.GROUND)


def rank_as_ground(meaning: Meaning) -> int | None:
    """Rank a column as the ground acceleration."""
    if (
        meaning.role is not ChannelRole.GROUND
        or not _may_be(meaning, Measurand.ACCELERATION)
        or meaning.is_altered
    ):
        return None
    return 0 if meaning.quantity is Measurand.ACCELERATION else 1


def rank_as_force(meaning: Meaning) -> int | None:
    """Rank a column as the force."""
    if meaning.quantity is not Measurand.FORCE or meaning.role is ChannelRole.COMMAND or meaning.is_altered:
        return None
    return 0 if meaning.role is ChannelRole.MEASURED else 1
