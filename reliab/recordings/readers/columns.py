"""What a file of a test, or a data frame, holds, whatever its format: named columns of numbers."""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import TypeIs


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """Columns of one test, with what is needed to say where a fault lies."""

    path: Path  # The file
    # Samples of each column as they stand in the file, shape (n,), or another number where its clock differs
    values: Mapping[str, NDArray[np.float64]]
    # Units that the file states beside a column's name
    units: Mapping[str, str] = field(default_factory=dict)
    # Times [s] of columns that state their own, such as the channels of a data logger with several rates
    clocks: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    scalars: Mapping[str, float] = field(default_factory=dict)  # Single numbers, such as a sampling rate
    # What comment lines before the first row state as "name = value" or "name: value", names in small letters
    header: Mapping[str, str] = field(default_factory=dict)
    # What each column is, where the file is a record: name of the part, and of its actuator
    parts: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    lines: NDArray[np.int64] | None = None  # Line of each row in a text file, counted from 1
    named: bool = True  # Whether the columns have names of their own
    notes: tuple[str, ...] = ()  # What is said of the file, in sentences
    test: str = ""  # Name of the test, where the file holds several

    def place(self, row: int, name: str = "") -> str:
        """Say where a row lies, for an error."""
        at = f"sample {row + 1}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.where}, {at}" + (f", column {name}" if name else "")

    @property
    def where(self) -> str:
        """File, and test where it holds several."""
        return f"{self.path.name}, test {self.test}" if self.test else self.path.name

    @property
    def listed(self) -> str:
        """Names of the columns, for a sentence."""
        names = [repr(name) for name in self.values]
        return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")  # noqa: PLR2004


def is_frame(test: object) -> "TypeIs[pd.DataFrame]":
    """Tell a data frame from anything else; whoever made one has imported pandas."""
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(test, pandas.DataFrame)


def read_frame(frame: "pd.DataFrame") -> Columns:
    """Take the columns of numbers of a data frame.

    >>> import pandas as pd
    >>> frame = pd.DataFrame({"time_s": [0.0, 0.1], "command_m": [0, 1], "remark": ["", "start"]})
    >>> list(read_frame(frame).values)
    ['time_s', 'command_m']
    """
    numbers = frame.select_dtypes("number")
    return Columns(
        path=Path("the data frame"),
        values={str(name): numbers[name].to_numpy(dtype=np.float64) for name in numbers},
        header={str(name).lower(): str(value) for name, value in frame.attrs.items()},
        named=not all(isinstance(name, int) for name in numbers),
    )
