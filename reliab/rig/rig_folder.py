"""The folder of a rig: `records/SHA.nc` and `tests/SHA.json` for each test, and a table made from them.

No server and no lock: a test is in the folder as soon as its JSON has its name, which a file system gives at
once or not at all. Several writers therefore never touch one another's tests, and a killed one leaves at
most a record without its JSON, which the next `add` of that file replaces. `table.csv` is a copy of what the
JSON files say, for speed; whoever finds it older than they are makes it again.
"""

import contextlib
import csv
import io
import math
import os
import re
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.core.arrays import Array
from reliab.core.described_files import read_json
from reliab.core.encodings import as_cell, restore_cell
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, write_json_file, written_whole
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.rig.watching import drift_chart
from reliab.tracking.boundary.first_order import ellipse_of_response

if TYPE_CHECKING:
    import xarray as xr


SCHEMA: Final = "reliab rig test 1"
"""Value of `schema` in the JSON of a test."""


@dataclass(frozen=True, kw_only=True)
class RigTest(PlainResult):
    """One test of a rig; delays in milliseconds, displacements in millimetres."""

    sha256: str  # Of the laboratory's file, and of the test's name where the file holds several
    name: str
    file: str
    added: str  # When it came into the folder, in ISO 8601 and UTC
    date: str = ""  # When it was performed
    event: str = ""  # Earthquake of its ground motion
    specimen: str = ""
    note: str = ""
    structure: str = ""  # Name of the frame; empty for a structure of one mass
    f: float | None = None
    xi: float | None = None
    alpha: float | None = None
    threshold: float
    verdict: str
    reliable: bool
    probability: float
    A: float
    d_ms: float
    f_eq_hz: float
    remainder: float  # RMS of what gain and delay leave of the measured displacement, over its own RMS
    rms: float | None = None  # None where it is infinite
    rms_low: float | None = None
    rms_high: float | None = None
    mte: float | None = None
    peak_mm: float
    velocity_mm_s: float
    own_a: float | None = None  # a over the squared error by the test's own response
    own_b_ms2: float | None = None
    duration_s: float
    covariates: Mapping[str, float] = field(default_factory=dict)

    @property
    def moment(self) -> str:
        """What tests are ordered by: the date where it is stated, else when the test was added."""
        return self.date or self.added


COLUMNS: Final = tuple(item.name for item in fields(RigTest) if item.name != "covariates")
"""Columns of the table of a rig that every test has."""

TEXTS: Final = frozenset(
    ("sha256", "name", "file", "added", "date", "event", "specimen", "note", "structure", "verdict")
)
"""Columns that hold texts."""


def require_date(text: str) -> str:
    """Return a date or a time in ISO 8601 as it sorts.

    >>> require_date("2026-03-01"), require_date("2026-03-01 14:30")
    ('2026-03-01T00:00:00', '2026-03-01T14:30:00')
    """
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise InputError(
            "`date` is neither a day nor a time",
            value=repr(text),
            remedy="Write 2026-03-01 or 2026-03-01T14:30",
        ) from None
    return moment.replace(tzinfo=None).isoformat(timespec="seconds")


_STEEPEST = 0.999  # quantile of the speeds, beyond which there is the noise of the command


def describe_test(
    assessment: Assessment | FrameAssessment, texts: Mapping[str, str], covariates: Mapping[str, float]
) -> RigTest:
    """Take from an assessment what a rig's table holds; `texts` are its names and labels."""
    if assessment.tracking is None:
        raise InputError(
            "A rig keeps tests of one actuator",
            value=f"{len(assessment.error.displacements)}",
            remedy="Judge this one with `reliab assess`",
            where=assessment.recording.name,
        )
    content = assessment.to_dict()
    errors = content["error"]
    own_a, own_b = _own_ellipse(assessment)
    peak, velocity = _peaks_of(assessment.recording)
    return RigTest(
        **texts,
        f=content.get("f"),
        xi=content.get("xi"),
        alpha=content.get("alpha"),
        structure=str(content.get("structure", "")),
        threshold=content["threshold"],
        verdict=content["verdict"],
        reliable=content["reliable"],
        probability=content["probability"],
        A=content["A"],
        d_ms=content["d_ms"],
        f_eq_hz=content["f_eq_hz"],
        remainder=assessment.tracking.noise_share,
        rms=errors["rms"]["value"],
        rms_low=errors["rms"]["low"],
        rms_high=errors["rms"]["high"],
        mte=errors["mte"]["value"],
        peak_mm=peak,
        velocity_mm_s=velocity,
        own_a=own_a,
        own_b_ms2=own_b,
        duration_s=assessment.recording.duration,
        covariates=covariates,
    )


