"""The catalogue of a suite, ``catalog.csv`` beside its records: read, and written with them.

Columns: ``motion`` (unique name) and ``file`` (path from the catalogue, in its folder); optionally ``event``
(the earthquake, so that its components stay together), ``set``, ``dt_s`` (the true step [s], which replaces
a rounded step in a header), ``units`` (g, cm/s2 or m/s2) and ``channel`` (of a file with several, from 1).
Columns ``header_npts`` and ``header_dt_s`` hold the number of samples and the step that the file's header
should state; they are compared with the header. Further columns are ignored.
"""

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeVar

from reliab.core.encodings import as_cell, printable, restore_cell
from reliab.core.errors import InputError
from reliab.core.files import folder_written_whole, refuse_unwritable
from reliab.core.text_tables import parse_number
from reliab.core.units import AccelerationUnit, find_unit
from reliab.motions.faults import Report
from reliab.motions.motion import Motion
from reliab.motions.readers.reading import AccelerationReading, RecordDeclaration, complete
from reliab.motions.readers.registry import open_records
from reliab.motions.readers.source import RecordHeader, is_file, open_source
from reliab.motions.suite import MotionSuite


@dataclass(frozen=True, kw_only=True)
class RecordFile:
    """An entry of a suite whose record is read from a file."""

    path: Path  # The file
    name: str  # Name of the motion
    event: str = ""  # The earthquake; if empty, it is taken from the header, or else from the name
    set_name: str = ""  # Set of the catalogue
    channel: int | None = None  # Which record of a file that holds several, counted from 1
    # Step and units that a catalogue or a caller gives for the record
    declared: RecordDeclaration = field(default_factory=RecordDeclaration)

    def load(self) -> Motion:
        """Read the motion."""
        report = Report(file=str(self.path))
        reading = report.require(self.read(report))
        return Motion(
            name=self.name,
            acceleration=reading.acceleration,
            time_step=reading.time_step,
            event=self.event or reading.event,
            set_name=self.set_name,
        )

    def read(self, report: Report) -> AccelerationReading | None:
        """Read the record and report every fault of it."""
        source_and_headers = open_records(self.path, report)
        if source_and_headers is None:
            return None
        source, headers = source_and_headers
        header = self._choose(headers, report)
        return None if header is None else complete(source, header, self.declared, report)

    def _choose(self, headers: list[RecordHeader], report: Report) -> RecordHeader | None:
        if self.channel is None and len(headers) > 1:
            labels = ", ".join(f"{n} ({header.channel})" for n, header in enumerate(headers, start=1))
            report.add(
                "The file holds several channels",
                value=f"channels {labels}",
                remedy="Choose a channel, or load the file as a suite",
            )
        elif self.channel is not None and not 1 <= self.channel <= len(headers) and headers:
            report.add(
                "No such channel in the file",
                value=f"channel {self.channel} of {len(headers)}",
                remedy="Count the channels of the file from 1",
            )
        elif headers:
            return headers[(self.channel or 1) - 1]
        return None


T = TypeVar("T")

CATALOGUE = "catalog.csv"
"""Name of a catalogue in its folder."""

COLUMNS = ("motion", "event", "set", "file", "dt_s", "units")
"""Columns that a written catalogue has."""

_REQUIRED_COLUMNS = ("motion", "file")


def read_catalogue(path: Path, report: Report, defaults: RecordDeclaration) -> list[RecordFile]:
    """Read a catalogue."""
    source = open_source(path, report) if report.resolve(path.parent, path.name) else None
    if source is None:
        return []
    rows = csv.reader(line.text for line in source.lines())
    filled_rows = _rows_with_cells(rows, report)
    columns = [name.strip().lower() for name in next(filled_rows, [])]
    missing = [name for name in _REQUIRED_COLUMNS if name not in columns]
    if missing:
        report.add(
            f"No column {' and '.join(missing)} in the catalogue",
            line=1,
            remedy="Name the columns in the first line: motion, file, and what else you know",
        )
        return []
    records: list[RecordFile] = []
    lines_by_name: dict[str, int] = {}
    for cells in filled_rows:
        line = rows.line_num
        row = dict(zip(columns, (restore_cell(cell.strip()) for cell in cells), strict=False))
        if _has_name(row, lines_by_name, line, report):
            records.extend(_record(path, row, line, defaults, report))
    if not lines_by_name and not report.faults:
        report.add(
            "The catalogue has no rows",
            line=1,
            remedy="Add a row for each record",
        )
    return records


def _rows_with_cells(rows: Iterator[list[str]], report: Report) -> Iterator[list[str]]:
    try:
        yield from (cells for cells in rows if any(restore_cell(cell.strip()) for cell in cells))
    except csv.Error as error:
        report.add("The catalogue is no comma-separated text", value=error, remedy="Save it as CSV")


def _has_name(row: dict[str, str], lines_by_name: dict[str, int], line: int, report: Report) -> bool:
    for column in _REQUIRED_COLUMNS:
        if not row.get(column):
            report.add(f"The column {column} is empty", line=line, remedy="Fill it in, or remove the row")
            return False
    name = row["motion"]
    if name in lines_by_name:
        report.add(
            "Two motions have the same name",
            line=line,
            value=f"{name}, as in line {lines_by_name[name]}",
            remedy="Rename one of them",
        )
        return False
    lines_by_name[name] = line
    return True


