"""Steps that studies share: simulate, trace, derive, cross-validate; each a stage with its files."""

import json
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import cached_property
from pathlib import Path
from typing import Final

import xarray as xr

from reliab.api import ellipses, simulate
from reliab.criterion import Criterion, derive_criterion
from reliab.criterion.laws import OF_MANY_MOTIONS
from reliab.criterion.methods import Quantile, method_of
from reliab.errors import InputError
from reliab.motions import Motion, MotionSuite, load_motions
from reliab.progress import Progress, silent
from reliab.shipped import or_shipped
from reliab.study.description import Study
from reliab.study.stages import Stage, digest
from reliab.sweep import open_ellipses, open_results, write_ellipses
from reliab.validation.cross_validation import (
    Candidate,
    CrossValidation,
    Derived,
    Printed,
    cross_validate,
)
from reliab.validation.cross_validation.schemes import folds_of
from reliab.vocabulary import Metric

Show = Callable[[str], AbstractContextManager[Progress]]
"""Shows the progress of what it is told the name of."""

RESULTS: Final = "results.zarr"
ELLIPSES: Final = "ellipses.nc"
CRITERIA: Final = "criteria.json"
CASES: Final = "cases.nc"

_HELD_OUT = "held_out"
_PAPER_ERROR = (0.05, str(Metric.RMS))


def quietly(what: str) -> AbstractContextManager[Progress]:
    """Show nothing."""
    del what
    return nullcontext(silent)


class Material:
    """What a study works on, loaded when it is first needed.

    Parameters
    ----------
    study : Study
        The study.
    """

    def __init__(self, study: Study) -> None:
        self.study = study

    @cached_property
    def motions(self) -> MotionSuite:
        """The ground motions."""
        asked = self.study.motions
        return load_motions(*(asked.sources or ("synthetic",)), sets=asked.sets)

    @cached_property
    def stored(self) -> Path | None:
        """Results that are there already, if the study names some."""
        name = self.study.motions.results
        return None if name is None else or_shipped(Path(name), "datasets", "results.nc")

    @cached_property
    def checksums(self) -> list[str]:
        """What the ground motions, or the stored results, are known by."""
        if self.stored is not None:
            return [digest(self.stored)]
        return [motion.checksum for motion in self.motions]

    def results(self, folder: Path) -> xr.Dataset:
        """Results of the study's structures."""
        opened = open_results(self.stored or folder / RESULTS, window=self.study.errors.window)
        structures = self.study.structures
        try:
            return opened.sel(f=list(structures.f), xi=list(structures.xi), method="nearest", tolerance=1e-9)
        except KeyError:
            raise InputError(
                "Stored results answer for the structures that they hold",
                value=f"f = {list(structures.f)}, xi = {list(structures.xi)}",
                remedy=f"Choose among f = {opened['f'].values.tolist()}, xi = {opened['xi'].values.tolist()},"
                " or give ground motions",
            ) from None


def simulation(material: Material, show: Show) -> list[Stage]:
    """Simulate the study's motions, unless results are given."""
    if material.stored is not None:
        return []
    study = material.study

    def work(folder: Path) -> None:
        path = folder / RESULTS
        with show("Simulating") as progress:
            simulate(
                material.motions,
                out=path,
                f=study.structures.f,
                xi=study.structures.xi,
                window=(study.errors.window,),
                alpha=study.structures.experimental_fraction,
                resume=path.exists(),
                progress=progress,
            )

    inputs = {
        "motions": material.checksums,
        "structures": study.structures.model_dump(),
        "window": study.errors.window,
    }
    return [Stage(name="simulate", inputs=inputs, writes=(RESULTS,), work=work)]


def tracing(material: Material, show: Show) -> Stage:
    """Trace the boundaries in the results."""
    study = material.study

    def work(folder: Path) -> None:
        with show("Tracing boundaries") as progress:
            found = ellipses(
                material.results(folder),
                threshold=study.errors.thresholds,
                metric=study.errors.metrics,
                progress=progress,
            )
        write_ellipses(found, folder / ELLIPSES)

    inputs = {
        "results": material.checksums,
        "structures": study.structures.model_dump(),
        "errors": study.errors.model_dump(),
    }
    reads = () if material.stored is not None else (RESULTS,)
    return Stage(name="trace", inputs=inputs, reads=reads, writes=(ELLIPSES,), work=work)