def _peaks_of(recording: Recording) -> tuple[float, float]:
    """Peak displacement [mm] and speed [mm/s] of the command."""
    command = recording.command - recording.command.mean()
    speed = np.abs(np.gradient(command, recording.time_step))
    return MILLI * float(np.abs(command).max()), MILLI * float(np.quantile(speed, _STEEPEST))


def _own_ellipse(assessment: Assessment | FrameAssessment) -> tuple[float | None, float | None]:
    """How much gain and delay weigh in the response of this very test; unknown for frames."""
    if not isinstance(assessment, Assessment):
        return None, None
    error = assessment.error
    ellipse = ellipse_of_response(error.reference, error.rebuilt.time_step, assessment.structure)
    if not all(math.isfinite(value) and value > 0.0 for value in (ellipse.amplitude, ellipse.delay)):
        return None, None
    return ellipse.amplitude, ellipse.delay


STATE: Final = "file_state"
"""Column of the CSV: time [ns] and size of a test's JSON when it was read, and a checksum of the row."""

CHANGE: Final = "change"
"""Column that says what was noticed to have changed with a test, computed from those before it."""

_TRUTHS: Final = {"True": True, "False": False}
_NOT_MODELLED: Final = frozenset((*COLUMNS, STATE, CHANGE, "day"))
_FORM: Final = b"rig table 3"
"""Goes into the checksums of rows; another one where flags of changes are computed in another way."""


@dataclass(frozen=True, kw_only=True)
class RigTable:
    """Tests in the order of their dates, one row each."""

    rows: Sequence[Mapping[str, Any]]
    faults: Mapping[str, str]  # Why tests are left out, by file

    def __len__(self) -> int:
        """Count the tests."""
        return len(self.rows)

    @property
    def covariate_names(self) -> list[str]:
        """Quantities that users named, in alphabetical order."""
        return sorted(set().union(*self.rows) - _NOT_MODELLED)

    @property
    def columns(self) -> list[str]:
        """All columns."""
        return [*COLUMNS, *self.covariate_names, CHANGE]

    @property
    def whole_rows(self) -> list[dict[str, Any]]:
        """Rows with all columns, None where a test has no value."""
        columns = self.columns
        return [{name: row.get(name) for name in columns} for row in self.rows]

    def numbers(self, name: str) -> Array:
        """Return a column as numbers, NaN where a test has none."""
        values = (row.get(name) for row in self.rows)
        return np.array([np.nan if value in (None, "") else float(value) for value in values])

    def texts(self, name: str) -> list[str]:
        """Return a column as texts."""
        return [str(row.get(name) or "") for row in self.rows]

    @property
    def moments(self) -> list[str]:
        """What the tests are ordered by."""
        return [moment_of(row) for row in self.rows]

    @property
    def has_dates(self) -> bool:
        """Whether a date is stated for every test, so that their order means something."""
        return bool(self.rows) and all(row.get("date") for row in self.rows)

    def only(self, places: Iterable[int]) -> "RigTable":
        """Keep tests by their places."""
        return RigTable(rows=[self.rows[place] for place in places], faults={})

    def to_csv(self) -> str:
        """Write the table as text, with formulas of spreadsheets disarmed."""
        return _as_csv(self.rows, self.columns)


def sort_table(rows: Iterable[Mapping[str, Any]], faults: Mapping[str, str] | None = None) -> RigTable:
    """Put rows into the order of their dates."""
    rows_in_order = sorted(rows, key=lambda row: (moment_of(row), str(row["added"]), str(row["name"])))
    return RigTable(rows=rows_in_order, faults=faults or {})


def moment_of(row: Mapping[str, Any]) -> str:
    """Date of a test, else when it was added."""
    return str(row.get("date") or row["added"])


def row_of(test: Mapping[str, Any], sha256: str) -> dict[str, Any]:
    """Flatten the JSON of a test; TypeError or KeyError where it holds something else."""
    row = {**{name: test[name] for name in COLUMNS}, **test["covariates"]}
    for name, value in row.items():
        kinds = (str,) if name in TEXTS else (bool,) if name == "reliable" else (int, float, type(None))
        if not isinstance(value, kinds):
            raise TypeError(f"{name} is {value!r}")
    if row["sha256"] != sha256:
        raise TypeError("the checksum is not that of the file's name")
    return row


