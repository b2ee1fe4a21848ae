"""K-NET and KiK-net ASCII: seventeen labelled lines, then counts of the instrument.

Each component is a separate file. A count times the scale factor of the header is acceleration in gal. The
instrument has an offset; NIED, which publishes the records, subtracts the mean of the whole record before it
states the largest acceleration, and so does this reader.

References
----------
NIED, *K-NET ASCII format* and *K-NET and KiK-net: questions and answers*, questions 1 and 2.
"""

import re

from reliab.motions.faults import Report
from reliab.motions.readers.header import NUMBER, Header, Statement, number, state_time_step
from reliab.motions.readers.source import Line, Source
from reliab.motions.units import AccelerationUnit

_LABELS = {
    "origin": re.compile(r"^Origin Time\s+(.*)$", re.IGNORECASE),
    "latitude": re.compile(r"^Lat\.\s+(\S+)", re.IGNORECASE),
    "longitude": re.compile(r"^Long?\.\s+(\S+)", re.IGNORECASE),
    "rate": re.compile(r"^Sampling Freq\S*\s+(\S+?)\s*(?:Hz)?\s*$", re.IGNORECASE),
    "duration": re.compile(r"^Duration Time\S*\s+(\S+)", re.IGNORECASE),
    "scale": re.compile(r"^Scale Factor\s+(.*)$", re.IGNORECASE),
    "memo": re.compile(r"^Memo\.?(.*)$", re.IGNORECASE),
}
_HEADER_LINES = 30
_SCALE = re.compile(rf"\s*({NUMBER})\s*\(\s*gal\s*\)\s*/\s*({NUMBER})\s*", re.IGNORECASE)


def recognises(source: Source) -> bool:
    """Tell whether a file begins with the labels of K-NET."""
    labelled = _labelled(source)
    return "origin" in labelled and "scale" in labelled


def headers(source: Source, report: Report) -> list[Header]:
    """Read the header of a K-NET or KiK-net file."""
    labelled = _labelled(source)
    missing = [label for label in ("rate", "duration", "scale", "memo") if label not in labelled]
    if missing:
        report.add(
            "The header of a K-NET file must be complete",
            line=1,
            value=f"no line for {', '.join(missing)}",
            remedy="Obtain the file again",
        )
        return []
    time_step = _time_step(labelled["rate"], report)
    scale = _scale(labelled["scale"], report)
    if time_step is None or scale is None:
        return []
    return [
        Header(
            start=labelled["memo"][0].stop,
            stop=len(source.content),
            count=_count(labelled["duration"], time_step.value, report),
            time_step=time_step,
            units=Statement(value=AccelerationUnit.CENTIMETRE, line=labelled["scale"][0].number),
            scale=scale,
            remove_mean=True,
            event=_event(labelled),
        )
    ]


def _labelled(source: Source) -> dict[str, tuple[Line, str]]:
    labelled: dict[str, tuple[Line, str]] = {}
    for _, line in zip(range(_HEADER_LINES), source.lines(), strict=False):
        for label, pattern in _LABELS.items():
            if label not in labelled and (match := pattern.match(line.text)):
                labelled[label] = line, match[1].strip()
        if "memo" in labelled:
            break
    return labelled


def _time_step(entry: tuple[Line, str], report: Report) -> Statement[float] | None:
    line, text = entry
    rate = number(text)
    if rate is None or not 0 < rate < float("inf"):
        return state_time_step(text, line.number, report)
    return Statement(value=1.0 / rate, line=line.number)


def _scale(entry: tuple[Line, str], report: Report) -> float | None:
    line, text = entry
    match = _SCALE.fullmatch(text)
    gal, counts = (number(match[1]), number(match[2])) if match else (None, None)
    if gal and counts and 0 < gal / counts < float("inf"):
        return gal / counts
    report.add(
        "The scale factor of a K-NET file must be gal over counts, as in 3920(gal)/6182761",
        line=line.number,
        value=text or "nothing",
        remedy="Obtain the file again",
    )
    return None


def _count(entry: tuple[Line, str], time_step: float, report: Report) -> Statement[int] | None:
    line, text = entry
    duration = number(text)
    if duration is None or not 2 * time_step <= duration < 1e6:  # noqa: PLR2004 - eleven days, no accelerogram
        report.add(
            "The duration of a K-NET file must be a positive number of seconds",
            line=line.number,
            value=text,
            remedy="Obtain the file again",
        )
        return None
    return Statement(value=round(duration / time_step), line=line.number)


def _event(labelled: dict[str, tuple[Line, str]]) -> str:
    """Origin time and epicentre, as in ``2018-01-24 19:51:00 41.0N 142.5E``; empty if one is missing."""
    parts = [labelled[label][1] for label in ("origin", "latitude", "longitude") if label in labelled]
    if len(parts) < 3 or not all(parts):  # noqa: PLR2004 - time, latitude and longitude
        return ""
    return f"{parts[0].replace('/', '-')} {parts[1]}N {parts[2]}E"
