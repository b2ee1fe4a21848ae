"""Ground motions listed, checked and rewritten as a suite; and the synthetic suite, which needs no record."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from reliab.api.sources import Files, listed, paths
from reliab.motions import Fault, MotionSuite, inspect, load_motions, measure, write_suite
from reliab.motions.synthetic import synthetic_suite
from reliab.rows import ResultWithRows
from reliab.sweep import Names
from reliab.vocabulary import STANDARD_GRAVITY


@dataclass(frozen=True)
class MotionList(ResultWithRows):
    """Ground motions with their measures of intensity.

    `rows`: name, event, set, time step [s], duration [s], peak [g], Arias intensity [m/s], significant
    duration [s], mean period [s] and checksum of each.
    """

    rows_in = "motions"

    rows: list[dict[str, Any]]

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `motions`, the rows."""
        return {"motions": self.rows}


def list_motions(
    sources: Files, *, sets: Names | None = None, time_step: float | None = None, units: str | None = None
) -> MotionList:
    """List motions with their events and measures of intensity.

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
        The motions, one row each.

    Raises
    ------
    InputError
        If a record is bad or a set is not in the catalogue.

    Examples
    --------
    >>> len(list_motions("synthetic").rows)
    100
    """
    suite = load_motions(*paths(sources), sets=listed(sets), time_step=time_step, units=units)
    return MotionList(_describe(suite))


def _describe(suite: MotionSuite) -> list[dict[str, Any]]:
    rows = []
    for motion in suite:
        intensity = measure(motion)
        rows.append(
            {
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
        )
    return rows


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
    """

    catalogue: Path
    motions: tuple[str, ...]
    events: int

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `catalogue`, `motions` and `events`."""
        return {"catalogue": str(self.catalogue), "motions": list(self.motions), "events": self.events}


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
    suite = load_motions(*paths(sources), sets=listed(sets), time_step=time_step, units=units)
    return _written(suite, write_suite(suite, out, event=event), suite.events if event is None else [event])


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
