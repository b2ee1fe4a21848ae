"""Ground motions listed, checked, synthesized and simulated for all structures, and their boundaries."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Final, Unpack

import xarray as xr

from reliab.app import questions
from reliab.app.api.sources import EllipseSource, as_list, paths
from reliab.app.declaration import Files, asks
from reliab.core.columns import PLACE_COLUMNS, Columns, digits
from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, PlainResult, ResultWithRows, same_names
from reliab.core.progress import Progress, show_task, silent
from reliab.core.vocabulary import STANDARD_GRAVITY, CurveName, NoEllipse, Side
from reliab.motions.catalogue import write_suite
from reliab.motions.checking import inspect
from reliab.motions.faults import MotionFault, fault_of
from reliab.motions.loading import find_motions, list_skipped_files, load_motions
from reliab.motions.motion import Motion, measure
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_suite
from reliab.sweep.ellipse_dataset import COLUMNS, write_ellipses
from reliab.sweep.labels import share_of
from reliab.sweep.request import Motions, SweepRequest, suite_of, sweep_request
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep
from reliab.sweep.store_layout import attributes


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


@asks(questions.MotionQuestion, questions.MOTION_SOURCES)
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


@asks(questions.MotionQuestion, questions.MOTION_SOURCES)
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


@asks(questions.MotionImportQuestion, questions.MOTION_SOURCES, questions.NEW_SUITE)
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


@asks(questions.SyntheticSuiteQuestion, questions.NEW_SUITE)
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


_ATTRIBUTES = ("grid", "windows", "engine", "tolerance", "experimental_fraction", "model", "study_hash")


@asks(questions.SweepQuestion, questions.NEW_STORE)
def simulate(
    motions: Motions,
    *,
    out: str | Path,
    progress: Progress = silent,
    **request: Unpack[questions.SweepQuestion],
) -> xr.Dataset:
    """Simulate motions for all structures and actuators and store the results.

    Structures are of 1 Hz, 0.02 and all stiffness in the laboratory by default. The scaled grid has late and
    early actuators, with a model late ones only; those of the paper are late. Of a model, gain, delay and the
    index (A, d) of the results are those of its actuator alone.

    Parameters
    ----------
    motions : MotionSuite, Motion, str or pathlib.Path
        The ground motions, as `load_motions` gives them, one of them, or what it would read: a folder, a file
        or the name of a suite.

    Returns
    -------
    xarray.Dataset
        `rms`, `mte`, `A` [-], `d` [s] and `stable` over (motion, f, xi, kp, tau), with `alpha` after `xi`
        where several fractions are given.

    Raises
    ------
    InputError
        If a value is not allowed, a record is bad or the store cannot be written to.
    IncompleteError
        If the disk is full; what is stored is safe.

    Examples
    --------
    >>> import tempfile, reliab
    >>> motions = reliab.load_motions("synthetic")[:2]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     results = reliab.simulate(motions, out=f"{folder}/results.zarr").load()
    >>> results["rms"].dims, results["rms"].shape
    (('motion', 'f', 'xi', 'kp', 'tau'), (2, 1, 1, 41, 57))
    """
    _, store = _run(suite_of(motions), out, {**request}, progress)
    return open_results(store)


def _run(
    suite: MotionSuite, out: str | Path, question: Mapping[str, Any], progress: Progress
) -> tuple[SweepRequest, Path]:
    """Simulate a suite and store the results; return what was simulated, and where it is stored."""
    request = sweep_request(**questions.select_stated(questions.SweepOptions, question))
    settings = questions.select_stated(questions.SweepRunOptions, question)
    return request, run_sweep(suite, request, out, **settings, progress=progress)


@dataclass(frozen=True, kw_only=True)
class Simulation(PlainResult):
    """A suite of ground motions that was simulated and stored."""

    keys: ClassVar[Keys] = {
        **same_names("store", "motions"),
        **{name: f"request.describe.{name}" for name in ("f", "xi", "kp", "tau")},
        "alpha": "request.experimental_fractions",
        "**": "stored_attributes",
    }

    store: Path
    motions: int
    request: SweepRequest

    def results(self) -> xr.Dataset:
        """Open the store, as :func:`reliab.simulate` does."""
        return open_results(self.store)

    @property
    def stored_attributes(self) -> dict[str, Any]:
        """How it was simulated, as the store states it."""
        stored = attributes(self.request, self.request.windows[0].label)
        return {name: stored[name] for name in _ATTRIBUTES if name in stored}


@asks(questions.SimulationQuestion, questions.NEW_STORE)
def simulate_suite(*, out: str | Path, **request: Unpack[questions.SimulationQuestion]) -> Simulation:
    """Simulate motions from several sources and sets as :func:`simulate` does, and say what was stored."""
    suite = load_motions(*paths(request["motions"] or "synthetic"), sets=as_list(request["sets"]))
    with show_task("Simulating") as progress:
        simulated_request, store = _run(suite, out, {**request}, progress)
    return Simulation(store=store, motions=len(suite), request=simulated_request)


_PLACE: Final = ["motion", "f", "xi", "alpha", "threshold", "metric"]
_HEADINGS = {"_lead": ", lead", "_inscribed": ", inscribed", "_lead_inscribed": ", inscribed, lead"}
_SUFFIXES: Final = {
    "": (CurveName.ELLIPSE, Side.LAG),
    "_lead": (CurveName.ELLIPSE, Side.LEAD),
    "_inscribed": (CurveName.INSCRIBED, Side.LAG),
    "_lead_inscribed": (CurveName.INSCRIBED, Side.LEAD),
}


def _parameter(name: str, ending: str, form: str) -> Callable[[Mapping[str, Any]], str]:
    """Write a or b of one ellipse of a row, or in place of a why there is none."""

    def write(row: Mapping[str, Any]) -> str:
        value, reason = row.get(f"{name}{ending}"), row.get(f"no_ellipse{ending}")
        if reason is not None:
            return str(reason).replace("_", " ") if name == "a" else ""
        return "" if value is None else format(value, form)

    return write


@dataclass(frozen=True, kw_only=True, eq=False)
class Boundaries(ResultWithRows):
    """Boundaries of equal error."""

    rows_in = "ellipses"
    keys: ClassVar[Keys] = {"ellipses": "rows", "warnings?": "warnings"}
    table_columns: ClassVar[Columns] = {
        "motion": ("motion", ""),
        **PLACE_COLUMNS,
        "a [-]": ("", _parameter("a", "", ".3e")),
        "b [ms²]": ("", _parameter("b", "", ".4g")),
        **{
            f"{name}{heading}": ("", _parameter(name, ending, form))
            for ending, heading in _HEADINGS.items()
            for name, form in (("a", ".3e"), ("b", ".4g"))
        },
        "points": ("n", "d"),
    }
    plot_columns = ("a", "b")

    # `a` [-], `b` [ms²], `sse` [ms⁴] and `n` over motion, structure, error, curve and side, as
    # :func:`reliab.ellipses` returns them
    ellipses: xr.Dataset

    @property
    def warnings(self) -> list[str]:
        """What should be known of ellipses that were predicted or carried, not traced."""
        return [text for name, text in self.ellipses.attrs.items() if name == "caution"]

    def __len__(self) -> int:
        return math.prod(self.ellipses.sizes.get(dimension, 1) for dimension in _PLACE)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Give one row to each boundary, with both sides and both curves in columns.

        `a`, `b`, `sse`, `n` are of the ellipse of least squares for delays; those of leads end in `_lead`,
        those of the inscribed ellipse in `_inscribed` and `_lead_inscribed`. None where there is none, for
        the reason in `no_ellipse`; 0 where effects leave no room.
        """
        dataset = self.ellipses
        if "alpha" not in dataset.dims:
            dataset = dataset.expand_dims(alpha=[share_of(dataset)])
        boundaries = list(dataset[[*_PLACE]].stack(row=_PLACE)["row"].values.tolist())
        columns = {
            f"{name}{suffix}": dataset[name].sel(curve=curve, side=side).transpose(*_PLACE).values.ravel()
            for suffix, (curve, side) in _SUFFIXES.items()
            if curve in dataset["curve"].values and side in dataset["side"].values
            for name in COLUMNS
            if name in dataset
        }
        for k, boundary in enumerate(boundaries):
            yield {
                **dict(zip(_PLACE, boundary, strict=True)),
                **{name: _plain(name, values[k]) for name, values in columns.items()},
            }


@asks(questions.TracingQuestion)
def trace_boundaries(**request: Unpack[questions.TracingQuestion]) -> Boundaries:
    """Trace the boundary of equal error of each motion, for late and early actuators, as ellipses.

    >>> traced = trace_boundaries(results="real_suite", f=1, xi=0.02)
    >>> len(traced), round(next(traced.rows())["b"], 2)
    (100, 1.35)
    """
    ellipses = EllipseSource.from_question(request).dataset()
    if request["out"] is not None:
        write_ellipses(ellipses, Path(request["out"]))
    return Boundaries(ellipses=ellipses)


def _plain(name: str, value: Any) -> float | int | str | None:  # noqa: ANN401 - of many types
    """Turn a value into a number or word of JSON."""
    if name.startswith("no_ellipse"):
        reason = NoEllipse(int(value))
        return None if reason is NoEllipse.NOT_SO else reason.name.lower()
    if name.startswith("n"):
        return int(value)
    return float(value) if math.isfinite(value) else None
