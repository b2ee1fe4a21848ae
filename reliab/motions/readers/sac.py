"""SAC: 632 bytes of header, then one component in single precision.

The header does not say in which units the samples are, so the user gives them. ObsPy reads SAC too, but it
hangs on damaged headers from which it computes distances.

References
----------
IRIS. *SAC data file format*, header versions 6 and 7.
"""

import datetime as dt
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from reliab.motions.faults import Report
from reliab.motions.readers.miniseed import is_of_seismometer
from reliab.motions.readers.source import RecordHeader, RecordText, Statement

_SIZES = (280, 160, 192)  # bytes of real numbers, of whole numbers and of text
_DELTA, _SCALE, _BEGIN, _ORIGIN = 0, 3, 5, 7  # places of real numbers
_TIME, _VERSION, _COUNT, _TYPE, _QUANTITY, _EVEN = slice(0, 6), 6, 9, 15, 16, 35  # of whole numbers
_EVENT, _CHANNEL = slice(8, 24), slice(160, 168)  # of text
_STATION = (slice(168, 176), slice(0, 8))  # network and station
_UNDEFINED_VALUE = -12345
_TIME_SERIES = 1  # value of the type
_ACCELERATION = 8  # value of the quantity
_QUANTITIES = {6: "displacement", 7: "velocity", 50: "volts"}


def recognises(source: RecordText) -> bool:
    """Tell whether a file has a SAC header, in either order of bytes."""
    return _byte_order(source.content) is not None


def headers(source: RecordText, report: Report) -> list[RecordHeader]:
    """Read the header and the samples of the one component; empty if a rule is broken."""
    order = _byte_order(source.content)
    if order is None:
        report.add("The SAC header of 632 bytes is missing", remedy="Export or download the file again")
        return []
    reals = np.frombuffer(source.content, f"{order}f4", _SIZES[0] // 4)
    integers = np.frombuffer(source.content, f"{order}i4", _SIZES[1] // 4, _SIZES[0])
    text = source.content[sum(_SIZES[:2]) : sum(_SIZES)].decode("latin-1")
    count = max(int(integers[_COUNT]), 0)
    values = source.content[sum(_SIZES) :][: 4 * count]
    channel = _label(text[_CHANNEL])
    for rule, value, remedy in _objections(reals, integers, channel, len(values) // 4):
        report.add(rule, value=value, remedy=remedy)
    if report.faults:
        return []
    step = float(f"{float(reals[_DELTA]):.7g}")  # as it was before single precision
    with np.errstate(invalid="ignore"):  # of damaged numbers, which are refused later
        samples = np.frombuffer(values, f"{order}f4").astype(np.float64)
    return [
        RecordHeader(
            time_step=Statement(value=step, line=None) if 0 < step < math.inf else None,
            event=_event(reals, integers, text),
            channel=channel,
            values=samples,
        )
    ]


def _objections(reals: Any, integers: Any, channel: str, samples: int) -> Iterator[tuple[str, str, str]]:  # noqa: ANN401
    """Yield what forbids to take the samples as acceleration: the rule, what the file has, what to do."""
    scale, quantity = float(reals[_SCALE]), int(integers[_QUANTITY])
    if integers[_TYPE] != _TIME_SERIES or not integers[_EVEN]:
        yield (
            "Not a time series at equal steps",
            "another kind of SAC file",
            "Interpolate it at equal steps",
        )
    if quantity in _QUANTITIES or (quantity != _ACCELERATION and is_of_seismometer(channel)):
        value = _QUANTITIES.get(quantity, f"velocity (channel {channel} belongs to a seismometer)")
        yield (
            "Not a record of acceleration",
            value,
            "Export the acceleration; if this is acceleration, set IDEP to IACC",
        )
    if scale not in {1, _UNDEFINED_VALUE}:
        yield "The SAC scale is not 1", f"{scale:g}", "Multiply the samples by it, and set it to 1"
    if samples < integers[_COUNT]:
        value = f"{samples} of {integers[_COUNT]}"
        rule = "Fewer samples than the header states"
        yield rule, value, "The file was cut short: export or download it again"


def _byte_order(content: bytes) -> str | None:
    if len(content) < sum(_SIZES):
        return None
    versions = (
        (order, np.frombuffer(content, f"{order}i4", 1, _SIZES[0] + 4 * _VERSION)[0]) for order in "<>"
    )
    return next((order for order, version in versions if version in {6, 7}), None)


def _event(reals: Any, integers: Any, text: str) -> str:  # noqa: ANN401 - arrays of one precision each
    """Name and origin time of the earthquake, or else the station and the begin of its record."""
    year, day, hour, minute, second, millisecond = integers[_TIME].tolist()
    has_origin = reals[_ORIGIN] != _UNDEFINED_VALUE
    seconds = second + float(reals[_ORIGIN] if has_origin else reals[_BEGIN])
    try:
        clock = dt.timedelta(
            days=day - 1, hours=hour, minutes=minute, seconds=seconds, milliseconds=millisecond
        )
        moment = dt.datetime(year, 1, 1, tzinfo=dt.UTC) + clock
    except (ValueError, OverflowError):  # of which some are undefined
        return ""
    name = _label(text[_EVENT]).upper() if has_origin else ".".join(_label(text[place]) for place in _STATION)
    return f"{name} {moment:%Y-%m-%d %H:%M:%S}".strip()


def _label(text: str) -> str:
    label = text.replace("\0", " ").strip()
    return "" if label == str(_UNDEFINED_VALUE) else label
