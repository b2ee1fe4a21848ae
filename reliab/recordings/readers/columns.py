"""What a file of a test holds, whatever its format: named columns of numbers, with unit, scale and step.

Scale, offset and marks are those of the CF conventions for NetCDF, which other HDF5 files use as well. Of
further attributes that may mean a scale or an offset nobody can tell whether they are in the numbers yet.
"""

import re
import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import counted

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


STEPS: Final = ("dt", "timestep", "timesteps", "step", "samplingperiod", "sampleperiod", "ts", "deltat")
RATES: Final = (
    "rate",
    "ratehz",
    "fs",
    "samplingrate",
    "samplerate",
    "samplingratehz",
    "sampleratehz",
    "samplingfrequency",
)
"""Names of a step [s] and of a rate [Hz], as all names here in small letters without other signs."""
_OWN_STEPS: Final = (*STEPS, "dx", "xincrement", "wfincrement", "samplinginterval", "sampleinterval")
_OWN_RATES: Final = (*RATES, "samplefrequency")
_BEGINS: Final = ("t0", "x0", "tstart", "starttime", "timeoffset", "wfstartoffset")
_DATES: Final = ("wfstarttime", "starttime", "startdate", "startdatetime", "t0", "epoch")
_UNITS: Final = ("units", "unit", "unitstring", "niunitdescription")
_FIRST_DATE: Final = np.datetime64("1905-01-01")  # LabVIEW counts from 1904, where nothing was set
_SCALE, _OFFSET, _MARKS = "scalefactor", "addoffset", ("fillvalue", "missingvalue")
_RANGES: Final = (
    ("validmin", 0, 1.0),
    ("validmax", -1, -1.0),
    ("validrange", 0, 1.0),
    ("validrange", -1, -1.0),
)
_APPLIED_ATTRIBUTES: Final = frozenset({_SCALE, _OFFSET, *_MARKS, *(name for name, _, _ in _RANGES)})
_NEUTRAL: Final = {
    **dict.fromkeys(("scale", "scaling", "scalingfactor", "gain", "slope", "factor", "multiplier"), 1.0),
    **dict.fromkeys(("sign", "polarity"), 1.0),
    **dict.fromkeys(("offset", "scaleoffset", "intercept"), 0.0),
}
"""Further attributes that would change numbers unless their value is this one."""
_NEUTRAL_OF_COUNTS: Final = {
    **_NEUTRAL,
    **dict.fromkeys(("sensitivity", "calibration", "calibrationfactor", "conversionfactor", "lsb"), 1.0),
    **dict.fromkeys(("bias", "zero", "zerooffset"), 0.0),
}
"""The same beside whole numbers, which a converter counts; beside others they say how a sensor was set."""


def series_of(
    values: NDArray[Any], attributes: Mapping[str, object], *, marks: Sequence[float] = (), location: str = ""
) -> Series:
    """Apply what attributes state of the stored numbers of a channel, shape (n,) or of a matrix of channels.

    `marks`: further stored numbers that stand for missing samples, which become NaN.
    """
    texts = {plain(name): _single(value) for name, value in attributes.items()}
    names = {plain(name): name for name in attributes}
    numbers = {
        name: _numbers(texts[name], names[name], location) for name in _APPLIED_ATTRIBUTES & texts.keys()
    }
    if str(texts.get("unsigned")).lower() == "true" and values.dtype.kind == "i":
        values = values.view(values.dtype.str.replace("i", "u"))
    counts, raw = values.dtype.kind in "iu", values.astype(np.float64)
    scale, offset = (
        numbers.get(name, np.full(1, default)) for name, default in ((_SCALE, 1.0), (_OFFSET, 0.0))
    )
    with np.errstate(over="ignore", invalid="ignore"):
        scaled = scale[0] * raw + offset[0] if {_SCALE, _OFFSET} & numbers.keys() else raw
    corrections = []
    if scaled is not raw:
        corrections.append(f"scale_factor {scale[0]:.9g} and add_offset {offset[0]:.9g}")
    fills = _as_stored([*marks, *(mark for name in _MARKS for mark in numbers.get(name, ()))], values.dtype)
    missing = np.isin(raw, fills) if fills.size else np.zeros(raw.shape, dtype=np.bool_)
    for name, place, sign in _RANGES:
        if name in numbers:  # of stored numbers, unless a real number stands beside packed whole ones
            values_in_range = scaled if counts and np.asarray(texts[name]).dtype.kind == "f" else raw
            missing |= sign * values_in_range < sign * numbers[name][place]
    if missing.any():
        scaled = np.where(missing, np.nan, scaled)
        corrections.append(f"{counted(int(missing.sum()), 'sample')} marked as missing")
    unit = next((text for name in _UNITS if isinstance(text := texts.get(name), str) and text), "")
    series = Series(
        values=scaled,
        unit=unit,
        start=date_of(since) if (since := unit.partition(" since ")[2]) else None,
        corrections=tuple(corrections),
        unclear=unclear_in(attributes, counts=counts),
    )
    return add_clock(series, attributes)