def derivation(study: Study) -> Stage:
    """Derive the study's criteria, one for each error and confidence; the first is the study's own."""

    def work(folder: Path) -> None:
        found = open_ellipses(folder / ELLIPSES)
        criteria = [
            derive_criterion(
                found,
                threshold=threshold,
                metric=metric,
                confidence=confidence,
                method=study.criterion.method,
                joint=study.criterion.joint,
                law=study.criterion.law,
            )
            for metric in study.errors.metrics
            for threshold in study.errors.thresholds
            for confidence in study.criterion.confidences
        ]
        text = json.dumps([json.loads(each.to_json()) for each in criteria], ensure_ascii=False)
        (folder / CRITERIA).write_text(text, encoding="utf-8")

    inputs = study.model_dump(include={"errors", "criterion"})
    return Stage(name="derive", inputs=inputs, reads=(ELLIPSES,), writes=(CRITERIA,), work=work)


def criteria_of(folder: Path) -> list[Criterion]:
    """Read the criteria of a run."""
    content = json.loads((folder / CRITERIA).read_text(encoding="utf-8"))
    return [Criterion.from_json(json.dumps(each)) for each in content]


def judgement(material: Material, show: Show) -> Stage:
    """Judge the study's criterion, the paper's way to derive one, and the printed ones."""
    study = material.study
    threshold, metric = study.errors.thresholds[0], study.errors.metrics[0]

    def work(folder: Path) -> None:
        known = open_ellipses(folder / ELLIPSES)
        for scheme in study.validation.schemes:
            with show(f"Cross-validating, {scheme.replace('_', ' ')}") as progress:
                found = cross_validate(
                    known,
                    folds_of(scheme, known["event"].values),
                    candidates(study),
                    scheme=scheme,
                    confidences=study.validation.confidences,
                    threshold=threshold,
                    metric=metric,
                    results=material.results(folder),
                    trials=study.validation.trials,
                    progress=progress,
                )
            found.counts.to_netcdf(folder / _counts_file(scheme), engine="h5netcdf")

    inputs = study.model_dump(include={"errors", "criterion", "validation"})
    writes = [_counts_file(scheme) for scheme in study.validation.schemes]
    return Stage(name="validate", inputs=inputs, reads=(ELLIPSES,), writes=writes, work=work)


def candidates(study: Study) -> list[Candidate]:
    """Criteria that a study puts to the test; the first is its own."""
    asked = study.criterion
    own = Derived(name=asked.method, method=method_of(asked.method), joint=asked.joint)
    paper = Derived(name="quantile", method=Quantile(), joint=False)
    found: list[Candidate] = [own] if own == paper else [own, paper]
    if (study.errors.thresholds[0], study.errors.metrics[0]) == _PAPER_ERROR:
        found += [Printed(name=law.name, law=law) for law in OF_MANY_MOTIONS.values()]
    return found


def validation_of(study: Study, folder: Path, scheme: str) -> CrossValidation:
    """Read the cross-validation of a run."""
    counts = opened(folder / _counts_file(scheme))
    threshold, metric = study.errors.thresholds[0], study.errors.metrics[0]
    return CrossValidation(counts=counts, scheme=scheme, threshold=threshold, metric=metric)


def _counts_file(scheme: str) -> str:
    return f"validation_{scheme}.nc"


def paper_cases(material: Material, name: str) -> Stage:
    """Run the paper's four cases under a motion that is held out."""
    held_out = load_motions(*(material.study.motions.sources or ()), sets=[_HELD_OUT])
    motion = named(held_out, name)

    def work(folder: Path) -> None:
        from reliab.paper.cases import cases_dataset, run_paper_cases

        cases_dataset(run_paper_cases(motion), motion).to_netcdf(folder / CASES, engine="h5netcdf")

    return Stage(name="cases", inputs={"motion": motion.checksum}, writes=(CASES,), work=work)


def named(motions: MotionSuite, name: str) -> Motion:
    """Take a motion by its name, or say that it is missing."""
    if name not in motions.names:
        raise InputError(
            f"This study needs the motion {name}",
            value=f"{len(motions)} motions without it",
            remedy="Give a folder whose catalogue names it, with --motions",
        )
    return motions[motions.names.index(name)]


def opened(path: Path) -> xr.Dataset:
    """Read a dataset of a run."""
    with xr.open_dataset(path, engine="h5netcdf") as file:
        dataset: xr.Dataset = file.load()
    return dataset
