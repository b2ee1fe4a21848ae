"""Turn a header and its samples into an acceleration record, and check both."""

from dataclasses import dataclass, replace

import numpy as np

from reliab.core.arrays import Array
from reliab.core.text_tables import last_place, missing_mark
from reliab.core.units import AccelerationUnit
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.faults import Report
from reliab.motions.motion import PEAK_LIMIT_G
from reliab.motions.readers.source import (
    RecordHeader,
    RecordText,
    Statement,
    count_rows,
    line_of_sample,
    may_round,
    parse_samples,
    separate_numbers,
    split_line,
)


@dataclass(frozen=True, kw_only=True)
class RecordDeclaration:
    """Data on a record that a catalogue or a caller gives beside the record's own header."""

    time_step: float | None = None  # True step [s], which may correct a rounded one
    units: AccelerationUnit | None = None  # Units of the samples
    header_count: int | None = None  # Number of samples that the header should state
    header_time_step: float | None = None  # Step that the header should state [s]
    location: str = "the arguments"  # Source of these data, for messages


@dataclass(frozen=True, kw_only=True)
class AccelerationReading:
    """An acceleration record as it was read."""

    acceleration: Array  # Samples [m/s²], shape (n,)
    time_step: float  # Interval between samples [s]
    event: str  # The earthquake, where the header identifies it
    units_stated: bool = True  # Whether the file itself, or its format, says in which units its samples are
    corrections: tuple[str, ...] = ()  # What the header says of its numbers and was applied, in words


@np.errstate(over="ignore", invalid="ignore")
def complete(
    source: RecordText, header: RecordHeader, declaration: RecordDeclaration, report: Report
) -> AccelerationReading | None:
    """Read the samples that a header announces and turn them into acceleration."""
    sound = not report.faults
    units = _settle_units(header, declaration, report, sound=sound)
    values, header = _read_samples(source, header, report)
    has_times = header.time_column is not None
    time_step = _settle_time_step(header, declaration, report, sound=sound and not has_times)
    _check_against_catalogue(header, declaration, report)
    if values is not None:
        values = _settle_count(source, header, values, report)
    if values is None or units is None or time_step is None:
        return None
    acceleration = _convert_to_si(source, header, values, units, report)
    if report.faults:
        return None
    return AccelerationReading(
        acceleration=acceleration,
        time_step=time_step,
        event=header.event,
        units_stated=header.units is not None or header.default_units is not None,
        corrections=header.corrections,
    )


