"""Steps that studies share: simulate, trace, derive, cross-validate; each a stage with its files."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
import xarray as xr

from reliab.core.errors import InputError
from reliab.core.files import written_whole
from reliab.core.progress import show_task
from reliab.core.vocabulary import ERROR_NAMES, Metric
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import Derivation
from reliab.criterion.ellipse_table import drop_copies
from reliab.criterion.laws.registry import FITTED_LAWS, MANY_MOTION_LAWS, find_law
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import method_of
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.study.description import CriterionStudy, CriterionTable, ErrorsTable, RecordsStudy, SimulatedStudy
from reliab.study.stages import Stage, digest, read_result
from reliab.sweep.cut_records import measure_cut_records
from reliab.sweep.ellipse_dataset import open_ellipses, write_ellipses
from reliab.sweep.labels import outlines_of, select_share
from reliab.sweep.netcdf import read_netcdf, write_netcdf
from reliab.sweep.request import sweep_request
from reliab.sweep.results import REAL, find_results, open_results
from reliab.sweep.run import run_sweep
from reliab.tracking.indices.window import Window
from reliab.validation.counts import CrossValidation
from reliab.validation.folds import folds_of
from reliab.validation.judge import (
    Candidate,
    DerivedCandidate,
    PrintedCandidate,
    cross_validate,
)
from reliab.validation.truth import StoredTruth

RESULTS: Final = "results.zarr"
SYNTHETIC: Final = "synthetic"


class Records:
    """Ground motions of a study, loaded when they are first needed."""

    def __init__(self, study: RecordsStudy) -> None:
        self._asked = study.motions

    @cached_property
    def motions(self) -> MotionSuite:
        """The ground motions."""
        return load_motions(*(self._asked.sources or (SYNTHETIC,)), sets=self._asked.sets)

    @cached_property
    def checksums(self) -> list[str]:
        """What the ground motions are known by."""
        return [motion.checksum for motion in self.motions]

    @property
    def population(self) -> str:
        """What the ground motions are, in words: "ground motions" where the user brought them."""
        sources = self._asked.sources or (SYNTHETIC,)
        return "synthetic ground motions" if sources == (SYNTHETIC,) else "ground motions"


class Material(Records):
    """Ground motions of a study that simulates, or stored results.

    `results`: a store of results, or the name of one that ships, that takes the place of simulations.
    """

    def __init__(self, study: SimulatedStudy, *, results: str | None = None) -> None:
        super().__init__(study)
        self._study = study
        self._results = results

    @cached_property
    def results_path(self) -> Path | None:
        """Stored results, once they are known to hold the structures; a report never asks for them."""
        if self._results is None:
            return None
        structures = self._study.structures
        path = find_results(Path(self._results), structures.f, structures.xi)
        self._check(path)
        return path

    @cached_property
    def checksums(self) -> list[str]:
        """What the ground motions, or the stored results, are known by."""
        return [digest(self.results_path)] if self.results_path is not None else super().checksums

    @property
    def population(self) -> str:
        """What the ground motions are, in words."""
        if self._results is None:
            return super().population
        return "real ground motions" if self.is_real_suite else "ground motions"

    @property
    def is_real_suite(self) -> bool:
        """Whether the study works on the results of real ground motions that ship."""
        return self._results == REAL

    def results(self, folder: Path) -> xr.Dataset:
        """Results of the study's structures, stored or simulated in its run folder."""
        window = Window.parse(self._study.errors.window).label
        return self._select(open_results(self.results_path or folder / RESULTS, window=window))

    def truth(self, folder: Path, motions: Sequence[str]) -> StoredTruth:
        """Return the true errors of tests under motions of these names, read from the results."""
        return StoredTruth(self.results(folder).sel(motion=list(motions)))

    def _select(self, results: xr.Dataset) -> xr.Dataset:
        structures = self._study.structures
        f, xi = list(structures.f), list(structures.xi)
        share_results = select_share(results, structures.experimental_fraction)
        return share_results.sel(f=f, xi=xi, method="nearest", tolerance=1e-9)

    def _check(self, path: Path) -> None:
        results = open_results(path, window=Window.parse(self._study.errors.window).label)
        structures = self._study.structures
        try:
            self._select(results)
        except KeyError:
            raise InputError(
                "The stored results hold no such structures",
                value=f"f = {list(structures.f)}, xi = {list(structures.xi)}",
                remedy=f"Choose among f = {results['f'].values.tolist()}, "
                f"xi = {results['xi'].values.tolist()}, or give ground motions",
            ) from None


