"""The table of a rig's tests: made from one JSON per test, and kept in a CSV beside them for speed."""

import csv
import io
import math
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import datetime
from typing import Any, Final

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.frame_assessment import FrameAssessment
from reliab.core.arrays import Array
from reliab.core.encodings import as_cell, restore_cell
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.tracking.boundary.first_order import ellipse_of_response

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
