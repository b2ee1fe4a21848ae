"""Files of tests that a command line names."""

from collections.abc import Sequence
from glob import glob
from pathlib import Path

from reliab.core.errors import InputError

_TABLE_BEGINS = b"file,"


def files_of(tests: Sequence[Path] | None, out: Path | None) -> list[Path]:
    """Files of the tests, also those that a pattern such as ``*.csv`` names where the shell does not."""
    files = []
    for path in tests or []:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    if out in files and not _is_table(out):
        raise InputError("This would overwrite a test", value=f"`out` {out}", remedy="Name another file")
    return [file for file in files if file != out]


def _is_table(path: Path) -> bool:
    """Tell whether a file is the table of an earlier run, which a pattern names among the tests."""
    try:
        return path.read_bytes()[: len(_TABLE_BEGINS)] == _TABLE_BEGINS
    except OSError:
        return True  # it is not there yet