def motion_by_name(motions: MotionSuite, name: str) -> Motion:
    """Take a motion by its name, or say that it is missing."""
    if name not in motions.names:
        raise InputError(
            f"This study needs the motion {name}",
            value=f"{len(motions)} motions without it",
            remedy="Give a folder whose catalogue names it, with `motions`",
        )
    return motions[motions.names.index(name)]


ELLIPSES: Final = "ellipses.nc"
CRITERIA: Final = "criteria.json"
VALIDATION: Final = "validation.json"

_PAPER_ERROR = (0.05, str(Metric.RMS))


def simulation(study: SimulatedStudy, material: Material) -> list[Stage]:
    """Simulate the study's motions, unless results are given."""
    if material.results_path is not None:
        return []
    request = sweep_request(
        f=study.structures.f,
        xi=study.structures.xi,
        window=study.errors.window,
        alpha=study.structures.experimental_fraction,
    )

    def work(folder: Path) -> None:
        path = folder / RESULTS
        with show_task("Simulating") as progress:
            run_sweep(material.motions, request, path, resume=path.exists(), progress=progress)

    inputs = {
        "motions": material.checksums,
        "structures": study.structures.model_dump(),
        "window": study.errors.window,
    }
    return [Stage(name="simulate", inputs=inputs, writes=(RESULTS,), work=work)]


def tracing(study: SimulatedStudy, material: Material) -> Stage:
    """Trace the boundaries in the results."""

    def work(folder: Path) -> None:
        with show_task("Tracing boundaries") as progress:
            ellipses = material.results(folder).reliab.ellipses(
                study.errors.thresholds, [Metric(name) for name in study.errors.metrics], progress=progress
            )
        if material.results_path is None:
            ellipses = ellipses.assign_coords(outline=outlines_of(material.motions))
        has_cut_ratios = "a_cut" in ellipses  # of records that ship, whose ratios came with their boundaries
        if material.results_path is None and study.errors.window == Window().label and not has_cut_ratios:
            structures = study.structures.f, study.structures.xi, study.structures.experimental_fraction
            ellipses = ellipses.merge(measure_cut_records(material.motions, *structures))
        write_ellipses(ellipses, folder / ELLIPSES)

    inputs = {
        "results": material.checksums,
        "structures": study.structures.model_dump(),
        "errors": study.errors.model_dump(),
    }
    reads = () if material.results_path is not None else (RESULTS,)
    return Stage(name="trace", inputs=inputs, reads=reads, writes=(ELLIPSES,), work=work)


@dataclass(frozen=True, kw_only=True)
class DerivedCriteria:
    """Criteria of a run, and why others could not be derived."""

    # One for each error and confidence for which the motions suffice; the first is the study's own
    criteria: tuple[Criterion, ...]
    refusals: tuple[str, ...]  # A sentence for each error and confidence for which they are too few


def derivation(errors: ErrorsTable, criterion: CriterionTable) -> Stage:
    """Derive the study's criteria, one for each error and confidence for which the motions suffice."""

    def work(folder: Path) -> None:
        ellipses = drop_copies(open_ellipses(folder / ELLIPSES))
        results = [
            _derive(ellipses, threshold, metric, criterion)
            for metric in errors.metrics
            for threshold in errors.thresholds
        ]
        content = {
            "criteria": [json.loads(item.to_json()) for criteria in results for item in criteria.criteria],
            "refusals": [sentence for criteria in results for sentence in criteria.refusals],
        }
        text = json.dumps(content, ensure_ascii=False, allow_nan=False)
        with written_whole(folder / CRITERIA) as file:
            file.write_text(text, encoding="utf-8")

    inputs = {"errors": errors.model_dump(), "criterion": criterion.model_dump()}
    return Stage(name="derive", inputs=inputs, reads=(ELLIPSES,), writes=(CRITERIA,), work=work)


def _derive(ellipses: xr.Dataset, threshold: float, metric: str, table: CriterionTable) -> DerivedCriteria:
    """Learn once from the ellipses of one error, and derive a criterion at each confidence."""
    error_text = f"{100 * threshold:g} % of {ERROR_NAMES[Metric(metric)]}"
    error = f"No criterion for {error_text}"
    try:
        with show_task(f"Learning at {error_text}") as progress:
            derivation = Derivation.from_ellipses(
                ellipses,
                method=method_of(table.method),
                law=find_law(FITTED_LAWS, table.law),
                threshold=threshold,
                metric=metric,
                progress=progress,
            )
    except InputError as refusal:
        return DerivedCriteria(criteria=(), refusals=(f"{error}: {refusal}",))
    derivation.warn_unless_converged()
    if not derivation.has_converged:
        return DerivedCriteria(criteria=(), refusals=(f"{error}: its posterior has not converged.",))
    criteria, refusals = [], []
    for confidence in table.confidences:
        try:
            criterion = derivation.criterion(confidence, joint=table.joint)
        except InputError as refusal:
            refusals.append(f"{error} at {100 * confidence:g} %: {refusal}")
            continue
        if np.max(criterion.limits(ellipses["f"].values[:, np.newaxis], ellipses["xi"].values)) > 0.0:
            criteria.append(criterion)
        else:
            reasons = " ".join(criterion.provenance.warnings)
            refusals.append(f"{error} at {100 * confidence:g} %: {reasons}")
    return DerivedCriteria(criteria=tuple(criteria), refusals=tuple(refusals))


