"""Which column is which: by its name, by its unit, and by what its history does beside the others.

Every choice has a reason. Where two columns are too close, the user is asked with both names; what nothing
says is never guessed.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches

import numpy as np

from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.recordings.behaviour import Likeness, compare, moves, rises, share_explained
from reliab.recordings.naming import (
    ROLELESS_RANK,
    Meaning,
    describe_columns,
    plain,
    rank_as_command,
    rank_as_force,
    rank_as_ground,
    rank_as_measured,
    votes,
    words_of,
)
from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import (
    DISPLACEMENTS,
    QUANTITY_OF,
    Channel,
    ChannelDeclaration,
    Part,
)
from reliab.recordings.words import UNITS, ChannelRole, Measurand, Unit, unit_of, units_text

_SIMILAR = 0.7
_LOWEST_CORRELATION, _HIGHEST_CORRELATION = 0.5, 0.9  # of columns that are no pair, and that may be one
_LEAST_LAG = 0.25  # samples by which one history must follow another before that says which is measured
_CLEAR = 3.0  # times nearer than the next pair
_EXPLAINED_FORCE = 0.95  # share of a nameless force that the measured motion explains at least
_FORCE_CORRELATION = 0.7  # correlation with the displacement that a nameless force has at least
_CLEAR_SHARE = 0.1  # of a force that motion explains and the next force does not show


def recognise(
    columns: Columns,
    declarations: Mapping[Part, ChannelDeclaration],
    *,
    needed_parts: Iterable[Part] = DISPLACEMENTS,
    histories: bool = True,
) -> tuple[Channel, ...]:
    """Find time, command, measured displacement, force and ground acceleration among the columns.

    What is `needed_parts` must be there; without `histories`, as of a test that has just begun, names and
    units decide. Command and measured displacement come once for each actuator.
    """
    search = _Search(columns, declarations, histories=histories)
    time = search.time()
    pairs = search.pairs(tuple(needed_parts), time)
    extras = search.extras(pairs, time)
    return (*((time,) if time else ()), *pairs, *extras)


class _Search:
    """The columns of one test, with what their names say."""

    def __init__(
        self, columns: Columns, declarations: Mapping[Part, ChannelDeclaration], *, histories: bool
    ) -> None:
        self._columns, self._stated, self._histories = columns, declarations, histories
        self._part_name = describe_columns(list(columns.values), columns.units, has_names=columns.named)
        self._likenesses: dict[tuple[str, str], Likeness] = {}

    def time(self) -> Channel | None:
        """Find the column of the times; None where there is none."""
        if (explicit := self._missing_declared(Part.TIME)) is not None:
            return explicit
        values = self._columns.values
        candidates = [meaning for meaning in self._part_name.values() if meaning.quantity is Measurand.TIME]
        if len(candidates) > 1 and self._histories:
            candidates = [meaning for meaning in candidates if rises(values[meaning.column])] or candidates
        exact = [meaning for meaning in candidates if plain(meaning.column) in {"time", "t", "times"}]
        if candidates:
            return self._channel(Part.TIME, (exact or candidates)[0], "its name or unit")
        if self._columns.named or not self._histories:
            return None
        others = (meaning for meaning in self._part_name.values() if meaning.unit is None)
        rising = [meaning for meaning in others if rises(values[meaning.column])]
        if len(rising) != 1:
            return None
        return self._channel(Part.TIME, rising[0], "the only column that rises by equal steps")

    def pairs(self, needed_parts: Sequence[Part], time: Channel | None) -> tuple[Channel, ...]:
        """Find command and measured displacement, of each actuator where there are several."""
        if pairs_of_record := self._record_pairs():
            return pairs_of_record
        explicit = {part: self._missing_declared(part) for part in DISPLACEMENTS}
        taken_columns = {channel.column for channel in (time, *explicit.values()) if channel is not None}
        ranking = {
            part: [] if explicit[part] else self._rank(rank, taken_columns)
            for part, rank in ((Part.COMMAND, rank_as_command), (Part.MEASURED, rank_as_measured))
        }
        if not any(explicit.values()) and (number_pairs := self._pairs_by_number(ranking)):
            return number_pairs
        command, reading = (explicit[part] or self._best(part, ranking[part]) for part in DISPLACEMENTS)
        if command is not None and explicit[Part.COMMAND] is None:
            self._require_plain(self._part_name[command.column], taken_columns, ranking[Part.MEASURED])
        if self._histories and command and reading and not any(explicit.values()):
            self._require_alike(command, reading)
        if self._histories and (command is None or reading is None):
            command, reading = self._pair_by_histories(command, reading, taken_columns, needed_parts)
        if self._histories and command and reading and not any(explicit.values()):
            self._require_following(command, reading)
        for part, channel in zip(DISPLACEMENTS, (command, reading), strict=True):
            if channel is None and part in needed_parts:
                raise self._missing(part)
        return tuple(channel for channel in (command, reading) if channel is not None)

    def _record_pairs(self) -> tuple[Channel, ...]:
        """Pairs of several actuators, as a record names them."""
        if any(self._stated.get(part, ChannelDeclaration()).columns for part in DISPLACEMENTS):
            return ()
        return tuple(
            self._channel(part, self._part_name[column], "its name", number)
            for column, (name, number) in self._columns.parts.items()
            for part in DISPLACEMENTS
            if number and name == part
        )

    def extras(self, pairs: Sequence[Channel], time: Channel | None) -> tuple[Channel, ...]:
        """Find ground acceleration and force where one column is it, and the forces of several actuators."""
        taken_columns = {channel.column for channel in pairs}
        numbers = [channel.actuator for channel in pairs if channel.part is Part.COMMAND]
        candidates = []
        for part, rank in ((Part.GROUND, rank_as_ground), (Part.FORCE, rank_as_force)):
            if part is Part.FORCE and len(numbers) > 1:
                candidates += self._forces_by_number(numbers, taken_columns)
                continue
            explicit = self._missing_declared(part)
            best = [] if explicit else _likeliest(self._rank(rank, taken_columns))
            is_unnamed = part is Part.FORCE and not best
            if part is Part.FORCE and len(best) > 1:
                best = self._best_explained_force(best, pairs)
            if explicit is not None:
                candidates.append(explicit)
            elif is_unnamed:
                candidates += self._force_by_histories(pairs, time)
            elif len(best) == 1:
                candidates.append(self._channel(part, best[0], "its name or unit"))
        return tuple(candidates)

    def _forces_by_number(self, numbers: Sequence[str], taken_columns: set[str]) -> list[Channel]:
        """Find the forces of several actuators, where one column with the number of each is it."""
        named = [
            (number, self._part_name[column])
            for column, (name, number) in self._columns.parts.items()
            if number and name == Part.FORCE
        ]
        if not named:
            best = _likeliest(self._rank(rank_as_force, taken_columns))
            named = [(meaning.number or "0", meaning) for meaning in best]
        if sorted(number for number, _ in named) != sorted(numbers):
            return []
        reason = "its name and number"
        return [self._channel(Part.FORCE, meaning, reason, number) for number, meaning in named]

    def _rank(
        self, rank: Callable[[Meaning], int | None], taken_columns: Iterable[str]
    ) -> list[tuple[int, Meaning]]:
        """Columns that can be a part, the likeliest first; of several those that do not move are left out."""
        candidates = [
            (place, meaning)
            for meaning in self._part_name.values()
            if meaning.column not in set(taken_columns) and (place := rank(meaning)) is not None
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
        column_list = f"Columns in the file: {self._columns.names_text}"
        raise InputError(
            f"No column {' or '.join(repr(name) for name in names)} for the {_part_name(part)}",
            remedy=f"Did you mean {close[0]!r}? {column_list}" if close else column_list,
            where=self._columns.location,
        )

    def _channel(self, part: Part, meaning: Meaning, reason: str, actuator: str = "") -> Channel:
        """Take a column as a part, in the unit that is stated, else in that of the file."""
        laboratory = self._stated.get(part, ChannelDeclaration())
        unit = self._unit(part, laboratory.unit) if laboratory.unit else meaning.unit
        if unit is not None and unit.quantity is not QUANTITY_OF[part]:
            unit = None
        return Channel(
            part=part,
            column=meaning.column,
            unit="" if unit is None else unit.text,
            factor=laboratory.sign * laboratory.scale * (1.0 if unit is None else unit.factor),
            reason=reason,
            zero=laboratory.zero,
            actuator=actuator,
        )

    def _unit(self, part: Part, text: str) -> Unit:
        unit = unit_of(text)
        if unit is None or unit.quantity is not QUANTITY_OF[part]:
            kind = {Measurand.DISPLACEMENT: "length"}.get(QUANTITY_OF[part], str(QUANTITY_OF[part]))
            raise InputError(
                f"Unknown unit of {kind}: {text!r}",
                remedy=f"Choose among {units_text(UNITS[QUANTITY_OF[part]])}",
            )
        return unit

    def _best(self, part: Part, ranking: Sequence[tuple[int, Meaning]]) -> Channel | None:
        """Take the likeliest column by its name, unless another one moves as it does and differs from it."""
        if not ranking or (ranking[0][0] >= ROLELESS_RANK and self._histories):
            return None
        place, best = ranking[0]
        rivals = [
            meaning
            for rival, meaning in ranking[1:]
            if rival // 2 == place // 2 and (rival == place or self._may_be_it(best, meaning))
        ]
        other_rivals = [meaning for meaning in rivals if not self._copies(best, meaning)]
        if other_rivals:
            raise self._ambiguous(part, [best, *other_rivals])
        reason = "its name" if not rivals else f"its name; {rivals[0].column!r} is a copy of it"
        return self._channel(part, best, reason)

    def _require_alike(self, command: Channel, reading: Channel) -> None:
        """Ask where two columns with names of a pair do not move together, and another moves with one."""
        pair = (command.column, reading.column)
        if self._compare(*pair).correlation > _LOWEST_CORRELATION:
            return
        other_columns = [
            name
            for name, meaning in self._part_name.items()
            if name not in pair and meaning.quantity in {None, Measurand.DISPLACEMENT} and self._moves(name)
            if any(self._compare(column, name).correlation > _HIGHEST_CORRELATION for column in pair)
        ]
        if other_columns:
            raise self._ambiguity_error([*pair, *other_columns], "do not all move together")

    def _require_following(self, command: Channel, reading: Channel) -> None:
        """Ask where words that often mean something else say which is which, and the histories deny it."""
        names = [self._part_name[channel.column] for channel in (command, reading)]
        likeness = self._compare(command.column, reading.column)
        is_weak_command, is_weak_measured = (meaning.weak for meaning in names)
        is_contradicted = likeness.lag < -_LEAST_LAG and votes(likeness) < 0
        is_confirmed = likeness.lag > _LEAST_LAG and votes(likeness) > 0
        if any(meaning.role is not None and not meaning.weak for meaning in names):
            return
        if (is_contradicted and (is_weak_command or is_weak_measured)) or (
            is_weak_measured and not is_weak_command and not is_confirmed
        ):
            raise self._ambiguity_error(
                [command.column, reading.column], "move together, and neither is named so"
            )

    def _require_plain(
        self,
        command: Meaning,
        taken_columns: Iterable[str],
        measured_ranking: Sequence[tuple[int, Meaning]],
    ) -> None:
        """Ask where the command was changed, and an unchanged column moves as it does."""
        if not command.is_altered:
            return
        plain_ones = [
            meaning
            for meaning in self._part_name.values()
            if meaning.quantity is Measurand.DISPLACEMENT and meaning.role is None and not meaning.is_altered
            if meaning.column not in taken_columns and self._may_be_it(command, meaning)
        ]
        measured_by_role = bool(measured_ranking) and measured_ranking[0][0] < ROLELESS_RANK
        if len(plain_ones) > (0 if measured_by_role else 1):
            raise self._ambiguous(Part.COMMAND, [command, *plain_ones])

    def _may_be_it(self, best: Meaning, meaning: Meaning) -> bool:
        """Whether a column of a lesser name moves as the best one does, in the same unit as far as known."""
        if not self._histories:
            return True
        likeness = self._compare(best.column, meaning.column)
        if best.unit is not None and meaning.unit is not None:
            likeness = replace(likeness, ratio=likeness.ratio * meaning.unit.factor / best.unit.factor)
        return likeness.is_pair

    def _pairs_by_number(self, ranking: Mapping[Part, Sequence[tuple[int, Meaning]]]) -> tuple[Channel, ...]:
        """Pairs of several actuators: the likeliest columns bear numbers, each once, and the same in both."""
        meanings: dict[Part, dict[str, Meaning]] = {}
        for part in DISPLACEMENTS:
            first = _likeliest(ranking[part])
            meanings[part] = {meaning.number: meaning for meaning in first}
            if len(meanings[part]) < max(len(first), 2):
                return ()
        command, measured_columns = (meanings[part] for part in DISPLACEMENTS)
        if set(command) != set(measured_columns):
            return ()
        return tuple(
            self._channel(part, numbers[number], "its name and number", number or "0")
            for number in sorted(command)
            for part, numbers in ((Part.COMMAND, command), (Part.MEASURED, measured_columns))
        )

    def _pair_by_histories(
        self,
        command: Channel | None,
        reading: Channel | None,
        taken_columns: set[str],
        needed_parts: Sequence[Part],
    ) -> tuple[Channel | None, Channel | None]:
        """Complete the pair by what the columns do beside each other."""
        known_columns = {channel.column for channel in (command, reading) if channel is not None}
        candidates = [
            meaning
            for meaning in self._part_name.values()
            if meaning.column not in taken_columns | known_columns
            and self._can_be_displacement(meaning)
            and self._moves(meaning.column)
        ]
        if command is not None:
            return command, self._partner(command, Part.MEASURED, candidates)
        if reading is not None:
            if Part.COMMAND not in needed_parts:
                return None, reading
            return self._partner(reading, Part.COMMAND, candidates), reading
        if not set(needed_parts) >= set(DISPLACEMENTS):
            lengths = [meaning for meaning in candidates if meaning.quantity is Measurand.DISPLACEMENT]
            if len(lengths) > 1:
                return self._leading_pair(lengths)
            return None, self._channel(
                Part.MEASURED, lengths[0], "the only displacement"
            ) if lengths else None
        return self._leading_pair(candidates)

    def _can_be_displacement(self, meaning: Meaning) -> bool:
        """Whether unit or name say that a column is a displacement, or the format leaves both out."""
        if meaning.quantity is None:
            return not self._columns.named
        return meaning.quantity is Measurand.DISPLACEMENT and meaning.role is not ChannelRole.GROUND

    def _partner(self, channel: Channel, part: Part, candidates: Sequence[Meaning]) -> Channel | None:
        """Find the one column that moves as the one that is known."""
        similar_columns = [
            (self._compare(channel.column, meaning.column), meaning)
            for meaning in candidates
            if meaning.role is None or (meaning.weak and str(meaning.role) == str(part))
        ]
        original_columns = [item for item in similar_columns if not item[1].is_altered] or similar_columns
        close = [(likeness, meaning) for likeness, meaning in original_columns if likeness.correlation > 0.5]  # noqa: PLR2004
        if not close:
            return None
        close.sort(key=lambda item: -item[0].correlation)
        distinct = [
            meaning
            for _, meaning in close
            if meaning is close[0][1] or not self._copies(close[0][1], meaning)
        ]
        if len(distinct) > 1:
            raise self._ambiguous(part, distinct)
        likeness = close[0][0]
        return self._channel(
            part,
            close[0][1],
            f"the only displacement that moves with {channel.column!r} "
            f"(correlation {likeness.correlation:.3f})",
        )

    def _leading_pair(self, candidates: Sequence[Meaning]) -> tuple[Channel | None, Channel | None]:
        """Take the two columns that move most alike; of them the one that follows is measured."""
        pairs = [
            (self._compare(first.column, second.column), first, second)
            for place, first in enumerate(candidates)
            for second in candidates[place + 1 :]
            if first.unit is None or second.unit is None or first.unit.quantity is second.unit.quantity
        ]
        pairs = [item for item in pairs if item[0].is_pair]
        if not pairs:
            return None, None
        pairs.sort(key=lambda item: -item[0].correlation)
        likeness, first, second = pairs[0]
        names, distance = {first.column, second.column}, 1.0 - likeness.correlation
        rivals = [item for item in pairs[1:] if names & {item[1].column, item[2].column}]
        unclear = [item for item in pairs[1:2] if _CLEAR * distance > 1.0 - item[0].correlation]
        if rivals or unclear:  # two sensors of one motion are more alike than command and motion
            column_names = dict.fromkeys(
                meaning.column for item in (pairs[0], *rivals, *unclear) for meaning in item[1:]
            )
            raise self._ambiguity_error(list(column_names), "move alike")
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
        used_names = {channel.column for channel in (*pairs, *((time,) if time else ()))}
        names = [name for name in self._columns.values if name not in used_names and self._moves(name)]
        nameless = not self._columns.named and self._histories
        if not nameless or len(names) != 1 or set(motion) != set(DISPLACEMENTS):
            return []
        (name,), displacement = names, motion[Part.MEASURED]
        values, meaning = self._columns.values[name], self._part_name[name]
        if meaning.quantity is not None or values.size != displacement.size:
            return []
        share = share_explained(values, displacement)
        if (
            share < _EXPLAINED_FORCE
            or share_explained(values, motion[Part.COMMAND]) >= share
            or np.corrcoef(values, displacement)[0, 1] < _FORCE_CORRELATION
            or compare(displacement, values).is_pair
        ):
            return []
        reason = f"the only other column; the measured motion explains {100.0 * share:.4g} % of it"
        return [self._channel(Part.FORCE, meaning, reason)]

    def _best_explained_force(self, forces: Sequence[Meaning], pairs: Sequence[Channel]) -> list[Meaning]:
        """Take the force that the measured motion explains, where it explains no other as well."""
        motion = next((channel.column for channel in pairs if channel.part is Part.MEASURED), None)
        if motion is None or not self._histories:
            return list(forces)
        values = self._columns.values
        shares = [share_explained(values[meaning.column], values[motion]) for meaning in forces]
        order = np.argsort(shares)
        clear = shares[order[-1]] - shares[order[-2]] > _CLEAR_SHARE
        return [forces[int(order[-1])]] if clear else list(forces)

    def _compare(self, first: str, second: str) -> Likeness:
        if (first, second) not in self._likenesses:
            values = self._columns.values
            self._likenesses[first, second] = compare(values[first], values[second])
        return self._likenesses[first, second]

    def _copies(self, first: Meaning, second: Meaning) -> bool:
        return self._histories and self._compare(first.column, second.column).copies

    def _moves(self, column: str) -> bool:
        return moves(self._columns.values[column])

    def _ambiguous(self, part: Part, candidates: Sequence[Meaning]) -> InputError:
        those = " and ".join(repr(meaning.column) for meaning in candidates)
        return InputError(
            f"Several columns could be the {_part_name(part)}: {those}",
            remedy=f"Choose one with `{part}`" if part in DISPLACEMENTS else "State it in `channels`",
            where=self._columns.location,
        )

    def _ambiguity_error(self, names: Sequence[str], reason: str) -> InputError:
        those = " and ".join(repr(name) for name in names)
        return InputError(
            f"Which is the command, which the measured displacement? {those} {reason}",
            remedy="Say which is which with `command` and `measured`",
            where=self._columns.location,
        )

    def _missing(self, part: Part) -> InputError:
        return InputError(
            f"No column for the {_part_name(part)}",
            remedy=f"{self._suggestion(part)}. Columns in the file: {self._columns.names_text}",
            where=self._columns.location,
        )

    def _suggestion(self, part: Part) -> str:
        names = {word: name for name in self._columns.values for word in {plain(name), *words_of(name)}}
        if close := get_close_matches(str(part), names, n=1, cutoff=_SIMILAR):
            name = names[close[0]]
            return f"Did you mean {name!r}? Then rename it to {part}, or give `{part}={name}`"
        return f"Name the column {part}, or say which it is with `{part}`"


def _likeliest(ranking: Sequence[tuple[int, Meaning]]) -> list[Meaning]:
    return [meaning for place, meaning in ranking if place == ranking[0][0]]


def _part_name(part: Part) -> str:
    """Name a part in a sentence."""
    return "measured displacement" if part is Part.MEASURED else str(part)
