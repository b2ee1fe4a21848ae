"""Which column is which: by its name, by its unit, and by what its history does beside the others.

Every choice has a reason. Where two columns are too close, the user is asked with both names; what nothing
says is never guessed.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Final

import numpy as np

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.recordings.behaviour import Likeness, compare, explained, moves
from reliab.recordings.naming import (
    WITHOUT_ROLE,
    Named,
    describe,
    plain,
    rank_as_command,
    rank_as_force,
    rank_as_ground,
    rank_as_measured,
    votes,
    words_of,
)
from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import DISPLACEMENTS, LARGEST_READING, QUANTITY_OF, Channel, Part, Stated
from reliab.recordings.units import UNITS, Unit, listed_units, unit_of
from reliab.recordings.words import Quantity, Role

_SIMILAR = 0.7
_LEAST_ALIKE, _MOST_ALIKE = 0.5, 0.9  # correlation of columns that are no pair, and of some that may be one
_STEM: Final = re.compile(r"(?:\(\d+\)|\[\d+\]|\d+)+$")  # places in a matrix or a list behind its name
_LEAST_LAG = 0.25  # samples by which one history must follow another before that says which is measured
_CLEAR = 3.0  # times nearer than the next pair
_EXPLAINED_FORCE = 0.95  # share of a nameless force that the measured motion explains at least
_IN_PHASE = 0.7  # correlation with the displacement that a nameless force has at least
_CLEAR_SHARE = 0.1  # of a force that motion explains and the next force does not show


def recognise(
    columns: Columns,
    stated: Mapping[Part, Stated],
    *,
    needed: Iterable[Part] = DISPLACEMENTS,
    histories: bool = True,
) -> tuple[Channel, ...]:
    """Find time, command, measured displacement, force and ground acceleration among the columns.

    What is `needed` must be there; without `histories`, as of a test that has just begun, names and units
    decide. Command and measured displacement come once for each actuator.
    """
    search = _Search(columns, stated, histories=histories)
    time = search.time()
    pairs = search.pairs(tuple(needed), time)
    extras = search.extras(pairs, time)
    return (*((time,) if time else ()), *pairs, *extras)


def described_columns(columns: Columns) -> dict[str, Named]:
    """Say what names and units mean; columns of one matrix have its name, which says nothing of any."""
    named = describe(list(columns.values), columns.units)
    if columns.named or len({_STEM.sub("", name) for name in named}) > 1:
        return named
    return {
        name: replace(what, quantity=what.unit.quantity if what.unit else None, role=None, altered=False)
        for name, what in named.items()
    }


class _Search:
    """The columns of one test, with what their names say."""

    def __init__(self, columns: Columns, stated: Mapping[Part, Stated], *, histories: bool) -> None:
        self._columns, self._stated, self._histories = columns, stated, histories
        self._part_name = described_columns(columns)
        self._likenesses: dict[tuple[str, str], Likeness] = {}

    def time(self) -> Channel | None:
        """Find the column of the times; None where there is none."""
        if (declared := self._missing_declared(Part.TIME)) is not None:
            return declared
        candidates = [what for what in self._part_name.values() if what.quantity is Quantity.TIME]
        if len(candidates) > 1 and self._histories:
            candidates = [what for what in candidates if self._rises(what.column)] or candidates
        exact = [what for what in candidates if plain(what.column) in {"time", "t", "times"}]
        if candidates:
            return self._channel(Part.TIME, (exact or candidates)[0], "its name or unit")
        if self._columns.named or not self._histories:
            return None
        rising = [what for what in self._part_name.values() if what.unit is None and self._rises(what.column)]
        return (
            self._channel(Part.TIME, rising[0], "the only column that rises by equal steps")
            if len(rising) == 1
            else None
        )

    def pairs(self, needed: Sequence[Part], time: Channel | None) -> tuple[Channel, ...]:
        """Find command and measured displacement, of each actuator where there are several."""
        if recorded := self._record_pairs():
            return recorded
        declared = {part: self._missing_declared(part) for part in DISPLACEMENTS}
        taken = {channel.column for channel in (time, *declared.values()) if channel is not None}
        ranked = {
            part: [] if declared[part] else self._rank(rank, taken)
            for part, rank in ((Part.COMMAND, rank_as_command), (Part.MEASURED, rank_as_measured))
        }
        if not any(declared.values()) and (numbered := self._numbered_pairs(ranked)):
            return numbered
        command, measured = (declared[part] or self._best(part, ranked[part]) for part in DISPLACEMENTS)
        if command is not None and declared[Part.COMMAND] is None:
            self._require_plain(self._part_name[command.column], taken, ranked[Part.MEASURED])
        if self._histories and command and measured and not any(declared.values()):
            self._require_alike(command, measured)
        if self._histories and (command is None or measured is None):
            command, measured = self._pair_by_histories(command, measured, taken, needed)
        if self._histories and command and measured and not any(declared.values()):
            self._require_following(command, measured)
        for part, channel in zip(DISPLACEMENTS, (command, measured), strict=True):
            if channel is None and part in needed:
                raise self._missing(part)
        return tuple(channel for channel in (command, measured) if channel is not None)

    def _record_pairs(self) -> tuple[Channel, ...]:
        """Pairs of several actuators, as a record names them."""
        if any(self._stated.get(part, Stated()).columns for part in DISPLACEMENTS):
            return ()
        return tuple(
            self._channel(part, self._part_name[column], "the record says so", number)
            for column, (name, number) in self._columns.parts.items()
            for part in DISPLACEMENTS
            if number and name == part
        )

    def extras(self, pairs: Sequence[Channel], time: Channel | None) -> tuple[Channel, ...]:
        """Find ground acceleration and force, where one column is it."""
        taken = {channel.column for channel in pairs}
        candidates = []
        for part, rank in ((Part.GROUND, rank_as_ground), (Part.FORCE, rank_as_force)):
            declared = self._missing_declared(part)
            ranked = [] if declared else self._rank(rank, taken)
            best = [what for place, what in ranked if place == ranked[0][0]]
            if part is Part.FORCE and len(best) > 1:
                best = self._best_explained_force(best, pairs)
            if declared is not None:
                candidates.append(declared)
            elif part is Part.FORCE and not ranked:
                candidates += self._force_by_histories(pairs, time)
            elif len(best) == 1:
                candidates.append(self._channel(part, best[0], "its name or unit"))
        return tuple(candidates)

    def _rank(self, rank: Callable[[Named], int | None], taken: Iterable[str]) -> list[tuple[int, Named]]:
        """Columns that can be a part, the likeliest first; of several those that do not move are left out."""
        candidates = [
            (place, what)
            for what in self._part_name.values()
            if what.column not in set(taken) and (place := rank(what)) is not None
        ]
        moving = [item for item in candidates if not self._histories or self._moves(item[1].column)]
        return sorted(moving or candidates, key=lambda item: item[0])

    def _missing_declared(self, part: Part) -> Channel | None:
        names = self._stated[part].columns if part in self._stated else ()
        for column, (name, actuator) in self._columns.parts.items():
            if name == part and not names and not actuator:
                return self._channel(part, self._part_name[column], "the record says so")
        if not names:
            return None
        for name in names:
            if name in self._columns.values:
                return self._channel(part, self._part_name[name], "stated")
        close = get_close_matches(names[0], list(self._columns.values), n=1, cutoff=0.5)
        listed = f"Columns in the file: {self._columns.listed}"
        raise InputError(
            f"No column {' or '.join(repr(name) for name in names)} for the {_part_name(part)}",
            remedy=f"Did you mean {close[0]!r}? {listed}" if close else listed,
            where=self._columns.where,
        )

    def _channel(self, part: Part, what: Named, reason: str, actuator: str = "") -> Channel:
        """Take a column as a part, in the unit that is stated, else in that of the file."""
        laboratory = self._stated.get(part, Stated())
        unit = self._unit(part, laboratory.unit) if laboratory.unit else what.unit
        if unit is not None and unit.quantity is not QUANTITY_OF[part]:
            unit = None
        return Channel(
            part=part,
            column=what.column,
            unit="" if unit is None else unit.text,
            factor=laboratory.sign * laboratory.scale * (1.0 if unit is None else unit.factor),
            reason=reason,
            zero=laboratory.zero,
            actuator=actuator,
        )

    def _unit(self, part: Part, text: str) -> Unit:
        unit = unit_of(text)
        if unit is None or unit.quantity is not QUANTITY_OF[part]:
            kind = {Quantity.DISPLACEMENT: "length"}.get(QUANTITY_OF[part], str(QUANTITY_OF[part]))
            raise InputError(
                f"Unknown unit of {kind}: {text!r}",
                remedy=f"Choose among {listed_units(UNITS[QUANTITY_OF[part]])}",
            )
        return unit

    def _best(self, part: Part, ranked: Sequence[tuple[int, Named]]) -> Channel | None:
        """Take the likeliest column by its name, unless another one moves as it does and differs from it."""
        if not ranked or (ranked[0][0] >= WITHOUT_ROLE and self._histories):
            return None
        place, best = ranked[0]
        rivals = [
            what
            for rival, what in ranked[1:]
            if rival // 2 == place // 2 and (rival == place or self._may_be_it(best, what))
        ]
        others = [what for what in rivals if not self._copies(best, what)]
        if others:
            raise self._ambiguous(part, [best, *others])
        reason = "its name" if not rivals else f"its name; {rivals[0].column!r} is a copy of it"
        return self._channel(part, best, reason)

    def _require_alike(self, command: Channel, measured: Channel) -> None:
        """Ask where two columns with names of a pair do not move together, and another moves with one."""
        pair = (command.column, measured.column)
        if self._compare(*pair).correlation > _LEAST_ALIKE:
            return
        others = [
            name
            for name, what in self._part_name.items()
            if name not in pair and what.quantity in {None, Quantity.DISPLACEMENT} and self._moves(name)
            if any(self._compare(column, name).correlation > _MOST_ALIKE for column in pair)
        ]
        if others:
            raise self._ambiguity_error([*pair, *others], "do not all move together")

    def _require_following(self, command: Channel, measured: Channel) -> None:
        """Ask where words that often mean something else say which is which, and the histories deny it."""
        names = [self._part_name[channel.column] for channel in (command, measured)]
        likeness = self._compare(command.column, measured.column)
        as_command, as_measured = (what.weak for what in names)
        denied = likeness.lag < -_LEAST_LAG and votes(likeness) < 0
        confirmed = likeness.lag > _LEAST_LAG and votes(likeness) > 0
        if any(what.role is not None and not what.weak for what in names):
            return
        if (denied and (as_command or as_measured)) or (as_measured and not as_command and not confirmed):
            raise self._ambiguity_error(
                [command.column, measured.column], "move together, and neither is named so"
            )

    def _require_plain(
        self, command: Named, taken: Iterable[str], as_measured: Sequence[tuple[int, Named]]
    ) -> None:
        """Ask where the command was changed, and an unchanged column moves as it does."""
        if not command.altered:
            return
        plain_ones = [
            what
            for what in self._part_name.values()
            if what.quantity is Quantity.DISPLACEMENT and what.role is None and not what.altered
            if what.column not in taken and self._may_be_it(command, what)
        ]
        measured_by_role = bool(as_measured) and as_measured[0][0] < WITHOUT_ROLE
        if len(plain_ones) > (0 if measured_by_role else 1):
            raise self._ambiguous(Part.COMMAND, [command, *plain_ones])

    def _may_be_it(self, best: Named, what: Named) -> bool:
        """Whether a column of a lesser name moves as the best one does, in the same unit as far as known."""
        if not self._histories:
            return True
        likeness = self._compare(best.column, what.column)
        if best.unit is not None and what.unit is not None:
            likeness = replace(likeness, ratio=likeness.ratio * what.unit.factor / best.unit.factor)
        return likeness.alike

    def _numbered_pairs(self, ranked: Mapping[Part, Sequence[tuple[int, Named]]]) -> tuple[Channel, ...]:
        """Pairs of several actuators: the likeliest columns bear numbers, each once, and the same in both."""
        by_number: dict[Part, dict[str, Named]] = {}
        for part in DISPLACEMENTS:
            first = [what for place, what in ranked[part] if place == ranked[part][0][0]]
            by_number[part] = {what.number: what for what in first}
            if len(by_number[part]) < max(len(first), 2):
                return ()
        command, measured = (by_number[part] for part in DISPLACEMENTS)
        if set(command) != set(measured):
            return ()
        return tuple(
            self._channel(part, numbers[number], "its name and number", number or "0")
            for number in sorted(command)
            for part, numbers in ((Part.COMMAND, command), (Part.MEASURED, measured))
        )

    def _pair_by_histories(
        self,
        command: Channel | None,
        measured: Channel | None,
        taken: set[str],
        needed: Sequence[Part],
    ) -> tuple[Channel | None, Channel | None]:
        """Complete the pair by what the columns do beside each other."""
        held = {channel.column for channel in (command, measured) if channel is not None}
        candidates = [
            what
            for what in self._part_name.values()
            if what.column not in taken | held
            and self._can_be_displacement(what)
            and self._moves(what.column)
        ]
        if command is not None:
            return command, self._partner(command, Part.MEASURED, candidates)
        if measured is not None:
            if Part.COMMAND not in needed:
                return None, measured
            return self._partner(measured, Part.COMMAND, candidates), measured
        if not set(needed) >= set(DISPLACEMENTS):
            lengths = [what for what in candidates if what.quantity is Quantity.DISPLACEMENT]
            if len(lengths) > 1:
                return self._leading_pair(lengths)
            return None, self._channel(
                Part.MEASURED, lengths[0], "the only displacement"
            ) if lengths else None
        return self._leading_pair(candidates)

    def _can_be_displacement(self, what: Named) -> bool:
        """Whether unit or name say that a column is a displacement, or the format leaves both out."""
        if what.quantity is None:
            return not self._columns.named
        return what.quantity is Quantity.DISPLACEMENT and what.role is not Role.GROUND

    def _partner(self, held: Channel, part: Part, candidates: Sequence[Named]) -> Channel | None:
        """Find the one column that moves as the one that is known."""
        alike = [
            (self._compare(held.column, what.column), what)
            for what in candidates
            if what.role is None or (what.weak and str(what.role) == str(part))
        ]
        unaltered = [item for item in alike if not item[1].altered] or alike
        close = [(likeness, what) for likeness, what in unaltered if likeness.correlation > 0.5]  # noqa: PLR2004
        if not close:
            return None
        close.sort(key=lambda item: -item[0].correlation)
        distinct = [what for _, what in close if what is close[0][1] or not self._copies(close[0][1], what)]
        if len(distinct) > 1:
            raise self._ambiguous(part, distinct)
        likeness = close[0][0]
        return self._channel(
            part,
            close[0][1],
            f"the only displacement that moves with {held.column!r} (correlation {likeness.correlation:.3f})",
        )

    def _leading_pair(self, candidates: Sequence[Named]) -> tuple[Channel | None, Channel | None]:
        """Take the two columns that move most alike; of them the one that follows is measured."""
        pairs = [
            (self._compare(first.column, second.column), first, second)
            for place, first in enumerate(candidates)
            for second in candidates[place + 1 :]
            if first.unit is None or second.unit is None or first.unit.quantity is second.unit.quantity
        ]
        pairs = [item for item in pairs if item[0].alike]
        if not pairs:
            return None, None
        pairs.sort(key=lambda item: -item[0].correlation)
        likeness, first, second = pairs[0]
        rivals = [
            item for item in pairs[1:] if {first.column, second.column} & {item[1].column, item[2].column}
        ]
        unclear = [
            item for item in pairs[1:2] if _CLEAR * (1.0 - likeness.correlation) > 1.0 - item[0].correlation
        ]
        if rivals or unclear:  # two sensors of one motion are more alike than command and motion
            involved = dict.fromkeys(
                what.column for item in (pairs[0], *rivals, *unclear) for what in item[1:]
            )
            raise self._ambiguity_error(list(involved), "move alike")
        side = votes(likeness)
        if abs(likeness.lag) < _LEAST_LAG or side == 0:
            raise self._ambiguity_error(
                [first.column, second.column], "move together, and neither clearly follows"
            )
        leader, follower = (first, second) if side > 0 else (second, first)
        reason = (
            f"the two move most alike (correlation {likeness.correlation:.3f}), and {follower.column!r} "
            f"follows by {significant(abs(likeness.lag))} samples"
        )
        return self._channel(Part.COMMAND, leader, reason), self._channel(Part.MEASURED, follower, reason)

    def _force_by_histories(self, pairs: Sequence[Channel], time: Channel | None) -> list[Channel]:
        """Take the one nameless column beside a pair that is a force by what it does.

        The measured motion explains it better than the command does, it rises with the displacement, which a
        velocity and an acceleration do not, and it has another size, which a second sensor has not.
        """
        motion = {channel.part: self._columns.values[channel.column] for channel in pairs}
        used = {channel.column for channel in (*pairs, *((time,) if time else ()))}
        others = [name for name in self._columns.values if name not in used and self._moves(name)]
        nameless = not self._columns.named and self._histories
        if not nameless or len(others) != 1 or set(motion) != set(DISPLACEMENTS) or len(pairs) != 2:  # noqa: PLR2004
            return []
        (name,), measured = others, motion[Part.MEASURED]
        values, what = self._columns.values[name], self._part_name[name]
        if what.quantity is not None or values.size != measured.size:
            return []
        share = explained(values, measured)
        if (
            share < _EXPLAINED_FORCE
            or explained(values, motion[Part.COMMAND]) >= share
            or np.corrcoef(values, measured)[0, 1] < _IN_PHASE
            or compare(measured, values).alike
        ):
            return []
        reason = f"the only other column; the measured motion explains {100.0 * share:.4g} % of it"
        return [self._channel(Part.FORCE, what, reason)]

    def _best_explained_force(self, forces: Sequence[Named], pairs: Sequence[Channel]) -> list[Named]:
        """Take the force that the measured motion explains, where it explains no other as well."""
        motion = next((channel.column for channel in pairs if channel.part is Part.MEASURED), None)
        if motion is None or not self._histories:
            return list(forces)
        values = self._columns.values
        shares = [explained(values[what.column], values[motion]) for what in forces]
        order = np.argsort(shares)
        clear = shares[order[-1]] - shares[order[-2]] > _CLEAR_SHARE
        return [forces[int(order[-1])]] if clear else list(forces)

    def _compare(self, first: str, second: str) -> Likeness:
        if (first, second) not in self._likenesses:
            values = self._columns.values
            self._likenesses[first, second] = compare(values[first], values[second])
        return self._likenesses[first, second]

    def _copies(self, first: Named, second: Named) -> bool:
        return self._histories and self._compare(first.column, second.column).copies

    def _moves(self, column: str) -> bool:
        return moves(self._columns.values[column])

    def _rises(self, column: str) -> bool:
        """Whether a column rises by steps that are not whole numbers, which a counter has."""
        values = self._columns.values[column]
        if not (np.abs(values) < LARGEST_READING).all():
            return False
        steps = np.diff(values)
        return bool(steps.size and steps.mean() > 0.0 and (steps >= 0.0).all() and steps.mean() != 1.0)

    def _ambiguous(self, part: Part, candidates: Sequence[Named]) -> InputError:
        those = " and ".join(repr(what.column) for what in candidates)
        return InputError(
            f"Several columns could be the {_part_name(part)}: {those}",
            remedy=f"Choose one with `{part}`" if part in DISPLACEMENTS else "State it in `channels`",
            where=self._columns.where,
        )

    def _ambiguity_error(self, names: Sequence[str], why: str) -> InputError:
        those = " and ".join(repr(name) for name in names)
        return InputError(
            f"Which is the command, which the measured displacement? {those} {why}",
            remedy="Say which is which with `command` and `measured`",
            where=self._columns.where,
        )

    def _missing(self, part: Part) -> InputError:
        return InputError(
            f"No column for the {_part_name(part)}",
            remedy=f"{self._suggestion(part)}. Columns in the file: {self._columns.listed}",
            where=self._columns.where,
        )

    def _suggestion(self, part: Part) -> str:
        by_word = {word: name for name in self._columns.values for word in {plain(name), *words_of(name)}}
        if close := get_close_matches(str(part), by_word, n=1, cutoff=_SIMILAR):
            name = by_word[close[0]]
            return f"Did you mean {name!r}? Then rename it to {part}, or give `{part}={name}`"
        return f"Name the column {part}, or say which it is with `{part}`"


def _part_name(part: Part) -> str:
    """Name a part in a sentence."""
    return "measured displacement" if part is Part.MEASURED else str(part)
