"""How large a file of each kind may be, so that nothing that was received fills the memory or takes hours."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from reliab.core.errors import InputError
from reliab.core.files import require_small

_MEGABYTE = 1e6
_LOOKED_AT = 4_000_000  # bytes of a text whose lines are looked at: tables begin near its top
_DELIMITERS = (b",", b";", b"\t")


@dataclass(frozen=True, kw_only=True)
class FileLimits:
    """Largest sizes of a file of one kind."""

    remedy: str
    bytes: int
    columns: int = 1000
    numbers: int = 2_000_000_000  # Bytes of all its numbers together, in memory

    def require_small(self, path: str | Path) -> None:
        """Refuse a file that would not fit in memory, before it is read."""
        require_small(path, self.bytes, remedy=self.remedy)

    def require_narrow(self, path: str | Path) -> None:
        """Refuse a text with more columns than any table, before its lines are cut into cells."""
        with Path(path).open("rb") as file:
            lines = file.read(_LOOKED_AT).splitlines()
        widest = max((max(*map(line.count, _DELIMITERS), len(line.split())) + 1 for line in lines), default=0)
        if widest > self.columns:
            raise InputError(
                f"The table has more than {self.columns:,} columns",
                value=f"{widest:,} or more",
                remedy=self.remedy,
                where=str(path),
            )

    def require_few_numbers(self, size: int, where: str | Path) -> None:
        """Refuse numbers that would not fit in memory; `size` [bytes] is what the file declares."""
        if size > self.numbers:
            raise InputError(
                f"The file holds more than {self.numbers / _MEGABYTE:,.6g} MB of numbers",
                value=f"{size / _MEGABYTE:,.6g} MB",
                remedy=self.remedy,
                where=str(where),
            )


_SHORTER_TEST = "Leave columns out, resample the test, or cut it where everything stands still"

LIMITS: Final[Mapping[str, FileLimits]] = {
    "description": FileLimits(  # whose TOML takes two to six seconds
        bytes=5_000_000, remedy="Write the description as its examples are written"
    ),
    "criterion": FileLimits(  # of some ten thousand motions, in JSON
        bytes=200_000_000, remedy="Derive it for fewer structures or errors"
    ),
    "matrix": FileLimits(bytes=20_000_000, remedy="Condense the structure to fewer degrees of freedom"),
    "table of ellipses": FileLimits(  # which takes about eight times its size in memory
        bytes=200_000_000,
        remedy="Keep the columns, structures and errors that you ask for, or write NetCDF",
    ),
    "dataset": FileLimits(  # of ellipses or results, in NetCDF
        bytes=1_000_000_000, remedy="Write fewer structures, errors or motions into one file"
    ),
    "figure": FileLimits(bytes=50_000_000, remedy="Run the study again with `reliab run`"),
    "test": FileLimits(bytes=2_000_000_000, remedy=_SHORTER_TEST),
}
"""Limits by the kind of file."""