def derivation_of(folder: Path) -> DerivedCriteria:
    """Read the criteria of a run."""
    content = read_result(folder / CRITERIA)
    return DerivedCriteria(
        criteria=tuple(Criterion.from_json(json.dumps(criterion)) for criterion in content["criteria"]),
        refusals=tuple(content["refusals"]),
    )


def judgement(study: CriterionStudy, material: Material) -> Stage:
    """Judge the study's criterion, the paper's way to derive one, and the printed ones."""
    threshold, metric = study.errors.thresholds[0], study.errors.metrics[0]

    def work(folder: Path) -> None:
        ellipses = drop_copies(open_ellipses(folder / ELLIPSES))
        refusals: dict[str, str] = {}
        for scheme in study.validation.schemes:
            try:
                with show_task(f"Cross-validating, {scheme.replace('_', ' ')}") as progress:
                    validation = cross_validate(
                        ellipses,
                        folds_of(scheme, ellipses["event"].values),
                        candidates(study.errors, study.criterion),
                        scheme=scheme,
                        confidences=study.validation.confidences,
                        threshold=threshold,
                        metric=metric,
                        truth=material.truth(folder, ellipses["motion"].values.tolist()),
                        trials=study.validation.trials,
                        progress=progress,
                    )
            except InputError as refusal:
                refusals[scheme] = f"Not put to the test by {scheme.replace('_', ' ')}: {refusal}"
                (folder / _counts_file(scheme)).unlink(missing_ok=True)
            else:
                write_netcdf(validation.counts, folder / _counts_file(scheme))
        with written_whole(folder / VALIDATION) as file:
            file.write_text(json.dumps(refusals, ensure_ascii=False), encoding="utf-8")

    inputs = study.model_dump(include={"errors", "criterion", "validation"})
    writes = [VALIDATION, *(_counts_file(scheme) for scheme in study.validation.schemes)]
    return Stage(name="validate", inputs=inputs, reads=(ELLIPSES,), writes=writes, work=work)


def candidates(errors: ErrorsTable, criterion: CriterionTable) -> list[Candidate]:
    """Criteria that a study puts to the test; the first is its own, with its own law."""
    label = criterion.method if criterion.law == "table" else f"{criterion.method}, {criterion.law}"
    candidate = DerivedCandidate(
        name=label,
        method=method_of(criterion.method),
        joint=criterion.joint,
        law=find_law(FITTED_LAWS, criterion.law),
    )
    paper = DerivedCandidate(name="quantile", method=Quantile(), joint=False)
    trial_criteria: list[Candidate] = [candidate] if candidate == paper else [candidate, paper]
    if (errors.thresholds[0], errors.metrics[0]) == _PAPER_ERROR:
        trial_criteria += [PrintedCandidate(name=law.name, law=law) for law in MANY_MOTION_LAWS.values()]
    return trial_criteria


def validations_of(study: CriterionStudy, folder: Path) -> dict[str, CrossValidation]:
    """Read the cross-validations of a run by their schemes; those that could not be made are missing."""
    return {
        scheme: CrossValidation(
            counts=read_run_dataset(folder / _counts_file(scheme)),
            scheme=scheme,
            threshold=study.errors.thresholds[0],
            metric=study.errors.metrics[0],
            truth="simulated",
        )
        for scheme in study.validation.schemes
        if scheme not in _read_refusals(folder)
    }


def refusals_of(folder: Path) -> list[str]:
    """Say what could not be done in a run, and why: a sentence each."""
    return [*derivation_of(folder).refusals, *_read_refusals(folder).values()]


def _read_refusals(folder: Path) -> dict[str, str]:
    return dict(read_result(folder / VALIDATION))


def _counts_file(scheme: str) -> str:
    return f"validation_{scheme}.nc"


def read_run_dataset(path: Path) -> xr.Dataset:
    """Read a dataset of a run."""
    return read_netcdf(path, "A run holds the files that `reliab run` wrote", "Run the study again")