def write_cache(rows: Sequence[Mapping[str, Any]]) -> str:
    """Write rows for the next reader."""
    extra_columns = sorted(set().union(*rows) - {*COLUMNS, STATE, CHANGE})
    names = [STATE, *COLUMNS, *extra_columns, CHANGE]
    header = _header_check(names)
    rows_to_write = []
    for row in rows:
        cells = [_cell(row.get(name)) for name in names[1:]]
        rows_to_write.append({**row, STATE: f"{row[STATE]}-{_check(cells, header)}"})
    return _as_csv(rows_to_write, names)


def read_cache(text: str) -> dict[str, dict[str, Any]]:
    """Read what :func:`write_cache` wrote, by checksum of the test, without rows changed since.

    ValueError, KeyError or csv.Error where the text is damaged.
    """
    lines = (list(map(restore_cell, cells)) for cells in csv.reader(io.StringIO(text, newline="")))
    names = next(lines, [])
    if names[:1] != [STATE]:
        raise ValueError("another table")
    header = _header_check(names)
    columns = [(name, _reader(name), name in {*COLUMNS, CHANGE}) for name in names[1:]]
    rows: dict[str, dict[str, Any]] = {}
    for state, *cells in lines:
        stamp, _, check = state.rpartition("-")
        if check != _check(cells, header):
            continue
        row: dict[str, Any] = {STATE: stamp}
        for (name, read, always), cell in zip(columns, cells, strict=True):
            if cell or always:
                row[name] = read(cell)
        rows[row["sha256"]] = row
    return rows


def _header_check(names: Sequence[str]) -> int:
    return zlib.crc32(_cell_key(names), zlib.crc32(_FORM))


def _check(cells: Sequence[str], header: int) -> str:
    return f"{zlib.crc32(_cell_key(cells), header):08x}"


def _cell_key(cells: Sequence[str]) -> bytes:
    return "\x1f".join(cells).encode("utf-8", "backslashreplace")


def _cell(value: object) -> str:
    return "" if value is None else str(value)


def _reader(name: str) -> Callable[[str], object]:
    """Return what makes a value of a column of its cell."""
    if name in TEXTS or name == CHANGE:
        return str
    return _TRUTHS.__getitem__ if name == "reliable" else lambda cell: float(cell) if cell else None


def _as_csv(rows: Iterable[Mapping[str, Any]], columns: Sequence[str]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(as_cell, columns))
    for row in rows:
        values = (row.get(name) for name in columns)
        cells = ("" if value is None else value for value in values)
        writer.writerow([as_cell(cell) if isinstance(cell, str) else cell for cell in cells])
    return text.getvalue()


_TESTS, _RECORDS, _TABLE = "tests", "records", "table.csv"
_CHECKSUM: Final = re.compile(r"[0-9a-f]{64}")
_SHORTEST = 4  # digits of a checksum that name a test
_RULE, _REMEDY = (
    "This file of the rig is damaged",
    "Add the test again, from its record or its file",
)


