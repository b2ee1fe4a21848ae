"""What a file of a test holds, whatever its format: named columns of numbers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """Columns of a file, with what is needed to say where a fault lies.

    Parameters
    ----------
    path : pathlib.Path
        The file.
    values : mapping of str to numpy.ndarray
        Samples of each column as they stand in the file, shape (n,).
    units : mapping of str to str, optional
        Units that the file states beside a column's name.
    scalars : mapping of str to float, optional
        Single numbers, such as a sampling rate.
    header : mapping of str to str, optional
        What comment lines before the first row state as "name = value" or "name: value", names in small
        letters.
    lines : numpy.ndarray, optional
        Line of each row in a text file, counted from 1.
    named : bool, optional
        Whether the columns have names of their own.
    """

    path: Path
    values: Mapping[str, NDArray[np.float64]]
    units: Mapping[str, str] = field(default_factory=dict)
    scalars: Mapping[str, float] = field(default_factory=dict)
    header: Mapping[str, str] = field(default_factory=dict)
    lines: NDArray[np.int64] | None = None
    named: bool = True

    def place(self, row: int, name: str = "") -> str:
        """Say where a row lies, for an error.

        Parameters
        ----------
        row : int
            Index of the row.
        name : str, optional
            Column.

        Returns
        -------
        str
            File, line or sample, and column.
        """
        at = f"sample {row + 1}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.path.name}, {at}" + (f", column {name}" if name else "")
