"""Numbers as a file means them: packed ones with scale and offset, and samples that it marks as missing.

The attributes are those of the CF conventions for NetCDF, which other HDF5 files use as well. Of further
ones that may mean a scale or an offset nobody can tell whether they are in the numbers yet.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.recordings.readers.columns import Series, date_of
from reliab.significant import counted

_SCALE, _OFFSET, _MARKS = "scalefactor", "addoffset", ("fillvalue", "missingvalue")
_RANGES: Final = (("validmin", "validmax"), ("validrange", "validrange"))
_APPLIED: Final = frozenset({_SCALE, _OFFSET, *_MARKS, *(name for names in _RANGES for name in names)})
_NEUTRAL: Final = {
    **dict.fromkeys(("scale", "scaling", "scalingfactor", "gain", "slope", "factor", "multiplier"), 1.0),
    **dict.fromkeys(("offset", "scaleoffset", "intercept"), 0.0),
}
"""Further attributes that would change numbers unless their value is this one."""
_NEUTRAL_OF_COUNTS: Final = {
    **_NEUTRAL,
    **dict.fromkeys(("sensitivity", "calibration", "calibrationfactor", "conversionfactor", "lsb"), 1.0),
    **dict.fromkeys(("bias", "zero", "zerooffset"), 0.0),
}
"""The same beside whole numbers, which a converter counts; beside others they say how a sensor was set."""


def unpacked(
    values: NDArray[Any],
    attributes: Mapping[str, object],
    unit: str = "",
    *,
    marks: Sequence[float] = (),
    where: str = "",
) -> Series:
    """Apply what attributes state of the stored numbers of a channel, shape (n,).

    `marks`: further stored numbers that stand for missing samples, which become NaN.
    """
    stated = {_plain(name): value for name, value in attributes.items()}
    held = {name: _numbers(stated[name], name, where) for name in _APPLIED & stated.keys()}
    if str(_single(stated.get("unsigned"))).lower() == "true" and values.dtype.kind == "i":
        values = values.view(values.dtype.str.replace("i", "u"))
    raw = values.astype(np.float64)
    scale, offset = _factors(held, where)
    with np.errstate(over="ignore", invalid="ignore"):
        in_unit = raw if (scale, offset) == (1.0, 0.0) else scale * raw + offset
    missing = _missing(raw, in_unit, values.dtype, stated, held, marks)
    applied = [] if in_unit is raw else [f"scale_factor {scale:.9g} and add_offset {offset:.9g}"]
    if missing.any():
        in_unit[missing] = np.nan
        applied.append(f"{counted(int(missing.sum()), 'sample')} marked as missing")
    return Series(
        values=in_unit,
        unit=unit,
        start=date_of(since) if (since := unit.partition(" since ")[2]) else None,
        applied=tuple(applied),
        unclear=unclear_in(attributes, counts=values.dtype.kind in "iu"),
    )


def _factors(held: Mapping[str, Array], where: str) -> tuple[float, float]:
    """Return scale and offset of packed numbers."""
    both = (("scale_factor", held.get(_SCALE, np.ones(1))), ("add_offset", held.get(_OFFSET, np.zeros(1))))
    for name, numbers in both:
        if numbers.size != 1 or not np.isfinite(numbers).all():
            raise _no_number(name, numbers.tolist(), where)
    return float(both[0][1][0]), float(both[1][1][0])


def _missing(
    raw: Array,
    in_unit: Array,
    kind: np.dtype[Any],
    stated: Mapping[str, object],
    held: Mapping[str, Array],
    marks: Sequence[float],
) -> NDArray[np.bool_]:
    """Find samples that equal a mark, or lie outside their range, which is that of stored numbers.

    A range of real numbers beside packed whole ones is that of the unpacked ones.
    """
    every = _as_stored([*marks, *(mark for name in _MARKS for mark in held.get(name, ()))], kind)
    missing = np.isin(raw, every) if every.size else np.zeros(raw.shape, dtype=np.bool_)
    for names in _RANGES:
        for name, place, sign in zip(names, (0, -1), (1.0, -1.0), strict=True):
            if name in held:
                is_real = kind.kind in "iu" and np.asarray(stated[name]).dtype.kind == "f"
                missing |= sign * (in_unit if is_real else raw) < sign * held[name][place]
    return missing


def unclear_in(attributes: Mapping[str, object], *, counts: bool = False) -> str:
    """Name numbers among attributes that may be a scale or an offset, and change something.

    `counts`: whether they stand beside whole numbers.
    """
    neutral = _NEUTRAL_OF_COUNTS if counts else _NEUTRAL
    return " and ".join(
        f"{name} = {_single(value)}"
        for name, value in attributes.items()
        if (plain := _plain(name)) in neutral
        and np.asarray(value).dtype.kind in "iuf"
        and (np.asarray(value) != neutral[plain]).any()
    )


def _plain(name: str) -> str:
    return re.sub(r"[\W_]+", "", name).lower()


def _as_stored(marks: Sequence[float], kind: np.dtype[Any]) -> Array:
    """Return marks as numbers of a kind read: rounded as reals are, and without a sign where it has none."""
    numbers = np.asarray(marks, dtype=np.float64)
    if kind.kind == "f":
        with np.errstate(over="ignore"):
            return numbers.astype(kind).astype(np.float64)
    return np.where((numbers < 0.0) & (kind.kind == "u"), numbers + 2.0 ** (8 * kind.itemsize), numbers)


def _numbers(value: object, name: str, where: str) -> Array:
    """Read the numbers of an attribute, which some programs write as text."""
    try:
        numbers = np.asarray(_single(value)).astype(np.float64).reshape(-1)
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if not numbers.size:
        raise _no_number(name, value, where)
    return numbers


def _no_number(name: str, value: object, where: str) -> InputError:
    return InputError(
        f"The attribute {name} of a channel must be a number",
        value=str(value)[:40],
        remedy="Correct it, or export the channel in its unit",
        where=where,
    )


def _single(value: object) -> object:
    """Take the only item of an attribute out of its array, and a text out of its bytes."""
    item = np.asarray(value).reshape(-1)[0] if np.asarray(value).size == 1 else value
    return item.decode("utf-8", "replace") if isinstance(item, bytes) else item