@dataclass(frozen=True)
class RigFolder:
    """A rig's folder."""

    path: Path

    @classmethod
    def open(cls, path: str | Path) -> "RigFolder":
        """Open a folder that is there."""
        folder = cls(Path(path))
        if not (folder.path / _TESTS).is_dir():
            raise InputError(
                "This folder is no rig" if folder.path.is_dir() else "No such folder",
                remedy="Add tests to it with `reliab rig add`",
                where=str(path),
            )
        return folder

    def record_path(self, sha256: str) -> Path:
        """Where the record of a test lies."""
        return self.path / _RECORDS / f"{sha256}.nc"

    def _test_path(self, sha256: str) -> Path:
        return self.path / _TESTS / f"{sha256}.json"

    def holds(self, sha256: str) -> bool:
        """Whether a test is there."""
        return self._test_path(sha256).is_file()

    def add(
        self, test: RigTest, record: "xr.Dataset", assessment: Mapping[str, Any], terms: Mapping[str, str]
    ) -> None:
        """Keep a test: first its record, then its JSON, with which it is there.

        `terms` is what was stated when it was assessed.
        """
        from reliab.recordings.record import write_record

        with refuse_unwritable("Cannot write to the folder of a rig", where=self.path):
            for name in (_RECORDS, _TESTS):
                (self.path / name).mkdir(parents=True, exist_ok=True)
            write_record(record, self.record_path(test.sha256))
        content = {
            "schema": SCHEMA,
            "test": test.to_dict(),
            "terms": dict(terms),
            "assessment": dict(assessment),
        }
        write_json_file(content, self._test_path(test.sha256))

    def read(self, sha256: str) -> dict[str, Any]:
        """Read the JSON of a test."""
        path = self._test_path(sha256)
        content = read_json(path, rule=_RULE, remedy=_REMEDY)
        if not isinstance(content, dict) or content.get("schema") != SCHEMA:
            raise InputError(_RULE, value="another content", remedy=_REMEDY, where=str(path))
        return content

    def remove(self, sha256: str) -> None:
        """Remove a test: its JSON first, so that no test is ever there without its record."""
        with refuse_unwritable("Cannot write to the folder of a rig", where=self.path):
            self._test_path(sha256).unlink(missing_ok=True)
            self.record_path(sha256).unlink(missing_ok=True)

    def find(self, name: str, table: RigTable | None = None) -> dict[str, Any]:
        """Find the row of a test by its name, or by the first digits of its checksum; in `table`, if read."""
        rows = [
            row
            for row in (table or self.table()).rows
            if name == row["name"] or (len(name) >= _SHORTEST and str(row["sha256"]).startswith(name))
        ]
        if len(rows) == 1:
            return dict(rows[0])
        raise InputError(
            f"{'Several tests' if rows else 'No test'} of the name or checksum {name!r}",
            remedy="Take a checksum that `reliab rig list` shows",
            where=str(self.path),
        )

    def table(self) -> RigTable:
        """Read the table; make it again where tests came, went or changed since it was written.

        Files that say what they said, with other times, as in a copy of the folder, are no change.
        """
        rows, faults = self._read_cache(), {}
        current: dict[str, dict[str, Any]] = {}
        for sha, state in self._file_states().items():
            cached_row = rows.get(sha, {})
            if cached_row.get(STATE) == state:
                current[sha] = cached_row
                continue
            try:
                row = row_of(self.read(sha)["test"], sha)
            except (InputError, KeyError, TypeError) as error:
                faults[self._test_path(sha).name] = str(error)
                continue
            cached_values = {name: cached_row[name] for name in cached_row.keys() - {STATE, CHANGE}}
            change = {CHANGE: cached_row[CHANGE]} if row == cached_values else {}
            current[sha] = {**row, **change, STATE: state}
        if current.keys() == rows.keys() and all(CHANGE in row for row in current.values()):
            return sort_table(current.values(), faults)
        table = _mark_changes(sort_table(current.values(), faults))
        self._keep(table.rows)
        return table

    def _file_states(self) -> dict[str, str]:
        """Return when the JSON files were written, and how large they are, by checksum of the test."""
        states = {}
        with os.scandir(self.path / _TESTS) as entries:
            for entry in entries:
                sha, _, ending = entry.name.partition(".")
                if ending != "json" or not _CHECKSUM.fullmatch(sha):
                    continue
                if entry.is_symlink():
                    raise InputError(
                        "A rig must not contain links",
                        value=f"a link at {entry.path}",
                        remedy="Remove the link, or put the file itself in its place",
                        where=str(self.path),
                    )
                with contextlib.suppress(FileNotFoundError):  # removed in this moment
                    status = entry.stat()
                    states[sha] = f"{status.st_mtime_ns}-{status.st_size}"
        return states

    def _read_cache(self) -> dict[str, dict[str, Any]]:
        try:
            return read_cache((self.path / _TABLE).read_bytes().decode("utf-8"))
        except (OSError, ValueError, KeyError, csv.Error):
            return {}

    def _keep(self, rows: Sequence[Mapping[str, Any]]) -> None:
        """Write the table; a folder that may only be read is read without one."""
        with contextlib.suppress(OSError), written_whole(self.path / _TABLE) as file:
            file.write_bytes(write_cache(rows).encode("utf-8", "backslashreplace"))


def _mark_changes(table: RigTable) -> RigTable:
    """Say of each test what was noticed to have changed with it."""
    flags = drift_chart(table.rows).flags
    rows = [{**row, CHANGE: flag} for row, flag in zip(table.rows, flags, strict=True)]
    return RigTable(rows=rows, faults=table.faults)