def _read_samples(
    source: RecordText, header: RecordHeader, report: Report
) -> tuple[Array | None, RecordHeader]:
    """Read the numbers of a header's component; with times beside them, the header gets their step."""
    if header.values is not None:
        if np.isfinite(header.values).all():
            return header.values, header
        report.add(
            "Samples are missing", value="NaN or infinity", remedy="Fill the gap or leave the record out"
        )
        return None, header
    regular = check_columns(source, header, report)
    numbers = parse_samples(source, header, report)
    if numbers is None or not regular or header.columns in {None, 1}:
        return numbers if regular else None, header
    rows = numbers[: numbers.size // header.columns * header.columns].reshape(-1, header.columns)
    if not header.has_rows and header.count:
        rows = rows[: max(header.count.value, len(rows) - _PAIRS_OF_A_LINE)]  # without padding
    samples = rows[:, header.column]
    if header.time_column is None:
        return samples, header
    return split_times(source, header, rows[:, header.time_column], samples, report)


def _settle_units(
    header: RecordHeader, declaration: RecordDeclaration, report: Report, *, sound: bool
) -> AccelerationUnit | None:
    """Find the units; if the header already has a fault, missing units are not reported again."""
    header_units = header.units
    if header_units is not None and declaration.units not in {None, header_units.value}:
        report.add(
            "The header contradicts the stated units",
            line=header_units.line,
            value=f"{header_units.value} in the header, {declaration.units} in {declaration.location}",
            remedy="Correct whichever is wrong",
        )
        return None
    units = header_units.value if header_units is not None else declaration.units or header.default_units
    if units is None and sound:
        report.add(
            "No units stated",
            remedy="State them with `units`, in a line such as # units: g, or in a catalogue",
        )
    return units


def _settle_time_step(
    header: RecordHeader, declaration: RecordDeclaration, report: Report, *, sound: bool
) -> float | None:
    header_step = header.time_step
    if header_step is None:
        if declaration.time_step is None and sound:
            report.add(
                "No time step stated",
                remedy="Give `time_step` in seconds, or a column dt_s in a catalogue",
            )
        return declaration.time_step
    if declaration.time_step is None:
        if not _SHORTEST_STEP * (1 - _EXACT) <= header_step.value <= _LONGEST_STEP * (1 + _EXACT):
            report.add(
                f"Implausible time step: those of records are {_SHORTEST_STEP:g} to {_LONGEST_STEP:g} s",
                line=header_step.line,
                value=f"{header_step.value:.6g} s",
                remedy="Correct the header or state its unit, such as 10 ms, 0.1 kHz or time [ms]; "
                "if the step is right, confirm it with `time_step` or a column dt_s in a catalogue",
            )
            return None
        return header_step.value
    if not may_round(declaration.time_step, header_step):
        report.add(
            "The header contradicts the stated time step",
            line=header_step.line,
            value=f"{header_step.value:g} s in the header, {declaration.time_step:g} s in "
            f"{declaration.location}",
            remedy="Correct whichever is wrong",
        )
        return None
    return declaration.time_step


def _check_against_catalogue(header: RecordHeader, declaration: RecordDeclaration, report: Report) -> None:
    count, step = header.count, header.time_step
    if count is not None and declaration.header_count not in {None, count.value}:
        report.add(
            "The header and the catalogue state different numbers of samples",
            line=count.line,
            value=f"{count.value} in the header, {declaration.header_count} in {declaration.location}",
            remedy="Check that the catalogue names the right file",
        )
    catalogue_step = declaration.header_time_step
    if step is not None and catalogue_step is not None and not may_round(catalogue_step, step):
        report.add(
            "The header and the catalogue state different time steps",
            line=step.line,
            value=f"{step.value:g} s in the header, {catalogue_step:g} s in {declaration.location}",
            remedy="Check that the catalogue names the right file",
        )


def _settle_count(source: RecordText, header: RecordHeader, values: Array, report: Report) -> Array | None:
    samples, count = values.size, header.count
    last_line = source.line_number(max(header.start, header.stop - 1))
    if count is None:
        if samples > 1:
            return values
        report.add(
            "Too few samples",
            line=last_line,
            value=samples,
            remedy="Export or download the file again, or leave it out",
        )
        return None
    if samples < count.value:
        report.add(
            "Fewer samples than the header states",
            line=last_line,
            value=f"{samples} of {count.value}",
            remedy="The file was cut short: export or download it again",
        )
        return None
    if samples > count.value and line_of_sample(source, header, samples - 1) != line_of_sample(
        source, header, count.value - 1
    ):
        report.add(
            "More samples than the header states",
            line=line_of_sample(source, header, count.value),
            value=f"{samples} instead of {count.value}",
            remedy="Check whether two records were joined, or correct the header",
        )
        return None
    return values[: count.value]


def _convert_to_si(
    source: RecordText, header: RecordHeader, values: Array, units: AccelerationUnit, report: Report
) -> Array:
    _check_gaps(source, header, values, report)
    if header.remove_mean:
        values = values - values.mean()
    if header.offset:
        values = values - header.offset
    acceleration = values * (header.scale * units.si_factor)
    if not acceleration.any():
        report.add(
            "All samples are zero",
            line=source.line_number(header.start),
            remedy="Leave it out",
        )
    largest = int(np.abs(acceleration).argmax())
    peak = abs(float(acceleration[largest])) / STANDARD_GRAVITY
    if not peak <= PEAK_LIMIT_G:
        report.add(
            f"Implausible peak, above {PEAK_LIMIT_G:g} g",
            line=line_of_sample(source, header, largest),
            value=f"{peak:.4g} g with samples in {units}",
            remedy="Check the units; cm/s2 read as g is 981 times too large",
        )
    return acceleration


def _check_gaps(source: RecordText, header: RecordHeader, values: Array, report: Report) -> None:
    missing_value = missing_mark(values, any_repeated=True)
    marks = [*header.missing, *([] if missing_value is None else [missing_value])]
    gaps = np.flatnonzero(np.isin(values, marks)) if marks else np.array([])
    if gaps.size:
        report.add(
            "The record has gaps",
            line=line_of_sample(source, header, int(gaps[0])),
            value=f"the mark of a missing sample, {values[gaps[0]]:g}"
            + (f", {gaps.size} times" if gaps.size > 1 else ""),
            remedy="Fill the gap or leave the record out",
        )


_EXACT = 1e-9  # relative rounding of a step in double precision
_SHORTEST_STEP, _LONGEST_STEP = 0.0005, 0.1  # s; between them lie the steps of accelerograms
_PAIRS_OF_A_LINE = 5  # times and samples, one pair after the other
_JITTER = 0.01  # largest error of a time, as a share of the step
_DIGITS = 12  # significant digits to which a step is known from times in double precision
_MILLI = 1000  # how much too large times are that are milliseconds


def check_columns(source: RecordText, header: RecordHeader, report: Report) -> bool:
    """Tell whether every line has the columns that the header expects; report the first that has not."""
    data = separate_numbers(source, header)
    column_count = header.columns if header.has_rows else None
    if column_count is None or len(data.split()) == column_count * count_rows(data):
        return True
    for line in source.lines(header.start, header.stop):
        tokens = split_line(line, header)
        if tokens and len(tokens) != column_count:
            report.add(
                "The number of columns changes",
                line=line.number,
                value=f"{len(tokens)} instead of {column_count}",
                remedy="Correct the line",
            )
            break
    return False


def split_times(
    source: RecordText, header: RecordHeader, times: Array, samples: Array, report: Report
) -> tuple[Array | None, RecordHeader]:
    """Find the step between times; sample numbers in their place have none.

    Times may differ from equal steps by their rounding or by 1 % of the step; any start time is allowed.

    `times`, `samples` (n,).
    """
    if times.size < 2:  # noqa: PLR2004 - a step needs two times
        return samples, header
    if header.time_unit is None and (np.diff(times) == 1).all():
        corrections = (*header.corrections, "column of sample numbers left out")
        return samples, replace(header, time_column=None, corrections=corrections)
    place = _rounding(source, header, times.size)
    step = float(f"{(times[-1] - times[0]) / (times.size - 1):.{_DIGITS}g}")
    faulty = _first_unequal(times, step, place)
    unit = header.time_unit.size if header.time_unit else 1.0
    if faulty is not None:
        report.add(
            "The times do not increase by equal steps",
            line=line_of_sample(source, header, faulty),
            value=f"{times[faulty] * unit:.12g} s after {times[faulty - 1] * unit:.12g} s",
            remedy="Interpolate the record at equal steps; check that the columns are time and acceleration",
        )
        return None, header
    if unit != 1:
        header = replace(header, corrections=(*header.corrections, f"times in units of {unit:g} s"))
    return samples, _set_step(source, header, step * unit, place * unit / (times.size - 1), report)


def _first_unequal(times: Array, step: float, place: float) -> int | None:
    """Index of the first time that does not follow the previous one by one step."""
    backwards = np.flatnonzero(np.diff(times) <= 0)
    if backwards.size:
        return int(backwards[0]) + 1
    if not np.isfinite(step):
        return 1
    off = np.abs(times - times[0] - step * np.arange(times.size)) > max(place, _JITTER * step)
    if not off.any():
        return None
    steps = np.diff(times)
    return int(np.abs(steps - np.median(steps)).argmax()) + 1


def _rounding(source: RecordText, header: RecordHeader, count: int) -> float:
    """One unit in the last printed place of the times."""
    tokens = separate_numbers(source, header).decode("latin-1").split()
    if len(tokens) < count * (header.columns or 1):  # some follow each other without a blank
        lines = source.lines(header.start, header.stop)
        tokens = [token for line in lines for token in split_line(line, header)]
    times = tokens[header.time_column :: header.columns][:count]
    if "E" in times[-1].upper():
        return last_place(times[-1])
    return min(10.0 ** -len(token.partition(".")[2]) for token in times)


def _set_step(
    source: RecordText, header: RecordHeader, step: float, tolerance: float, report: Report
) -> RecordHeader:
    line = source.line_number(header.start)
    header_step = header.time_step
    if header_step is None:
        return replace(header, time_step=Statement(value=step, line=line, tolerance=tolerance))
    if not may_round(step, header_step):
        milliseconds = may_round(step / _MILLI, header_step)
        report.add(
            "The header contradicts the column of times",
            line=header_step.line,
            value=f"{header_step.value:g} s in the header, {step:g} s between the times",
            remedy="State the unit in the name of the column of times: time [ms]"
            if milliseconds
            else "Correct the header",
        )
    return header
