"""What a file of a test, or a data frame, holds, whatever its format: named columns of numbers."""

import re
import sys
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reliab.core.errors import InputError

if TYPE_CHECKING:
    import pandas as pd
    from typing_extensions import TypeIs


@dataclass(frozen=True, kw_only=True, eq=False)
class Series:
    """A history of a channel, with everything that its file states of its numbers."""

    values: NDArray[np.float64]  # In `unit`, NaN where the file marks a sample as missing; shape (n,)
    unit: str = ""
    times: NDArray[np.float64] | None = None  # In `times_unit`, shape (n,); None without a clock of its own
    times_unit: str = "s"
    start: np.datetime64 | None = None  # Date of time zero, of its own clock or, of times, of theirs
    axis: str = ""  # Name of the channel that holds its times, where the file says so
    corrections: tuple[str, ...] = ()  # What was done to the stored numbers, such as a scale, in words
    unclear: str = ""  # What may or may not be in the numbers yet, such as a gain, in words


@dataclass(frozen=True, kw_only=True, eq=False)
class Columns:
    """Columns of one test, with what is needed to say where a fault lies."""

    path: Path  # The file
    series: Mapping[str, Series]  # By name; of other lengths where their clocks differ
    scalars: Mapping[str, float] = field(default_factory=dict)  # Single numbers, such as a sampling rate
    # What comment lines before the first row state as "name = value" or "name: value", names in small letters
    header: Mapping[str, str] = field(default_factory=dict)
    # What each column is, where the file is a record: name of the part, and of its actuator
    parts: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    lines: NDArray[np.int64] | None = None  # Line of each row in a text file, counted from 1
    named: bool = True  # Whether the columns have names of their own
    notes: tuple[str, ...] = ()  # What is said of the file, in sentences
    test: str = ""  # Name of the test, where the file holds several

    @cached_property
    def values(self) -> dict[str, NDArray[np.float64]]:
        """Samples of each column."""
        return {name: series.values for name, series in self.series.items()}

    @cached_property
    def units(self) -> dict[str, str]:
        """Units that the file states beside a column's name."""
        return {name: series.unit for name, series in self.series.items() if series.unit}

    def place(self, row: int, name: str = "") -> str:
        """Say where a row lies, for an error."""
        position = f"sample {row + 1}" if self.lines is None else f"line {self.lines[row]}"
        return f"{self.location}, {position}" + (f", column {name}" if name else "")

    @property
    def location(self) -> str:
        """File, and test where it holds several."""
        return f"{self.path.name}, test {self.test}" if self.test else self.path.name

    @property
    def names_text(self) -> str:
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
    frame_with_index = frame.reset_index() if frame.index.name is not None else frame
    return Columns(
        path=Path("the data frame"),
        series=series_of_frame(frame_with_index),
        scalars={
            str(name): float(value) for name, value in frame.attrs.items() if isinstance(value, int | float)
        },
        header={str(name).lower(): value for name, value in frame.attrs.items() if isinstance(value, str)},
        named=not all(isinstance(name, int) for name in frame_with_index),
    )


def series_of_frame(frame: "pd.DataFrame", units: Mapping[str, str] | None = None) -> dict[str, Series]:
    """Take the columns of numbers, durations and dates; an index of times is the clock of all.

    `units`: by the name of a column.
    """
    import pandas as pd

    if not frame.columns.is_unique:
        raise InputError(
            "Two columns have the same name",
            value=repr(frame.columns[frame.columns.duplicated()][0]),
            remedy="Rename one of the columns",
        )
    has_time_index = isinstance(frame.index, pd.DatetimeIndex | pd.TimedeltaIndex)
    clock = _seconds_of_instants(frame.index.to_series()) if has_time_index else None
    series = {}
    for name, column in frame.items():
        kind = column.dtype.kind
        if kind in "mM":
            series[str(name)] = _seconds_of_instants(column)
        elif kind in "iuf":
            series[str(name)] = Series(
                values=column.to_numpy(dtype=np.float64, na_value=np.nan),
                unit=(units or {}).get(str(name), ""),
                times=None if clock is None else clock.values,
                start=None if clock is None else clock.start,
            )
    return series


def _seconds_of_instants(column: "pd.Series") -> Series:
    """Take dates, in any time zone, or durations as seconds."""
    has_zone = getattr(column.dtype, "tz", None) is not None
    instants = (column.dt.tz_convert(None) if has_zone else column).to_numpy()
    return Series(values=seconds(instants), unit="s", start=start_of(instants))


def start_of(instants: NDArray[Any]) -> np.datetime64 | None:
    """Return the first of some dates, from which `seconds` counts them; None of durations."""
    return instants.reshape(-1)[0] if instants.dtype.kind == "M" and instants.size else None


def seconds(instants: NDArray[Any]) -> NDArray[np.float64]:
    """Return dates from the first one on, or durations, in seconds."""
    if instants.dtype.kind == "M":
        instants = instants - instants.reshape(-1)[:1]
    return np.asarray(instants / np.timedelta64(1, "ns"), dtype=np.float64) * 1e-9


def seconds_between(first: np.datetime64, second: np.datetime64) -> float:
    """Return the time from one date to another."""
    return float(seconds(np.array([first, second]))[1])


def date_of(text: str) -> np.datetime64 | None:
    """Read a date with its time of day; None where a text is none. Digits beyond nanoseconds are left out.

    >>> date_of("2026/05/05 10:00:00,0156250000000001"), date_of("soon")
    (np.datetime64('2026-05-05T10:00:00.015625000'), None)
    """
    import pandas as pd

    plain = re.sub(r"(:\d{1,2})[.,](\d{1,9})\d*", r"\1.\2", text.strip()).replace("/", "-")
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # which of two small numbers is the month plays no part in a difference
        try:
            instant = pd.Timestamp(plain)
            local = instant if instant.tz is None else instant.tz_convert(None)
            return None if pd.isna(local) else local.as_unit("ns").to_datetime64()
        except (ValueError, OverflowError):
            return None
