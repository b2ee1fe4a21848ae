"""What stands beside the numbers of a channel: unit, scale, marks of missing samples, step and begin.

Scale, offset and marks are those of the CF conventions for NetCDF, which other HDF5 files use as well. Of
further attributes that may mean a scale or an offset nobody can tell whether they are in the numbers yet.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import counted
from reliab.recordings.readers.columns import Series, date_of

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
