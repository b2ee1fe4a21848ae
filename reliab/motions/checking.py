"""Check whole folders of records and report every fault at once."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.catalogue import CATALOGUE, RecordFile
from reliab.motions.faults import MotionFault, Report
from reliab.motions.loading import BUILT_IN, declare, list_skipped_files, load_motions, scan
from reliab.motions.motion import are_copies, outline_of
from reliab.motions.readers.reading import AccelerationReading, RecordDeclaration
from reliab.motions.readers.source import is_file, is_folder

_FEWEST_SAMPLES = 100  # samples, below which a record tells nothing of these
_EQUAL = 1e-6  # of the peak, up to which two samples are the same
_FLAT = 3  # equal samples that make a flat top
_EDGE = 0.02  # of the peak, by which a clipped top differs from the sample before or after it
_STEPS = 4  # of the resolution, by which it does so at least
_DRIFT = 0.5  # of the largest velocity without the drift, from which a final velocity is one
_SHARPNESS = 3.0  # times the sharpness of what surrounds it, from which a sample is a spike
_RETURN = 0.5  # of its sharpness, by which the samples before and after a spike may differ
_SURROUNDINGS = 50  # samples before and after
_LEAST_SPIKE = 0.1  # of the peak
_FEWEST_EQUAL_SAMPLES = 10  # equal samples in the strong part that are held
_STRONG = (0.05, 0.95)  # of the squared acceleration


def find_flaws(acceleration: Array, time_step: float) -> Iterator[tuple[str, str]]:
    """Yield each flaw of a record with what to do about it.

    `acceleration` (n,) [m/s²]; `time_step` [s].
    """
    peak = float(np.abs(acceleration).max())
    runs = _equal_runs(acceleration, _EQUAL * peak)
    steps = np.diff(np.unique(acceleration))
    edge = max(_EDGE * peak, _STEPS * float(steps[steps > _EQUAL * peak].min(initial=peak)))
    tops = [run for run in runs if _is_clipped(acceleration, run, _EQUAL * peak, edge)]
    if tops:
        samples = sum(stop - start for start, stop in tops)
        value = f"flat tops, {samples} samples at the largest values: clipped by the recorder"
        yield value, "Leave it out: the peaks are lost"
    yield from _find_drift(acceleration, time_step)
    yield from _find_spikes(acceleration, time_step, peak)
    energy = np.cumsum((acceleration - acceleration.mean()) ** 2)
    strong = np.searchsorted(energy, np.array(_STRONG) * energy[-1])
    flat_runs = [
        run
        for run in runs
        if run not in tops and run[1] - run[0] >= _FEWEST_EQUAL_SAMPLES and strong[0] <= run[0] < strong[1]
    ]
    if flat_runs:
        start, stop = max(flat_runs, key=lambda run: run[1] - run[0])
        value = f"{significant(float(acceleration[start]))} m/s² held from {start * time_step:.2f} s"
        remedy = "Compare it with the original record"
        yield f"{value} for {stop - start} samples: a gap that was filled?", remedy


def _equal_runs(acceleration: Array, tolerance: float) -> list[tuple[int, int]]:
    """First sample, and the one after the last, of each run of equal samples."""
    equal = np.abs(np.diff(acceleration)) <= tolerance
    edges = np.flatnonzero(np.diff(np.concatenate([[False], equal, [False]]).astype(np.int8)))
    return [(int(start), int(stop) + 1) for start, stop in edges.reshape(-1, 2) if stop + 1 - start >= _FLAT]


def _is_clipped(acceleration: Array, run: tuple[int, int], tolerance: float, edge: float) -> bool:
    """Tell whether a run of equal samples is an extreme that the record enters or leaves with a jump."""
    start, stop = run
    value = acceleration[start]
    if min(abs(value - acceleration.max()), abs(value - acceleration.min())) > tolerance:
        return False
    around = acceleration[[max(start - 1, 0), min(stop, acceleration.size - 1)]]
    return bool(np.abs(around - value).max() >= edge)


def _find_drift(acceleration: Array, time_step: float) -> Iterator[tuple[str, str]]:
    steps = 0.5 * (acceleration[1:] + acceleration[:-1]) * time_step
    velocity = np.concatenate([[0.0], np.cumsum(steps)])
    final = float(velocity[-1])
    largest = float(np.abs(velocity - final * np.linspace(0.0, 1.0, velocity.size)).max())
    if abs(final) > _DRIFT * largest:
        offset = significant(final / (time_step * (acceleration.size - 1)))
        value = f"velocity that ends at {significant(final)} m/s: an offset of {offset} m/s², or a cut"
        yield value, "Correct the baseline, or leave it out"


def _find_spikes(acceleration: Array, time_step: float, peak: float) -> Iterator[tuple[str, str]]:
    """Find samples that stand alone, far from those before and after, which are much alike."""
    padded_acceleration = np.pad(acceleration, 1)
    sharpness = np.abs(acceleration - 0.5 * (padded_acceleration[:-2] + padded_acceleration[2:]))
    padded_sharpness = np.pad(sharpness, _SURROUNDINGS + 1)  # a spike makes the samples beside it sharp, too
    windows = np.lib.stride_tricks.sliding_window_view(padded_sharpness, _SURROUNDINGS).max(axis=1)
    around = np.maximum(windows[: sharpness.size], windows[_SURROUNDINGS + 3 :])
    returns = np.abs(padded_acceleration[2:] - padded_acceleration[:-2]) < _RETURN * sharpness
    spikes = np.flatnonzero(returns & (sharpness > np.maximum(_SHARPNESS * around, _LEAST_SPIKE * peak)))
    if spikes.size:
        sample = int(spikes[np.abs(acceleration[spikes]).argmax()])
        count_text = f" and {spikes.size - 1} more" if spikes.size > 1 else ""
        height = significant(float(acceleration[sample]))
        value = f"a single spike of {height} m/s² at {sample * time_step:.2f} s{count_text}"
        yield value, "Remove it, unless the ground moved like this"


_LIKENESS = 50.0
"""Largest factor between a peak and the median of its folder; g is 981 cm/s2, and m/s2 is 100 cm/s2."""
_PEAK_TOLERANCE = 2e-3  # largest difference between the peaks of equal records whose texts round them
_FEWEST = 3  # fewest records for which the peaks are compared with their median


@dataclass(frozen=True, kw_only=True)
class Inspection:
    """Outcome of checking a source of motions."""

    records: int  # Number of motions that were checked
    faults: list[MotionFault]  # Everything that is wrong, in the order of the catalogue or of the paths
    # Points to check that are not faults: files that were skipped, peaks that differ much from the others
    # although the files state their units, what headers say of their numbers, flaws of the samples, copies
    notes: list[MotionFault] = field(default_factory=list)


def inspect(
    path: str | Path,
    *,
    sets: Sequence[str] | None = None,
    time_step: float | None = None,
    units: str | None = None,
) -> Inspection:
    """Read every record of a folder, report every fault of every file, and count the records.

    `path`: a folder with or without a catalogue, one file, or the name of a built-in suite; `sets`: sets of
    the catalogue to check; None checks all, including the set ``held_out``; `time_step`: step of the records
    [s], where their headers state none; `units`: units of the records, where their headers state none.
    Its `faults` are empty if there is no fault.

    Beyond the rules for each file, the peaks in one folder are compared: one that differs from their median
    by more than a factor of 50 is a fault where the units of the record are those that were given here, which
    may mix units; where the file states them it is a note; where a catalogue confirms them it is neither.
    """
    if path in BUILT_IN:
        return Inspection(records=len(list(load_motions(path))), faults=[])
    source, declaration = Path(path), declare(time_step, units)
    if not (is_folder(source) or is_file(source)):
        raise InputError(
            f"{path} not found", remedy="Name a folder of records, a file or the built-in suite synthetic"
        )
    faults: list[MotionFault] = []
    peaks: list[tuple[str, float, bool, bool]] = []
    notes: list[MotionFault] = []
    known: dict[str, tuple[str, float]] = {}
    checked_count = 0
    for record, report in _records(source, declaration, faults):
        if sets is not None and record.set_name not in sets:
            continue
        checked_count += 1
        reading = record.read(report)
        faults.extend(report.faults)
        if reading is not None:
            peak = float(np.abs(reading.acceleration).max())
            is_confirmed = record.declared.units is not None and declaration.units is None
            peaks.append((report.file, peak, reading.units_stated, is_confirmed))
            notes.extend(_notes(record, reading, known))
    if not checked_count and not faults:
        faults.append(_no_records(source, sets))
    unlike = list(_unlike_peaks(peaks))
    unitless_faults = [fault for has_units, fault in unlike if not has_units]
    weak = [fault for has_units, fault in unlike if has_units]
    return Inspection(
        records=checked_count,
        faults=list(dict.fromkeys([*faults, *unitless_faults])),
        notes=[*list_skipped_files(source), *weak, *notes],
    )


def _notes(
    record: RecordFile, reading: AccelerationReading, known: dict[str, tuple[str, float]]
) -> Iterator[MotionFault]:
    """Note what was applied to a record, the flaws of its samples, and whether it is a copy of one of those.

    `known`: outline and peak of each record so far.
    """
    channel = f"channel {record.channel}: " if record.channel else ""

    def note(rule: str, value: str, remedy: str) -> MotionFault:
        return MotionFault(
            file=str(record.path), line=None, rule=rule, value=f"{channel}{value}", remedy=remedy
        )

    for correction in reading.corrections:
        yield note("Applied what the header states", correction, "Check that this is meant")
    if reading.acceleration.size < _FEWEST_SAMPLES:
        return
    for value, remedy in find_flaws(reading.acceleration, reading.time_step):
        yield note("Suspicious samples", value, remedy)
    outline = outline_of(reading.acceleration, reading.time_step)
    peak = float(reading.acceleration[np.abs(reading.acceleration).argmax()])
    outlines = [other for other, _ in known.values()]
    if known and (are_copy := are_copies([outline], outlines)[0]).any():
        original, (_, its_peak) = list(known.items())[int(are_copy.argmax())]
        factor = peak / its_peak
        scale = "" if abs(abs(factor) - 1) < _PEAK_TOLERANCE else f" times {significant(abs(factor))}"
        reversal = " with its sign reversed" if factor < 0 else ""
        yield note(
            "Duplicate record",
            f"the same record as {original}{scale}{reversal}",
            "Keep one: a criterion counts copies once",
        )
    else:
        known[record.name] = outline, peak


def _records(
    source: Path, declaration: RecordDeclaration, faults: list[MotionFault]
) -> Iterator[tuple[RecordFile, Report]]:
    """Find the records, each with a new report, and collect the faults of catalogues and headers."""
    for path, records, report in scan(source, declaration):
        if not records:
            faults.extend(report.faults)
        for record in records:
            yield record, Report(file=str(path))


def _no_records(source: Path, sets: Sequence[str] | None) -> MotionFault:
    return MotionFault(
        file=str(source),
        line=None,
        rule="No records found" if sets is None else f"No records in the sets {', '.join(sets)}",
        remedy=f"Put records or a {CATALOGUE} into it",
    )


def _unlike_peaks(peaks: list[tuple[str, float, bool, bool]]) -> Iterator[tuple[bool, MotionFault]]:
    """Peaks far from the median of their folder, and whether the file states its units.

    `peaks`: of each record its file, the peak [m/s²], whether the file states its units, and whether a
    catalogue confirms them.
    """
    if len(peaks) < _FEWEST:
        return
    middle = median(peak for _, peak, _, _ in peaks)
    for file, peak, has_units, is_confirmed in peaks:
        if not is_confirmed and not middle / _LIKENESS <= peak <= middle * _LIKENESS:
            remedy = "confirm a true peak by the column units of a catalogue"
            fault = MotionFault(
                file=file,
                line=None,
                rule=f"The peak differs from the median of its folder by more than a factor of {_LIKENESS:g}",
                value=f"{significant(peak / STANDARD_GRAVITY)} g against "
                f"{significant(middle / STANDARD_GRAVITY)} g",
                remedy=f"Check whether the record is weak or its header states wrong units; {remedy}"
                if has_units
                else f"Check for mixed units; {remedy}",
            )
            yield has_units, fault
