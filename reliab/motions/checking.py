"""Check whole folders of records and report every fault at once."""

import hashlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

import numpy as np

from reliab.errors import InputError
from reliab.motions.catalogue import CATALOGUE, read_catalogue
from reliab.motions.faults import Fault, Report
from reliab.motions.loading import (
    BUILT_IN,
    UNREAD,
    declare,
    load_motions,
    motion_name,
    scan_file,
    scan_folder,
    unread_files,
)
from reliab.motions.readers.reading import Declared, Reading
from reliab.motions.readers.source import is_file, is_folder
from reliab.motions.record import RecordFile
from reliab.significant import significant
from reliab.vocabulary import STANDARD_GRAVITY

_LIKENESS = 50.0
"""Largest factor between a peak and the median of its folder; g is 981 cm/s2, and m/s2 is 100 cm/s2."""
_DECIMALS = 4  # of samples over their peak, in which scaled copies agree
_FEWEST = 3  # fewest records for which the peaks are compared with their median


@dataclass(frozen=True, kw_only=True)
class Inspection:
    """Outcome of checking a source of motions."""

    records: int  # Number of motions that were checked
    faults: list[Fault]  # Everything that is wrong, in the order of the catalogue or of the paths
    # Points to check that are not faults: files in formats that are not read, peaks that differ much from the
    # others although the files state their units, and one record in several files
    notes: list[Fault] = field(default_factory=list)


@dataclass(frozen=True, kw_only=True)
class _Peak:
    """Peak [m/s²] of a record, whether the file states its units, and whether a catalogue confirms them."""

    file: str
    value: float
    has_units: bool
    confirmed: bool


def inspect(
    path: str | Path,
    *,
    sets: Sequence[str] | None = None,
    time_step: float | None = None,
    units: str | None = None,
) -> Inspection:
    """Read every record of a folder, report every fault of every file, and count the records.

    Parameters
    ----------
    path : str or Path
        A folder with or without a catalogue, one file, or the name of a built-in suite.
    sets : sequence of str, optional
        Sets of the catalogue to check; None checks all, including the set ``held_out``.
    time_step : float, optional
        Step of the records [s], where their headers state none.
    units : str, optional
        Units of the records, where their headers state none.

    Returns
    -------
    Inspection
        Its `faults` are empty if there is no fault.

    Raises
    ------
    InputError
        If the path does not exist.

    Notes
    -----
    Beyond the rules for each file, the peaks in one folder are compared: one that differs from their median
    by more than a factor of 50 is a fault where the units of the record are those that were given here, which
    may mix units; where the file states them it is a note; where a catalogue confirms them it is neither.
    """
    if path in BUILT_IN:
        return Inspection(records=len(list(load_motions(path))), faults=[])
    source, declared = Path(path), declare(time_step, units)
    if not (is_folder(source) or is_file(source)):
        raise InputError(
            "A source of motions must exist", value=str(path), remedy="Name a folder of records or one file"
        )
    faults: list[Fault] = []
    peaks: list[_Peak] = []
    copies: list[Fault] = []
    first: dict[str, str] = {}
    checked = 0
    for record, report in _records(source, declared, faults):
        if sets is not None and record.set_name not in sets:
            continue
        checked += 1
        reading = record.read(report)
        faults.extend(report.faults)
        if reading is not None:
            value = float(np.abs(reading.acceleration).max())
            confirmed = record.declared.units is not None and declared.units is None
            peaks.append(
                _Peak(file=report.file, value=value, has_units=reading.units_stated, confirmed=confirmed)
            )
            original = first.setdefault(_digest(reading), record.name)
            if original != record.name:
                copies.append(_copy(report.file, original))
    if not checked and not faults:
        faults.append(_no_records(source, sets))
    unlike = list(_unlike_peaks(peaks))
    mixed = [fault for has_units, fault in unlike if not has_units]
    notes = [*_unread(source), *(fault for has_units, fault in unlike if has_units), *copies]
    return Inspection(records=checked, faults=list(dict.fromkeys([*faults, *mixed])), notes=notes)


def _records(source: Path, declared: Declared, faults: list[Fault]) -> Iterator[tuple[RecordFile, Report]]:
    """Find the records, each with a new report, and collect the faults of catalogues and headers."""
    catalogue = source / CATALOGUE
    if is_file(catalogue):
        report = Report(file=str(catalogue))
        records_of_catalogue = read_catalogue(catalogue, report, declared)
        faults.extend(report.faults)
        scanned: Iterable[tuple[Path, list[RecordFile], Report]] = [
            (record.path, [record], Report(file=str(record.path))) for record in records_of_catalogue
        ]
    elif is_folder(source):
        scanned = scan_folder(source, declared)
    else:
        report = Report(file=str(source))
        scanned = [(source, scan_file(source, motion_name(Path(source.name)), declared, report), report)]
    for path, records, report in scanned:
        if not records:
            faults.extend(report.faults)
        for record in records:
            yield record, Report(file=str(path))


def _no_records(source: Path, sets: Sequence[str] | None) -> Fault:
    return Fault(
        file=str(source),
        line=None,
        rule="A source of motions must hold a record",
        value="none" if sets is None else f"none in the sets {', '.join(sets)}",
        remedy=f"Put records or a {CATALOGUE} into it",
    )


def _unread(source: Path) -> Iterator[Fault]:
    """Name data files of a folder without a catalogue whose format is not read."""
    if not is_folder(source) or is_file(source / CATALOGUE):
        return
    for path in unread_files(source):
        yield Fault(
            file=str(path),
            line=None,
            rule="A record must be in a format that is read",
            value=UNREAD[path.suffix.lower()],
            remedy="Skipped; export it as text or CSV if it is a record",
        )


def _digest(reading: Reading) -> str:
    """Digest of a record that its scaled copies share, up to the rounding of their text."""
    peak = float(np.abs(reading.acceleration).max()) or 1.0
    digest = hashlib.sha256(np.float64(reading.time_step).tobytes())
    digest.update((np.round(reading.acceleration / peak, _DECIMALS) + 0.0).tobytes())
    return digest.hexdigest()


def _copy(file: str, original: str) -> Fault:
    return Fault(
        file=file,
        line=None,
        rule="Each record should be there once",
        value=f"the same record as {original}, as it is or scaled",
        remedy="Keep one: a criterion counts equal copies once, but a scaled one as a record of its own",
    )


def _unlike_peaks(peaks: list[_Peak]) -> Iterator[tuple[bool, Fault]]:
    """Peaks far from the median of their folder, and whether the file states its units."""
    if len(peaks) < _FEWEST:
        return
    middle = median(peak.value for peak in peaks)
    for peak in peaks:
        if not peak.confirmed and not middle / _LIKENESS <= peak.value <= middle * _LIKENESS:
            remedy = "confirm a true peak by the column units of a catalogue"
            fault = Fault(
                file=peak.file,
                line=None,
                rule=f"Peaks in one folder must lie within a factor of {_LIKENESS:g} of their median",
                value=f"{significant(peak.value / STANDARD_GRAVITY)} g against "
                f"{significant(middle / STANDARD_GRAVITY)} g",
                remedy=f"A weak record, or wrong units in its header; {remedy}"
                if peak.has_units
                else f"Check for mixed units; {remedy}",
            )
            yield peak.has_units, fault