def apply_attributes(series: Series, attributes: Mapping[str, object]) -> Series:
    """Apply further attributes to a channel, such as those of the structure that holds it alone."""
    new_series = series_of(series.values, attributes)
    unclear = " and ".join(filter(None, (series.unclear, new_series.unclear)))
    return replace(
        series if new_series.times is None else new_series,
        values=new_series.values,
        unit=series.unit or new_series.unit,
        corrections=(*series.corrections, *new_series.corrections),
        unclear=unclear,
    )


def add_clock(series: Series, attributes: Mapping[str, object], *, has_times: bool = False) -> Series:
    """Give a channel without times those that a step or a rate and a begin among attributes state.

    `has_times`: whether they stand in another channel, of which the attributes may state the date.
    """
    attribute_values = {plain(name): _single(value) for name, value in attributes.items()}
    dates = (_date(attribute_values[name]) for name in _DATES if name in attribute_values)
    start = next((date for date in dates if date is not None), series.start)
    steps = (_positive(attribute_values[name]) for name in _OWN_STEPS if name in attribute_values)
    rates = (_positive(attribute_values[name]) for name in _OWN_RATES if name in attribute_values)
    step = next((step for step in (*steps, *(1.0 / rate for rate in rates if rate)) if step), 0.0)
    if has_times or series.times is not None or not step:
        return replace(series, start=start)
    begins = (attribute_values[name] for name in _BEGINS if name in attribute_values)
    begin = next((float(start) for start in begins if isinstance(start, int | float | np.number)), 0.0)
    return replace(
        series,
        times=begin + step * np.arange(len(series.values), dtype=np.float64),
        times_unit=str(attribute_values.get("wfxunitstring") or "s"),
        start=start,
    )


def unclear_in(attributes: Mapping[str, object], *, counts: bool = False) -> str:
    """Name numbers among attributes that may be a scale or an offset, and change something.

    `counts`: whether they stand beside whole numbers.
    """
    neutral = _NEUTRAL_OF_COUNTS if counts else _NEUTRAL
    return " and ".join(
        f"{name} = {_single(value)}"
        for name, value in attributes.items()
        if (word := plain(name)) in neutral
        and np.asarray(value).dtype.kind in "iuf"
        and (np.asarray(value) != neutral[word]).any()
    )


def plain(name: str) -> str:
    """Write a name in small letters without other signs."""
    return re.sub(r"[\W_]+", "", name).lower()


def _as_stored(marks: Sequence[float], kind: np.dtype[Any]) -> Array:
    """Return marks as numbers of a kind read: rounded as reals are, and without a sign where it has none."""
    numbers = np.asarray(marks, dtype=np.float64)
    if kind.kind == "f":
        with np.errstate(over="ignore"):
            return numbers.astype(kind).astype(np.float64)
    return np.where((numbers < 0.0) & (kind.kind == "u"), numbers + 2.0 ** (8 * kind.itemsize), numbers)


def _numbers(value: object, name: str, location: str) -> Array:
    """Read the numbers of an attribute, which some programs write as text."""
    try:
        numbers = np.asarray(value).astype(np.float64).reshape(-1)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    single = numbers.size == 1 and bool(np.isfinite(numbers[0]))
    if not numbers.size or (plain(name) in {_SCALE, _OFFSET} and not single):
        raise InputError(
            f"The attribute {name} of this channel is no number",
            value=str(value)[:40],
            remedy="Correct it, or export the channel in its unit",
            where=location,
        )
    return numbers


def _single(value: object) -> object:
    """Take the only item of an attribute out of its array, and a text out of its bytes."""
    item = np.asarray(value).reshape(-1)[0] if np.asarray(value).size == 1 else value
    return item.decode("utf-8", "replace") if isinstance(item, bytes) else item


def _date(value: object) -> np.datetime64 | None:
    date = date_of(value) if isinstance(value, str) else value
    return date if isinstance(date, np.datetime64) and date >= _FIRST_DATE else None


def _positive(value: object) -> float:
    number = float(value) if isinstance(value, int | float | np.number) else 0.0
    return number if np.isfinite(number) and number > 0.0 else 0.0
