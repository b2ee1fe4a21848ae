"""A rig's folder: its tests are listed, shown, exported and removed."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.files import refuse_unwritable, require_ending, written_whole
from reliab.rig import RigFolder, RigTable
from reliab.rows import ResultWithRows


@dataclass(frozen=True, kw_only=True)
class RigList(ResultWithRows):
    """The tests of a rig."""

    rows_in = "tests"

    rig: Path
    table: RigTable

    def to_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        columns = self.table.columns
        rows = [{name: row.get(name) for name in columns} for row in self.table.rows]
        return {"rig": str(self.rig), "tests": rows, "faults": dict(self.table.faults)}


def list_rig(rig: str | Path) -> RigList:
    """List the tests of a rig in the order of their dates.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder.

    Returns
    -------
    RigList
        A row for each test.

    Raises
    ------
    InputError
        If it is no folder of a rig.
    """
    folder = RigFolder.opened(rig)
    return RigList(rig=folder.path, table=folder.table())


def show_rig_test(rig: str | Path, test: str) -> dict[str, Any]:
    """Return all that is kept of a test.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder.
    test : str
        Name of the test, or the first digits of its checksum.

    Returns
    -------
    dict
        `test` (its row), `terms` (what was stated), `assessment` (as of `reliab assess`), `record`.

    Raises
    ------
    InputError
        If there is no such test, or several.
    """
    folder = RigFolder.opened(rig)
    sha256 = folder.find(test)["sha256"]
    content = folder.read(sha256)
    return {**content, "record": str(folder.record_path(sha256))}


def remove_from_rig(rig: str | Path, tests: str | Iterable[str]) -> tuple[str, ...]:
    """Remove tests from a rig.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder.
    tests : str or iterable of str
        Names, or first digits of checksums.

    Returns
    -------
    tuple of str
        Names of the tests that were removed.

    Raises
    ------
    InputError
        If one of them is no test of the rig; then none is removed.
    """
    folder = RigFolder.opened(rig)
    table = folder.table()
    rows = [folder.find(test, table) for test in ([tests] if isinstance(tests, str) else tests)]
    for row in rows:
        folder.remove(row["sha256"])
    return tuple(row["name"] for row in rows)


def export_rig(rig: str | Path, out: str | Path) -> int:
    """Write the table of a rig as CSV.

    Parameters
    ----------
    rig : str or pathlib.Path
        The folder.
    out : str or pathlib.Path
        The file.

    Returns
    -------
    int
        Number of tests.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    require_ending(out, ".csv")
    table = RigFolder.opened(rig).table()
    with refuse_unwritable("The table's file must be writable", where=out), written_whole(out) as file:
        file.write_text(table.to_csv(), encoding="utf-8", errors="backslashreplace")
    return len(table)
