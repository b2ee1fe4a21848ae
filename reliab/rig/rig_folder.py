"""The folder of a rig: `records/SHA.nc` and `tests/SHA.json` for each test, and a table made from them.

No server and no lock: a test is in the folder as soon as its JSON has its name, which a file system gives at
once or not at all. Several writers therefore never touch one another's tests, and a killed one leaves at
most a record without its JSON, which the next `add` of that file replaces. `table.csv` is a copy of what the
JSON files say, for speed; whoever finds it older than they are makes it again.
"""

import contextlib
import csv
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from reliab.core.described_files import read_json
from reliab.core.errors import InputError
from reliab.core.files import refuse_unwritable, write_json_file, written_whole
from reliab.rig.rig_table import (
    CHANGE,
    SCHEMA,
    STATE,
    RigTable,
    RigTest,
    read_cache,
    row_of,
    sort_table,
    write_cache,
)
from reliab.rig.watching import drift_chart

if TYPE_CHECKING:
    import xarray as xr

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
