"""Results as plain values and rows, in JSON, tables and HTML."""

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum
from importlib import import_module
from inspect import isabstract
from pathlib import Path
from pkgutil import walk_packages
from typing import ClassVar

import numpy as np
import pandas as pd
import pytest

from reliab.app import api
from reliab.app.api.assessment import write_tests
from reliab.core.plain_values import Keys, PlainResult, read_table, write_table
from reliab.core.stated_value import StatedValue


class Side(StrEnum):
    LEAD = "lead"


@dataclass(frozen=True, kw_only=True)
class Part(PlainResult):
    sizes: tuple[float, ...]
    side: Side = Side.LEAD


@dataclass(frozen=True, kw_only=True)
class Nest(PlainResult):
    keys: ClassVar[Keys] = {
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


def test_a_result_writes_its_named_values():
    complete = Nest(
        parts=(Part(sizes=(1.0, 2.0)),),
        by_name={Side.LEAD: StatedValue(value=3.0, deviation=0.5)},
        delay=np.float64(0.0025),
    )
    assert json.loads(json.dumps(complete.to_dict())) == {
        "delay_ms": 2.5,
        "first_side": "lead",
        "parts": [{"sizes": [1.0, 2.0], "side": "lead"}],
        "by_name": {"lead": {"value": 3.0, "sd": 0.5}},
    }
    assert type(complete.to_dict()["first_side"]) is str


def test_a_key_without_a_value_is_an_error():
    @dataclass(frozen=True)
    class Wrong(PlainResult):
        keys: ClassVar[Keys] = {"size": "absent"}

    with pytest.raises(AttributeError, match="absent"):
        Wrong().to_dict()


@dataclass(frozen=True, kw_only=True)
class Whole(PlainResult):
    keys: ClassVar[Keys] = {
        "d_ms": "delay",
        "late_ms": "late_ms",
        "both": {"a": "first.delay", "b?": "note"},
        "later": ("second", {"d_ms": "delay"}),
        "each": ("parts", {"first": "sizes.0"}),
        "shown": {"?": "second", "d_ms": "delay"},
        "sides": "parts.{side}",
        "**": "more",
        "missing?": "note",
    }

    delay: float = 0.002
    late_ms: float = 3.0
    note: str = ""
    second: "Whole | None" = None
    parts: tuple[Part, ...] = (Part(sizes=(1.0, float("nan"))),)
    more: Mapping[str, float] = field(default_factory=lambda: {"extra": float("inf")})

    @property
    def first(self) -> "Whole | None":
        return self.second


def test_sources_reach_into_parts():
    assert Whole().to_dict() == {
        "d_ms": 2.0,
        "late_ms": 3.0,
        "both": {"a": None},
        "later": None,
        "each": [{"first": 1.0}],
        "shown": None,
        "sides": {"lead": {"sizes": [1.0, None], "side": "lead"}},
        "extra": None,
    }
    nested = Whole(second=Whole(delay=0.5), note="late").to_dict()
    assert (nested["both"], nested["later"], nested["shown"], nested["missing"]) == (
        {"a": 0.5, "b": "late"},
        {"d_ms": 500.0},
        {"d_ms": 2.0},
        "late",
    )


def _leading_names(keys: Keys) -> Iterator[str]:
    for source in keys.values():
        match source:
            case str() as path:
                yield path.partition(".")[0]
            case (str() as path, _):
                yield path.partition(".")[0]
            case _:
                yield from _leading_names(source)


def _results(base: type = PlainResult) -> Iterator[type[PlainResult]]:
    for result in base.__subclasses__():
        yield result
        yield from _results(result)


def test_every_key_has_a_source():
    for module in walk_packages(api.__path__, "reliab.app.api."):
        import_module(module.name)
    unknown = [
        (result.__name__, name)
        for result in _results()
        if result.__module__.startswith("reliab.") and not isabstract(result)
        for name in _leading_names(result.keys)
        if not hasattr(result, name) and name not in {field.name for field in fields(result)}
    ]
    assert unknown == []


@dataclass(frozen=True)
class Fault:
    rule: str
    line: int | None


@dataclass(frozen=True)
class FileResult(PlainResult):
    keys: ClassVar[Mapping[str, str]] = {"folder": "place", "low": "interval.low", "faults": "faults"}

    place: Path
    interval: Mapping[str, float]
    faults: tuple[Fault, ...]


def test_paths_parts_of_mappings_and_plain_dataclasses_are_written():
    text = FileResult(Path("a/b"), {"low": 0.5}, (Fault("No rate.", None),))
    assert json.loads(json.dumps(text.to_dict())) == {
        "folder": "a/b",
        "low": 0.5,
        "faults": [{"rule": "No rate.", "line": None}],
    }


FORMULA = '=HYPERLINK("http://x")'


def cells(path):
    with path.open(encoding="utf-8") as table:
        return [cell for row in csv.reader(table) for cell in row]


def is_harmless(cell):
    return not cell.strip().startswith(("=", "+", "-", "@")) or cell.lstrip("+-")[:1].isdigit()


@pytest.mark.parametrize("index", [True, False])
def test_a_table_is_read_as_it_was_written_and_holds_no_formula(tmp_path, index):
    table = pd.DataFrame({"=name": [FORMULA, "+1"], "number": [-0.5, 2.0], "whole": [-1, 2]})
    write_table(table, tmp_path / "table.csv", index=index)
    assert all(map(is_harmless, cells(tmp_path / "table.csv")))
    read = read_table(tmp_path / "table.csv")[list(table)]
    assert read["=name"].map(str).tolist() == [FORMULA, "+1"]
    assert read["number"].tolist() == [-0.5, 2.0]


def test_every_text_of_a_verdict_is_escaped(tmp_path):
    texts = dict.fromkeys(("file", "test", "verdict", "metric", "fault"), FORMULA)
    write_tests([{**texts, "reasons": [FORMULA], "warnings": [FORMULA]}], tmp_path / "verdicts.csv")
    assert all(map(is_harmless, cells(tmp_path / "verdicts.csv")))
