"""Ground motions listed, checked and rewritten as a suite; and the synthetic suite, which needs no record."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Unpack

from reliab.app import questions
from reliab.app.api.sources import as_list, paths
from reliab.app.declaration import Files, asks
from reliab.core.columns import Columns, digits
from reliab.core.errors import InputError
from reliab.core.plain_values import PlainResult, ResultWithRows
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.checking import inspect
from reliab.motions.faults import MotionFault, fault_of
from reliab.motions.intensity import measure
from reliab.motions.loading import find_motions, list_skipped_files, load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.motions.writing import write_suite


@dataclass(frozen=True)
class MotionList(ResultWithRows):
    """Ground motions with their measures of intensity.

    `rows`: name, event, set, time step [s], duration [s], peak [g], Arias intensity [m/s], significant
    duration [s], mean period [s] and checksum of each; `faults`: what is wrong with the records that are
    left out; `skipped`: files in formats that are not read.
    """

    rows_in = "motions"
    keys: ClassVar[Mapping[str, str]] = {"motions": "rows", "faults": "faults", "skipped": "skipped"}
    table_columns: ClassVar[Columns] = {
        "motion": ("motion", ""),
        "event": ("event", ""),
        "set": ("set", ""),
        "dt [s]": ("time_step", ".5g"),
        "T [s]": ("duration", ".2f"),
        "PGA [g]": ("pga_g", ".4f"),
        "I_A [m/s]": ("arias_intensity", digits),
        "D5-95 [s]": ("significant_duration", ".2f"),
        "T_m [s]": ("mean_period", ".3f"),
    }
    plot_columns = ("duration", "pga_g")

    rows: list[dict[str, Any]]
    faults: tuple[MotionFault, ...] = ()
    skipped: tuple[MotionFault, ...] = ()


@asks(questions.MotionQuestion, questions.MotionSources)
def list_motions(sources: Files, **read: Unpack[questions.MotionQuestion]) -> MotionList:
    """List motions with their events and measures of intensity; records with faults are left out and named.

    Raises
    ------
    InputError
        If no record is sound or a set is not in the catalogue.

    Examples
    --------
    >>> len(list_motions("synthetic").rows)
    100
    """
    named_sources = paths(sources)
    suite, initial_faults = find_motions(*named_sources, **_reading(read))
    rows, faults = [], list(initial_faults)
    for entry in suite.entries:
        try:
            rows.append(_describe(entry.load()))
        except InputError as error:
            faults.append(fault_of(error, entry.name))
    if not rows:
        raise faults[0].error()
    skipped_files = [note for source in named_sources for note in list_skipped_files(source)]
    return MotionList(rows, tuple(faults), tuple(skipped_files))


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
class MotionCheck(PlainResult):
    """What is wrong with records, and what deserves a look."""

    records: int
    faults: tuple[MotionFault, ...]
    notes: tuple[MotionFault, ...]


@asks(questions.MotionQuestion, questions.MotionSources)
def check_motions(sources: Files, **read: Unpack[questions.MotionQuestion]) -> MotionCheck:
    """Read every record, and state all faults, not only the first."""
    inspections = [inspect(source, **_reading(read)) for source in paths(sources)]
    return MotionCheck(
        records=sum(inspection.records for inspection in inspections),
        faults=tuple(fault for inspection in inspections for fault in inspection.faults),
        notes=tuple(note for inspection in inspections for note in inspection.notes),
    )


@dataclass(frozen=True, kw_only=True)
class WrittenSuite(PlainResult):
    """A suite that was written as text with a catalogue."""

    catalogue: Path  # The catalogue, in the folder of the suite
    motions: tuple[str, ...]  # Names of the motions
    events: int  # Number of earthquakes
    skipped: tuple[MotionFault, ...] = ()  # Files of the sources in formats that are not read


def _reading(read: questions.MotionQuestion) -> dict[str, Any]:
    """How records are read."""
    return {"sets": as_list(read["sets"]), "time_step": read["time_step"], "units": read["units"]}


@asks(questions.MotionImportQuestion, questions.MotionSources, questions.NewSuite)
def import_motions(
    sources: Files, *, out: str | Path, **request: Unpack[questions.MotionImportQuestion]
) -> WrittenSuite:
    """Rewrite motions as a suite: one text format in m/s² and a catalogue.

    Raises
    ------
    InputError
        If a record is bad or the folder is neither new nor empty.
    """
    named_sources, event = paths(sources), request["event"]
    suite = load_motions(*named_sources, **_reading(request))
    result = _write_suite(
        suite, write_suite(suite, out, event=event), suite.events if event is None else [event]
    )
    return replace(
        result, skipped=tuple(note for source in named_sources for note in list_skipped_files(source))
    )


@asks(questions.SyntheticSuiteQuestion, questions.NewSuite)
def synthesize_motions(
    *, out: str | Path, **request: Unpack[questions.SyntheticSuiteQuestion]
) -> WrittenSuite:
    """Write the synthetic suite, which needs no record.

    Raises
    ------
    InputError
        If the folder is neither new nor empty.
    """
    seed = {} if request["seed"] is None else {"seed": request["seed"]}
    suite = synthetic_suite(count=request["count"], **seed)
    return _write_suite(suite, write_suite(suite, out), suite.events)


def _write_suite(suite: MotionSuite, catalogue: Path, events: Sequence[str]) -> WrittenSuite:
    return WrittenSuite(catalogue=catalogue, motions=suite.names, events=len(set(events)))
