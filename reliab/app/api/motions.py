"""Ground motions listed, checked and rewritten as a suite; and the synthetic suite, which needs no record."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from reliab.app.api.sources import Files, listed, paths
from reliab.core.errors import InputError
from reliab.core.rows import ResultWithRows
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.checking import inspect
from reliab.motions.faults import Fault, fault_of
from reliab.motions.intensity import measure
from reliab.motions.loading import find_motions, load_motions, skipped_files
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.motions.writing import write_suite
from reliab.sweep.several import Names


@dataclass(frozen=True)
class MotionList(ResultWithRows):
    """Ground motions with their measures of intensity.

    `rows`: name, event, set, time step [s], duration [s], peak [g], Arias intensity [m/s], significant
    duration [s], mean period [s] and checksum of each; `faults`: what is wrong with the records that are
    left out; `skipped`: files in formats that are not read.
    """

    rows_in = "motions"

    rows: list[dict[str, Any]]
    faults: tuple[Fault, ...] = ()
    skipped: tuple[Fault, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `motions`, the rows; `faults` and `skipped`."""
        return {
            "motions": self.rows,
            "faults": [asdict(fault) for fault in self.faults],
            "skipped": [asdict(fault) for fault in self.skipped],
        }


def list_motions(
    sources: Files, *, sets: Names | None = None, time_step: float | None = None, units: str | None = None
) -> MotionList:
    """List motions with their events and measures of intensity; records with faults are left out and named.

    Parameters
    ----------
    sources : str, pathlib.Path or sequence of these
        Files, folders or a built-in suite.
    sets : str or sequence of str, optional
        Sets of their catalogue; the set held_out is left out unless it is named.
    time_step : float, optional
        Step [s], where files state none.
    units : {"g", "cm/s2", "m/s2"}, optional
        Units, where files state none.

    Returns
    -------
    MotionList
        The motions, one row each, and what was left out.

    Raises
    ------
    InputError
        If no record is sound or a set is not in the catalogue.

    Examples
    --------
    >>> len(list_motions("synthetic").rows)
    100
    """
    named = paths(sources)
    suite, found = find_motions(*named, sets=listed(sets), time_step=time_step, units=units)
    rows, faults = [], list(found)
    for entry in suite.entries:
        try:
            rows.append(_describe(entry.load()))
        except InputError as error:
            faults.append(fault_of(error, entry.name))
    if not rows:
        raise faults[0].error()
    skipped = [note for source in named for note in skipped_files(source)]
    return MotionList(rows, tuple(faults), tuple(skipped))


def _describe(motion: Motion) -> dict[str, Any]:
    intensity = measure(motion)
    return {
        "motion": motion.name,
        "event": motion.event,
        "set": motion.set_name,
        "time_step": motion.time_step,
        "samples": motion.acceleration.size,
        "duration": motion.duration,
        "pga_g": intensity.peak_acceleration / STANDARD_GRAVITY,
        "arias_intensity": intensity.arias_intensity,
        "significant_duration": intensity.significant_duration,
        "mean_period": intensity.mean_period,
        "checksum": motion.checksum,
    }


@dataclass(frozen=True, kw_only=True)
class MotionCheck:
    """What is wrong with records, and what deserves a look."""

    records: int
    faults: tuple[Fault, ...]
    notes: tuple[Fault, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `records`, `faults` and `notes`."""
        return {
            "records": self.records,
            "faults": [asdict(fault) for fault in self.faults],
            "notes": [asdict(note) for note in self.notes],
        }


def check_motions(
    sources: Files, *, sets: Names | None = None, time_step: float | None = None, units: str | None = None
) -> MotionCheck:
    """Read every record, and state all faults, not only the first.

    Parameters
    ----------
    sources, sets, time_step, units : optional
        As :func:`list_motions` takes them.

    Returns
    -------
    MotionCheck
        Faults, and what deserves a look.
    """
    inspections = [
        inspect(source, sets=listed(sets), time_step=time_step, units=units) for source in paths(sources)
    ]
    return MotionCheck(
        records=sum(inspection.records for inspection in inspections),
        faults=tuple(fault for inspection in inspections for fault in inspection.faults),
        notes=tuple(note for inspection in inspections for note in inspection.notes),
    )


@dataclass(frozen=True, kw_only=True)
class WrittenSuite:
    """A suite that was written as text with a catalogue.

    Attributes
    ----------
    catalogue : pathlib.Path
        The catalogue, in the folder of the suite.
    motions : tuple of str
        Names of the motions.
    events : int
        Number of earthquakes.
    skipped : tuple of Fault
        Files of the sources in formats that are not read.
    """

    catalogue: Path
    motions: tuple[str, ...]
    events: int
    skipped: tuple[Fault, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `catalogue`, `motions`, `events` and `skipped`."""
        return {
            "catalogue": str(self.catalogue),
            "motions": list(self.motions),
            "events": self.events,
            "skipped": [asdict(note) for note in self.skipped],
        }


def import_motions(
    sources: Files,
    *,
    out: str | Path,
    sets: Names | None = None,
    time_step: float | None = None,
    units: str | None = None,
    event: str | None = None,
) -> WrittenSuite:
    """Rewrite motions as a suite: one text format in m/s² and a catalogue.

    Parameters
    ----------
    sources, sets, time_step, units : optional
        As :func:`list_motions` takes them.
    out : str or pathlib.Path
        New or empty folder.
    event : str, optional
        Earthquake to which all imported motions belong.

    Returns
    -------
    WrittenSuite
        The catalogue, and what it holds.

    Raises
    ------
    InputError
        If a record is bad or the folder is neither new nor empty.
    """
    named = paths(sources)
    suite = load_motions(*named, sets=listed(sets), time_step=time_step, units=units)
    written = _written(
        suite, write_suite(suite, out, event=event), suite.events if event is None else [event]
    )
    return replace(written, skipped=tuple(note for source in named for note in skipped_files(source)))


def synthesize_motions(*, out: str | Path, count: int = 100, seed: int | None = None) -> WrittenSuite:
    """Write the synthetic suite, which needs no record.

    Parameters
    ----------
    out : str or pathlib.Path
        New or empty folder.
    count : int, optional
        Number of components.
    seed : int, optional
        Seed of a suite other than the built-in one.

    Returns
    -------
    WrittenSuite
        The catalogue, and what it holds.

    Raises
    ------
    InputError
        If the folder is neither new nor empty.
    """
    suite = synthetic_suite(count=count) if seed is None else synthetic_suite(count=count, seed=seed)
    return _written(suite, write_suite(suite, out), suite.events)


def _written(suite: MotionSuite, catalogue: Path, events: Sequence[str]) -> WrittenSuite:
    return WrittenSuite(catalogue=catalogue, motions=suite.names, events=len(set(events)))
