"""What the lines of a header state: one lexer for all layouts.

A statement has a label, a value and mostly a unit, in any of these orders::

    DT=   .0100 SEC       time step: 10 milliseconds    SAMPLING INTERVAL (sec) : 0.01   dt_ms = 10
    sampling rate: 1 kHz  AT 200 SAMPLES/SEC            NPTS= 3000                       7500 points of accel
    (UNITS: CM/SEC/SEC)   acceleration [gal]            scale factor 0.5                 3920(gal)/6182761

The unit tells a step from a rate; the label decides where no unit stands. A value that is no number is
reported with its line.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

from reliab.core.text_tables import NUMBER, last_place, parse_number
from reliab.core.units import CLOCK_UNIT, AccelerationUnit, ClockUnit, find_clock_unit, find_unit
from reliab.motions.faults import Report
from reliab.motions.readers.source import LONGEST_LINE, RecordLine, Statement

_FLAGS = re.IGNORECASE
_NAMES = re.compile(r"^[#%!/\s]*(?:motion|event|name)\s*[=:]", _FLAGS)
_MARKS = " \t#%!/*|"  # signs before a line of a header

_CHANNELS = r"(?:[ ,]*C\d+-C\d+)?,?"  # as in INTERVALO DE MUESTREO, C1-C6 (s) : /0.01/0.01/0.01
_SIGN = r"\s*(?:(?P<sign>[=:])|\bis\b|\bof\b)?\s*/?\s*"
_VALUE = (
    r"(?P<value>[0-9]{1,3}(?:,[0-9]{3})+(?![0-9,.])|0,[0-9]+(?![0-9.])"
    rf"|(?>{NUMBER})(?!:[0-9])|[^\s,;\])]+)?"
)
_LEADING_UNIT = rf"(?:[ _]*(?:in\s+)?[\[(]?(?P<before>{CLOCK_UNIT})[\])]?)?"
_TRAILING_UNIT = rf"\s*[\[(]?(?P<after>{CLOCK_UNIT})?"
_CLOCK_LABELS = {
    r"(?<![a-z0-9])dt(?![a-z0-9])|delta[ _]?t(?![a-z])|\bt(?:ime)?[ _-]?step"
    r"|\btime[ _](?:interval|increment|spacing)|sampl(?:e|ing)[ _]?(?:interval|period|step|spacing)"
    r"|spaced\s+at|spaced\s+intervals\s+of|intervalo\s+de\s+muestreo": False,
    r"(?<![a-z0-9])fs(?![a-z0-9])|(?<![a-z])(?:(?:sampl(?:e|ing)|digiti[sz]ation|data)[ _]?)?rate(?![a-z])"
    r"|sampl(?:e|ing)[ _]?freq(?:uency)?\.?|samples?\s*(?:/|per)\s*s(?:ec(?:ond)?)?"
    r"|frecuencia\s+de\s+muestreo": True,
}
_CLOCKS = (  # patterns of a step or a rate, and whether a number without unit is a rate
    *(
        (
            re.compile(f"(?:{labels}){_CHANNELS}{_LEADING_UNIT}{_SIGN}{_VALUE}{_TRAILING_UNIT}", _FLAGS),
            is_rate,
        )
        for labels, is_rate in _CLOCK_LABELS.items()
    ),
    (re.compile(rf"\bat\s+(?P<value>{NUMBER})\s*(?P<after>{CLOCK_UNIT})\.?\s+intervals?", _FLAGS), False),
    (
        re.compile(rf"(?<![\w.])(?P<value>{NUMBER})\s*(?P<after>sps|samples?\s*(?:/|per)\s*s\w*)", _FLAGS),
        True,
    ),
)
_COUNTS_OF_SAMPLES = (
    re.compile(r"^\W*(?P<value>\S+)\s+(?:points\s+of\b|accel\w*\s+(?:data\s+)?(?:pts|points)\b)", _FLAGS),
    re.compile(r"^\W*(?P<value>[0-9]+)\s+samples\b(?!\s*(?:/|per\b))", _FLAGS),
    re.compile(
        r"(?<![a-z])(?<!missing )(?:npts|ndata|nsamp|n?samples(?!\s*(?:/|per\b))"
        r"|n(?:o|um(?:ber)?)?\.?(?:\s+total)?[ _]of[ _](?:data[ _])?(?:points|samples|data)"
        rf"|num\.?\s+total\s+de\s+muestras)(?![a-z]){_CHANNELS}{_SIGN}{_VALUE}",
        _FLAGS,
    ),
)
_BOTH = (  # count and step in the orders that old records print, made into one
    (re.compile(rf"^\s*({NUMBER})[\s,]+({NUMBER})[\s,]+NPTS[\s,]+DT\b", _FLAGS), r"NPTS= \1, DT= \2"),
    (re.compile(rf"\bNPTS[\s,]+DT\s*[=:]\s*({NUMBER})[\s,]+({NUMBER})", _FLAGS), r"NPTS= \1, DT= \2"),
)
_DURATION = re.compile(
    rf"(?<!raw )(?:record[ _]?length|duration(?:[ _]?time)?){_LEADING_UNIT}{_SIGN}{_VALUE}{_TRAILING_UNIT}",
    _FLAGS,
)

_UNITS = re.compile(
    r"(?<![a-z])(?:amplitude[ _]?)?(?:units?|unidad(?:es)?)\b\s*(?:of|are|is|in|de|[=:])\s*(.+)", _FLAGS
)
_PIECES = re.compile(r"[,;:=]|\s{2,}|\b(?:and|in|are|is|of|max)\b", _FLAGS)
_FIRST_WORD = re.compile(r"[^\s.,;:]+(?:\s?/\s?[^\s.,;:]+)*")
_CODE = re.compile(r"\(\d+\)")  # COSMOS numbers its units
_ANOTHER_UNIT = re.compile(r"[a-z]\s*/\s*s|count|volt|^[mµ]?v$", _FLAGS)
_MULTIPLE = re.compile(rf"^\s*{NUMBER}\s*[*x×]?\s*", _FLAGS)
_SLASHED_UNIT = r"[cm]?m/s(?:/s|(?:\^|\*\*)?[2²])"
_NAMED_UNITS = (
    re.compile(r"\b(?:acc\w*|a_?g?)\b[^\[(,;]*[\[(]([^\])]+(?:\)\w*)?)[\])]", _FLAGS),
    re.compile(
        rf"(?<![a-z])(?:acc[a-z]*(?:_[a-z])?_(?=g\b)|a(?:cc[a-z]*)?(?:_[a-z])?_(?!g\b))"
        rf"(g|gal|[cm]?mps2|[cm]?m_s2|{_SLASHED_UNIT})(?!\w)",
        _FLAGS,
    ),
    re.compile(r"\bacc\w*\s+in\s+(\S+)", _FLAGS),
)
_ANNOUNCED_UNITS = re.compile(r"\bspaced\s+at\b.*sec\w*\.?\s*,?\s*in\s+([^\n(]*[^\s(.])", _FLAGS)
_PEAK_UNITS = re.compile(
    rf"\b(?:peak\s+accel\w*|accel\w*\s*:\s*peak)\s*=?\s*{NUMBER}\s+([^\s,;]+)|\bpga\b[^=:(]*\(([^)]+)\)",
    _FLAGS,
)
_TIME_UNIT = re.compile(rf"(?:^|[,;\t])\W*(?:relative)?time\s*(?:in\s+)?[\[(_ ]*({CLOCK_UNIT})", _FLAGS)

_FACTOR = re.compile(
    r"(?<![a-z])(?<!full )(?<!full-)(?:(?P<scale>(?:scal(?:e|ing)|amplitude)[ _]factor"
    r"|scale(?=\s*[=:]\s*[-+.0-9]))|\bcounts?(?=\s*=)|(?:conversion|calibration)[ _]factor"
    rf"|multipl(?:ier|y)\b[^=:0-9\n]{{0,40}})\s*(?:is|of|by)?\s*[=:]?\s*(?P<value>{NUMBER}|[^\s,;]+)?"
    rf"\s*(?P<unit>\([^)]*\)|[a-z][\w/^*²]*)?\s*(?:/\s*(?P<divisor>{NUMBER}))?",
    _FLAGS,
)
_APPLIED_WORDS = re.compile(r"(?<!be )(?<!not )(?<!yet )\bapplied\b", _FLAGS)
_COUNTS = re.compile(r"/\s*(?:counts?|cts?|digits?|lsb|bits?)\b", _FLAGS)
_OFFSET = re.compile(rf"\boffset\b(?P<column>[^=:\n]*?)\s*[=:]\s*(?P<value>{NUMBER})\b", _FLAGS)
_REMOVED_WORDS = re.compile(r"\b(?:removed|subtracted|corrected)\b", _FLAGS)
_MISSING = re.compile(
    rf"(?:(?:missing|no[ _-]?data|fill)[ _-]*(?:data\s+)?(?P<mark>value|mark|flag)|missing|no[ _-]?data"
    rf"|unspecified)\b.*?(?P<value>{NUMBER})\s*$",
    _FLAGS,
)
_LEAST_MARK = 50.0  # a smaller number after no more than "missing" counts gaps

_ANOTHER_QUANTITY = re.compile(
    r"^\W*(?:\d\s+)?(?:[\w ]{1,24}[:=])?\s*"
    r"(?:(?:(?:un)?corrected|processed|filtered|integrated|ground|relative|absolute)\s+)*"
    r"(?P<quantity>vel(?:oc\w*)?|disp\w*)\.?(?![a-z])\W*"
    r"(?:(?:in\s+)?(?:units\s+of\s+)?[cm]?m(?:\s*/\s*s(?:ec)?|ps)?\W*|(?:time|data|record|history|trace)\b.*"
    r"|in\s+units\b.*)?$",
    _FLAGS,
)
_SPECTRUM = re.compile(r"^\W*(?:\d\s+)?(?:response|fourier)\b.*\bspectr", _FLAGS)


def readable(lines: list[RecordLine]) -> list[RecordLine]:
    """Prepare lines for the lexer: names are left out, labels above their values become one line each.

    K-NET's CSV prints ``#SamplingFrequency(Hz)`` above ``#100``, and ``#OriginTime,Latitude`` above their
    values, all below a title such as ``#Record``.
    """
    readable_lines: list[RecordLine] = []
    title, labels = "", [""]
    for line in lines:
        if len(line.text) > LONGEST_LINE or _NAMES.match(line.text):
            continue
        text = line.text.strip(_MARKS)
        cells = [cell.strip() for cell in text.split(",")]
        if _are_values(cells) and len(cells) == len(labels):
            pairs = zip(labels, cells, strict=True)
            readable_lines.extend(
                replace(line, text=f"{title if label != title else ''} {label}: {value}")
                for label, value in pairs
            )
            continue
        for pattern, canonical in _BOTH:
            text = pattern.sub(canonical, text)
        readable_lines.append(replace(line, text=text))
        title, labels = (text if text.isalpha() else title), cells
    return readable_lines


def _are_values(cells: list[str]) -> bool:
    return all(parse_number(cell) is not None or re.fullmatch(r"[\d/:. -]{8,}", cell) for cell in cells)


def counts(lines: list[RecordLine], report: Report) -> Iterator[Statement[int]]:
    """Read the numbers of samples that lines state."""
    for line in lines:
        matches = (match for pattern in _COUNTS_OF_SAMPLES if (match := pattern.search(line.text)))
        match = next(matches, None)
        if match and _has_value(match) and (count := state_count(match["value"] or "", line.number, report)):
            yield count


def time_steps(lines: list[RecordLine], report: Report) -> Iterator[Statement[float]]:
    """Read the steps and the rates that lines state, as steps [s]."""
    for line in lines:
        for pattern, is_rate in _CLOCKS:
            match = pattern.search(line.text)
            if match and _has_value(match):
                if step := _state_clock(match, ClockUnit(size=1.0, is_frequency=is_rate), line, report):
                    yield step
                break


def _has_value(match: re.Match[str]) -> bool:
    """Tell whether a value follows a label: anything after a sign, only a number without one."""
    groups = match.groupdict()
    value = groups["value"] or ""
    if parse_number(_plain(value)) is None:
        return groups.get("sign", "") is not None and ":" not in value  # a time of day is no time step
    return True


def _plain(text: str | None) -> str:
    """Write a number without separators of thousands or a decimal comma: ``1,024`` and ``0,01``."""
    if text and re.fullmatch(r"0,[0-9]+", text):
        return text.replace(",", ".")
    return text.replace(",", "") if text and re.fullmatch(r"[0-9]{1,3}(?:,[0-9]{3})+", text) else text or ""


def _state_clock(
    match: re.Match[str], default: ClockUnit, line: RecordLine, report: Report
) -> Statement[float] | None:
    groups = match.groupdict()
    units = {find_clock_unit(text) or default for place in ("before", "after") if (text := groups.get(place))}
    if len(units) > 1:
        report.add(
            "The header gives its step or rate in two units",
            line=line.number,
            value=f"{groups['before']} and {groups['after']}",
            remedy="Correct the header",
        )
        return None
    return state_time_step(_plain(groups["value"]), line.number, report, unit=next(iter(units), default))


def durations(lines: list[RecordLine]) -> Iterator[Statement[str]]:
    """Read the durations of a record that lines state, as they print them."""
    for line in lines:
        if match := _DURATION.search(line.text):
            yield Statement(value=match["value"] or "", line=line.number)


def find_units(lines: list[RecordLine], report: Report) -> Iterator[Statement[AccelerationUnit]]:
    """Read the units of the samples that lines state, and report what is no unit of acceleration."""
    for line in lines:
        name = _unit_name(line.text)
        if name and (units := state_units(name, line.number, report)):
            yield units


def _unit_name(text: str) -> str | None:
    """Return what a line calls the units of acceleration, known or not."""
    if match := _ANNOUNCED_UNITS.search(text):
        return match[1]
    if match := _UNITS.search(text):
        return _unit_among(_CODE.sub("", match[1]))
    matches = (match[1] for pattern in _NAMED_UNITS if (match := pattern.search(text)))
    names = (_unit_among(name) or "" for name in matches)
    return next((name for name in names if find_unit(name) or is_another_unit(name)), None)


def is_another_unit(text: str) -> bool:
    """Tell whether a text in brackets is a unit that is not read, as ``in/s2`` or ``0.1 g``."""
    return _ANOTHER_UNIT.search(text) is not None or find_unit(_MULTIPLE.sub("", text)) is not None


def _unit_among(text: str) -> str | None:
    """Return the part of ``s, m/s2`` or ``SEC AND G/10.   MAX = 1 G`` that is a unit, or else all of it."""
    pieces = [piece for piece in _PIECES.split(text) if piece.strip()]
    for piece in pieces:
        words: list[str] = [piece, piece.partition("(")[0], *_FIRST_WORD.findall(piece)[:1]]
        if unit := next((word for word in words if find_unit(word)), None):
            return unit
    has_only_times = all(find_clock_unit(piece.strip(" .)]")) for piece in pieces)
    return None if pieces and has_only_times else text.partition(",")[0]


def peak_units(lines: list[RecordLine]) -> Iterator[Statement[AccelerationUnit]]:
    """Read the units in which lines print the largest acceleration."""
    for line in lines:
        match = _PEAK_UNITS.search(line.text)
        if match and (unit := find_unit(match[1] or match[2])):
            yield Statement(value=unit, line=line.number)


def time_unit(lines: list[RecordLine]) -> ClockUnit | None:
    """Read the unit of a column of times."""
    for line in lines:
        pieces = _PIECES.split(match[1])[:1] if (match := _UNITS.search(line.text)) else []
        for piece in [*pieces, *_TIME_UNIT.findall(line.text)]:
            unit = find_clock_unit(piece.strip())
            if unit and not unit.is_frequency:
                return unit
    return None


@dataclass(frozen=True, kw_only=True)
class Scale:
    """A factor by which the numbers of a file become acceleration."""

    factor: float  # Factor from the numbers to the units
    units: AccelerationUnit | None  # Units of the product, where the factor names them
    line: int  # The line that states it


def scales(lines: list[RecordLine], report: Report) -> Iterator[Scale]:
    """Read the factors that lines state, except those that have been applied already."""
    for line in lines:
        match = _FACTOR.search(line.text)
        if match is None or _APPLIED_WORDS.search(line.text):
            continue
        value, divisor = parse_number(match["value"] or ""), parse_number(match["divisor"] or "1")
        factor = value / divisor if value and divisor else 0.0
        if not 0 < abs(factor) < float("inf"):
            report.add(
                "The scale factor in the header is no number",
                line=line.number,
                value=line.text.strip(),
                remedy="Write a number, or gal over counts such as 3920(gal)/6182761",
            )
        elif match["scale"]:
            unit = find_unit(_COUNTS.sub("", match["unit"])) if match["unit"] else None
            yield Scale(factor=factor, units=unit, line=line.number)
        elif factor != 1:
            report.add(
                "It is unclear whether this factor scales the samples",
                line=line.number,
                value=line.text.strip(),
                remedy="If it does, write 'scale factor: …' instead; if not, delete the words that state it",
            )


def offsets(lines: list[RecordLine]) -> dict[str, Statement[float]]:
    """Read the numbers that stand for no acceleration, by the columns that lines name, if any."""
    statement_of_column: dict[str, Statement[float]] = {}
    for line in lines:
        match = _OFFSET.search(line.text)
        value = parse_number(match["value"]) if match else None
        if match and value and not _REMOVED_WORDS.search(line.text):
            statement_of_column[match["column"].strip()] = Statement(value=value, line=line.number)
    return statement_of_column


def missing_marks(lines: list[RecordLine]) -> tuple[float, ...]:
    """Read the numbers that mark missing samples."""
    marks = []
    for line in lines:
        match = _MISSING.search(line.text)
        mark = parse_number(match["value"]) if match else None
        if match and mark is not None and (match["mark"] or abs(mark) >= _LEAST_MARK):
            marks.append(mark)
    return tuple(marks)


def refuse_another_quantity(lines: list[RecordLine], report: Report) -> list[RecordLine]:
    """Report lines that announce velocity, displacement or a spectrum, and return the others."""
    quantities = [_another_quantity(line.text) for line in lines]
    for line, quantity in zip(lines, quantities, strict=True):
        if quantity:
            report.add(
                "Not a record of acceleration",
                line=line.number,
                value=quantity,
                remedy="Use the file of the acceleration",
            )
    return [line for line, quantity in zip(lines, quantities, strict=True) if not quantity]


def _another_quantity(text: str) -> str:
    """Name the quantity that a line announces in place of acceleration; empty where it does not."""
    if match := _ANOTHER_QUANTITY.match(text):
        return "velocity" if match["quantity"][0] in "vV" else "displacement"
    return "a spectrum" if _SPECTRUM.match(text) else ""


def state_count(text: str, line: int, report: Report) -> Statement[int] | None:
    """Read a number of samples, or report that the text is not one."""
    if re.fullmatch(r"\+?[0-9]{1,9}\.?", plain := _plain(text)):
        count = int(plain.rstrip("."))
        if count > 1:
            return Statement(value=count, line=line)
    report.add(
        "The header's number of samples is no whole number of at least 2",
        line=line,
        value=text or "nothing",
        remedy="Correct the header",
    )
    return None


def state_time_step(text: str, line: int, report: Report, *, unit: ClockUnit) -> Statement[float] | None:
    """Read a time step or a rate in a unit, or report that the text is not one."""
    value = parse_number(text)
    if value is not None and value > 0:
        step = unit.convert_to_seconds(value)
        if 0 < step < float("inf"):
            tolerance = 0.0 if unit.is_frequency else last_place(text) * unit.size
            return Statement(value=step, line=line, tolerance=tolerance)
    report.add(
        "The header's time step is no positive number",
        line=line,
        value=text or "nothing",
        remedy="Correct the header or leave the record out",
    )
    return None


def state_units(text: str, line: int, report: Report) -> Statement[AccelerationUnit] | None:
    """Read the units of the samples, or report that the text names none."""
    unit = find_unit(text)
    if unit is not None:
        return Statement(value=unit, line=line)
    report.add(
        "Unknown unit of acceleration",
        line=line,
        value=repr(text.strip()),
        remedy="Use g, cm/s2, m/s2, mm/s2 or g/10, and convert the record if necessary",
    )
    return None