def _record(
    path: Path, row: dict[str, str], line: int, defaults: RecordDeclaration, report: Report
) -> Iterator[RecordFile]:
    """Yield the record of a row, unless the row has a fault."""
    faults_before = len(report.faults)
    file = report.resolve(path.parent, row["file"].replace("\\", "/"), line=line)
    if file is None:
        return
    if not is_file(file):
        report.add(
            f"{row['file']} not found",
            line=line,
            remedy="Correct the path, which is relative to the catalogue, or remove the row",
        )
    declaration = RecordDeclaration(
        time_step=_one_of(
            _positive(row, "dt_s", line, report), defaults.time_step, "time steps", line, report
        ),
        units=_one_of(_units(row, line, report), defaults.units, "units", line, report),
        header_count=_integer_cell(row, "header_npts", line, report),
        header_time_step=_positive(row, "header_dt_s", line, report),
        location=f"{path.name}, line {line}",
    )
    channel = _integer_cell(row, "channel", line, report)
    if len(report.faults) == faults_before:
        yield RecordFile(
            path=file,
            name=row["motion"],
            event=row.get("event", "") or row["motion"],
            set_name=row.get("set", ""),
            channel=channel,
            declared=declaration,
        )


def _one_of(row_value: T | None, default: T | None, description: str, line: int, report: Report) -> T | None:
    """Return the value from the catalogue or from the caller; the two must not differ."""
    if row_value is not None and default is not None and row_value != default:
        report.add(
            f"The catalogue states other {description} than you",
            line=line,
            value=f"{row_value} in the catalogue, {default} from you",
            remedy="Leave yours out, or correct the catalogue",
        )
    return default if row_value is None else row_value


def _positive(row: dict[str, str], column: str, line: int, report: Report) -> float | None:
    text = row.get(column, "")
    value = parse_number(text) if text else None
    if text and (value is None or not 0 < value < float("inf")):
        report.add(f"Not a positive number in the column {column}", line=line, value=text)
        return None
    return value


def _integer_cell(row: dict[str, str], column: str, line: int, report: Report) -> int | None:
    value = _positive(row, column, line, report)
    if value is not None and not (0 < value < 1e9 and value.is_integer()):  # noqa: PLR2004 - no record has more
        report.add(f"Not a whole number in the column {column}", line=line, value=row[column])
        return None
    return None if value is None else int(value)


def _units(row: dict[str, str], line: int, report: Report) -> AccelerationUnit | None:
    text = row.get("units", "")
    unit = find_unit(text) if text else None
    if text and unit is None:
        report.add("Unknown unit of acceleration", line=line, value=text, remedy="Write g, cm/s2 or m/s2")
    return unit


_UNSAFE = re.compile(r"[^A-Za-z0-9._+-]+")
_DEVICE = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$)", re.IGNORECASE)  # what Windows takes for one
_LONGEST_NAME = 100  # of a file or folder, of which most systems allow 255


def write_suite(suite: MotionSuite, folder: str | Path, *, event: str | None = None) -> Path:
    """Write every motion of a suite as text, and a catalogue.

    The samples are in m/s² with as many digits as they need to be read back unchanged, one in a line, after a
    header with units, time step, number of samples and event.

    `suite`: the motions; they are read and written one at a time; `folder`: where to write; it must not
    exist, or be empty; `event`: the earthquake of all motions, instead of their own.
    """
    target = Path(folder)
    if not len(suite):
        raise InputError("The suite has no motions to write", remedy="Choose motions that are in the suite")
    if target.exists() and (not target.is_dir() or any(target.iterdir())):
        raise InputError(
            "The folder is not empty",
            value=str(folder),
            remedy="Name another folder, or empty this one",
        )
    rule = "Cannot write to the folder"
    with refuse_unwritable(rule, where=target), folder_written_whole(target) as partial_folder:
        _write_all(suite, partial_folder, event)
    return target / CATALOGUE


def _write_all(suite: MotionSuite, folder: Path, event: str | None) -> None:
    with (folder / CATALOGUE).open("w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(COLUMNS)
        for original, file in zip(suite, _files(suite), strict=True):
            motion = original if event is None else replace(original, event=event)
            write_motion(motion, folder / file)
            labels = (as_cell(_one_line(text)) for text in (motion.name, motion.event, motion.set_name))
            rows.writerow([*labels, file, repr(motion.time_step), AccelerationUnit.METRE.value])


def write_motion(motion: Motion, path: Path) -> None:
    """Write one motion as text in one column."""
    header = (
        f"# motion: {_one_line(motion.name)}\n"
        f"# event: {_one_line(motion.event)}\n"
        f"# units: {AccelerationUnit.METRE}\n"
        f"# time_step: {motion.time_step!r}\n"
        f"# samples: {motion.acceleration.size}\n"
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    samples = "\n".join(map(repr, motion.acceleration.tolist()))
    path.write_text(f"{header}{samples}\n", encoding="utf-8", newline="\n")


def _files(suite: MotionSuite) -> Iterator[str]:
    """Name of a file for each motion, unique even where capitals do not count."""
    file_names: set[str] = set()
    for name, set_name in zip(suite.names, suite.set_names, strict=True):
        stem = _as_file(name) or "motion"
        folder = f"{_as_file(set_name) or 'motions'}/"
        file, number = f"{folder}{stem}.txt", 2
        while file.lower() in file_names:
            file, number = f"{folder}{stem}_{number}.txt", number + 1
        file_names.add(file.lower())
        yield file


def _as_file(name: str) -> str:
    file = _UNSAFE.sub("_", name)[:_LONGEST_NAME].strip(".").lstrip("+-")
    return f"_{file}" if _DEVICE.match(file) else file


def _one_line(text: str) -> str:
    """Write a label in one line of text, with what is no text as Python writes it."""
    return printable(" ".join(text.split()))
