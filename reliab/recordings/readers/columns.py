"""What a file of a test holds, whatever its format: named columns of numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """Columns of a file, with what is needed to say where a fault lies."""

    path: Path  # The file
    values: Mapping[str, NDArray[np.float64]]  # Samples of each column as they stand in the file, shape (n,)
    # Units that the file states beside a column's name
    units: Mapping[str, str] = field(default_factory=dict)
    scalars: Mapping[str, float] = field(default_factory=dict)  # Single numbers, such as a sampling rate
    # What comment lines before the first row state as "name = value" or "name: value", names in small letters
    header: Mapping[str, str] = field(default_factory=dict)
    lines: NDArray[np.int64] | None = None  # Line of each row in a text file, counted from 1
    named: bool = True  # Whether the columns have names of their own

    def place(self, row: int, name: str = "") -> str:
        """Say where a row lies, for an error."""
        at = f"sample {row + 1}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.path.name}, {at}" + (f", column {name}" if name else "")
