"""`reliab record`: any laboratory's file as one open record, or what is wrong with one."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import typer

from reliab.app.cli.demand import argument, flag, option, takes
from reliab.app.cli.options import JSON_TARGET, ReadsTests
from reliab.app.cli.output import console, say, table, write_json
from reliab.core.errors import InputError

if TYPE_CHECKING:
    from reliab.app.api.records import Record

_COLUMNS = {"channel": "left", "column": "left", "unit": "left", "factor to SI": "right", "reason": "left"}


@dataclass(frozen=True, kw_only=True)
class RecordDemand(ReadsTests):
    """Options of `reliab record`, arguments of `reliab.record`."""

    sources: list[Path] = argument("FILE...", "Files of a laboratory; with --check records.")
    out: Path | None = option("TEST.nc", "The record; of several files a folder of records.")
    csv: Path | None = option("TEST.csv", "The recognised channels as CSV, in SI units.")
    f: str | None = option("HZ", "Natural frequency, 1 or 1±0.01.")
    xi: str | None = option("RATIO", "Damping ratio, 0.02.")
    alpha: str | None = option("SHARE", "Share of the structure's stiffness in the laboratory.")
    mass: str | None = option("KG", "Mass of the structure.")
    specimen: str = option("TEXT", "Specimen that was tested.", default="")
    rig: str = option("TEXT", "Rig of the test.", default="")
    operator: str = option("TEXT", "By whom.", default="")
    date: str = option("DATE", "When.", default="")
    attribute: list[str] | None = option("NAME=TEXT...", "Further attributes of the record.")
    check: bool = flag("Check records; exit with code 1 unless all are valid.")
    json_target: str | None = JSON_TARGET

    belongs_to: ClassVar[Mapping[str, str]] = {}


@takes(RecordDemand)
def record(demand: RecordDemand) -> None:
    """Recognise the channels of a laboratory's file, and keep them as one open record."""
    if demand.check:
        _check(demand)
        return
    if demand.csv is not None and len(demand.sources) > 1:
        raise InputError(
            "A CSV file holds one test only", value=f"{len(demand.sources)} files", remedy="Name one file"
        )
    _require_own_names(demand)
    records = [_record(source, demand) for source in demand.sources]
    contents = [record.to_dict() for record in records]
    if not write_json(contents[0] if len(contents) == 1 else contents, demand.json_target):
        for answer in records:
            _show(answer)


def _require_own_names(demand: RecordDemand) -> None:
    """Refuse files of which one would be written over the record of another."""
    stems = [source.stem for source in demand.sources]
    twice = next((stem for stem in stems if stems.count(stem) > 1), None)
    if demand.out is not None and twice is not None:
        raise InputError(
            "Files that are kept in one folder must have different names",
            value=f"{stems.count(twice)} files {twice}",
            remedy="Rename them, or name another `out` for each",
        )


def _record(source: Path, demand: RecordDemand) -> "Record":
    from reliab.app.api.records import record as api_record

    out = demand.out
    if out is not None and len(demand.sources) > 1:
        out.mkdir(parents=True, exist_ok=True)
        out = out / f"{source.stem}.nc"
    return demand.ask(
        api_record,
        *("sources", "attribute", "json_target"),
        source=source,
        out=out,
        attributes=dict(map(_attribute, demand.attribute or [])),
    )


def _attribute(text: str) -> tuple[str, str]:
    name, sign, value = text.partition("=")
    if not sign or not name.isidentifier():
        raise InputError(
            "An attribute must be written as NAME=TEXT", value=text, remedy="Write specimen_grade=S355"
        )
    return name, value


def _check(demand: RecordDemand) -> None:
    from reliab.app.api.records import check_records

    demand.refuse_all_but(("sources", "check", "json_target"), "together with `check`")
    faults = check_records(demand.sources)
    if not write_json(faults, demand.json_target):
        for file, sentences in faults.items():
            console().print(
                f"{file}: {'a valid record' if not sentences else 'not a valid record'}", markup=False
            )
            say(*(f"  {sentence}" for sentence in sentences))
    if any(faults.values()):
        raise typer.Exit(1)


def _show(record: "Record") -> None:
    """Print what was recognised, and where it was written."""
    content, screen = record.to_dict(), console()
    rows = table(
        f"{content['source']}: {content['samples']:,} samples at {content['rate_hz']:.6g} Hz", _COLUMNS
    )
    for channel in content["recording"]["channels"]:
        rows.add_row(
            channel["channel"],
            channel["column"],
            channel["unit"],
            f"{channel['factor']:.6g}",
            channel["reason"],
        )
    screen.print(rows)
    if content["left"]:
        say(f"Not used: {', '.join(content['left'])}.")
    say(*(f"Note: {note}" for note in content["notes"]))
    say(*(f"Written: {path}" for path in content["files"]))
