"""Results write their fields, or what they name, as plain values."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from reliab.core.plain_values import PlainResult
from reliab.core.stated_value import StatedValue


class Side(StrEnum):
    LEAD = "lead"


@dataclass(frozen=True, kw_only=True)
class Part(PlainResult):
    sizes: tuple[float, ...]
    side: Side = Side.LEAD


@dataclass(frozen=True, kw_only=True)
class Whole(PlainResult):
    keys: ClassVar[Mapping[str, str]] = {
        "delay_ms": "delay",
        "first_side": "first.side",
        "parts": "parts",
        "by_name": "by_name",
    }

    parts: tuple[Part, ...]
    by_name: dict[Side, StatedValue]
    delay: np.float64
    hidden: object = None

    @property
    def first(self) -> Part:
        return self.parts[0]


def test_a_result_writes_the_values_that_it_names():
    whole = Whole(
        parts=(Part(sizes=(1.0, 2.0)),),
        by_name={Side.LEAD: StatedValue(value=3.0, deviation=0.5)},
        delay=np.float64(2.5),
    )
    assert json.loads(json.dumps(whole.to_dict())) == {
        "delay_ms": 2.5,
        "first_side": "lead",
        "parts": [{"sizes": [1.0, 2.0], "side": "lead"}],
        "by_name": {"lead": {"value": 3.0, "sd": 0.5}},
    }
    assert type(whole.to_dict()["first_side"]) is str


def test_a_key_without_a_value_is_an_error():
    @dataclass(frozen=True)
    class Wrong(PlainResult):
        keys: ClassVar[Mapping[str, str]] = {"size": "absent"}

    with pytest.raises(AttributeError, match="absent"):
        Wrong().to_dict()


@dataclass(frozen=True)
class Fault:
    rule: str
    line: int | None


@dataclass(frozen=True)
class Written(PlainResult):
    keys: ClassVar[Mapping[str, str]] = {"folder": "place", "low": "interval.low", "faults": "faults"}

    place: Path
    interval: Mapping[str, float]
    faults: tuple[Fault, ...]


def test_paths_parts_of_mappings_and_plain_dataclasses_are_written():
    written = Written(Path("a/b"), {"low": 0.5}, (Fault("No rate.", None),))
    assert json.loads(json.dumps(written.to_dict())) == {
        "folder": "a/b",
        "low": 0.5,
        "faults": [{"rule": "No rate.", "line": None}],
    }
