"""Pairs of command and measured displacement of several actuators, by the numbers in their names."""

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from reliab.recordings.channel import DISPLACEMENTS, Part
from reliab.recordings.readers import Columns

_NAMED_SO: Final = re.compile(
    r"^(command|measured)[ _]?([A-Za-z0-9]+?)(?:[ _]\(?(rad|mrad|deg|mm|cm|m|in)\)?)?$"
)


def with_numbered_pairs(columns: Columns) -> Columns:
    """Take columns command_1, measured_1, command_2, … as those of actuators where there are several."""
    matches = {name: match for name in columns.values if (match := _NAMED_SO.match(name))}
    parts = {name: (match[1], match[2]) for name, match in matches.items()}
    if len(set(parts.values())) == len(parts) > len(DISPLACEMENTS):
        return replace(columns, parts={**columns.parts, **parts})
    return columns


def numbers_of_pairs(channels: Iterable[tuple[Part, str]]) -> tuple[str, ...]:
    """Numbers of actuators with both channels, in their order."""
    every = set(channels)
    numbers = {number for part, number in every if all((one, number) in every for one in DISPLACEMENTS)}
    return tuple(sorted(numbers, key=lambda number: (len(number), number)))
