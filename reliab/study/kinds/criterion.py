"""Studies that derive criteria: simulate, trace, derive, validate."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from reliab.core.errors import InputError
from reliab.core.files import written_whole
from reliab.core.shipped import shipped
from reliab.criterion.criterion import Criterion
from reliab.report.document import Document
from reliab.study.description import CriterionStudy, StudyKind
from reliab.study.stages import Stage, digest, read_result, software_provenance
from reliab.study.steps import (
    CRITERIA,
    ELLIPSES,
    Material,
    derivation,
    derivation_of,
    judgement,
    refusals_of,
    simulation,
    tracing,
    validations_of,
)
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.results import REAL, open_results, real_results
from reliab.validation.counts import CrossValidation
from reliab.validation.folds import Fold, earthquakes_among
from reliab.validation.judge import PrintedCandidate, cross_validate
from reliab.validation.truth import StoredTruth

REAL_MOTIONS: Final = "real_motions.json"


def stages(study: CriterionStudy) -> Sequence[Stage]:
    """Simulate, trace, derive and validate; then judge on the real motions that ship."""
    material = Material(study, results=study.motions.results)
    return (
        *simulation(study, material),
        tracing(study, material),
        derivation(study.errors, study.criterion),
        judgement(study, material),
        *real_motion_stages(study, material),
    )


def report(study: CriterionStudy, folder: Path) -> Document:
    """Report the criteria with the containment on held-out earthquakes."""
    from reliab.report.kinds.criterion.report import criterion_report, no_criterion_report
    from reliab.report.sections import rates_table

    population = Material(study, results=study.motions.results).population
    derivations, ellipses = derivation_of(folder), open_ellipses(folder / ELLIPSES)
    title = study.full_title(population)
    provenance = {**study.provenance, **software_provenance(folder)}
    if not derivations.criteria:
        return no_criterion_report(
            title=title,
            ellipses=ellipses,
            reasons=derivations.refusals,
            provenance=provenance,
            purpose=study.purpose,
        )
    tables = [rates_table(validation) for validation in validations_of(study, folder).values()]
    coverage = tables[0][tables[0]["measure"] == "containment"] if tables else None
    return criterion_report(
        title=title,
        ellipses=ellipses,
        criteria=derivations.criteria,
        coverage=coverage,
        population=population,
        real_motions=dict(read_result(judged)) if (judged := folder / REAL_MOTIONS).exists() else None,
        provenance=provenance,
        notes=refusals_of(folder),
        purpose=study.purpose,
    )


KIND: Final = StudyKind(name="criterion", tables=CriterionStudy, stages=stages, report=report)
"""How much amplitude error and delay a test may have."""


def real_motion_stages(study: CriterionStudy, material: Material) -> list[Stage]:
    """Judge the study's criterion on the real motions that ship, unless it was derived from them.

    Returns one stage, or none where the shipped results hold no such structure, error or window.
    """
    results = _results(study)
    has_same_error = study.errors.window == "record" and study.structures.experimental_fraction == 1.0
    if material.is_real_suite or not has_same_error:
        return []

    def work(folder: Path) -> None:
        criteria = derivation_of(folder).criteria
        validation = _judge_on_real_motions(criteria[0], folder, results) if criteria else None
        content = None if validation is None else _content(validation)
        with written_whole(folder / REAL_MOTIONS) as file:
            file.write_text(json.dumps(content), encoding="utf-8")

    return [
        Stage(
            name="real motions",
            inputs={"real": digest(results)},
            reads=(CRITERIA, ELLIPSES),
            writes=(REAL_MOTIONS,),
            work=work,
        )
    ]


def _results(study: CriterionStudy) -> Path:
    """Results that hold the study's structures, or those of six that every installation has."""
    try:
        return real_results(study.structures.f, study.structures.xi)
    except InputError:
        return real_results((), ())


def _judge_on_real_motions(criterion: Criterion, folder: Path, results: Path) -> CrossValidation | None:
    """Judge a criterion on the real motions of earthquakes that it was not learned from."""
    stored_results = open_results(results)
    training = open_ellipses(folder / ELLIPSES)
    real = open_ellipses(shipped("datasets", f"{REAL}/ellipses.nc"))
    nodes = [
        np.intersect1d(np.round(training[name], 9), np.round(stored_results[name], 9)) for name in ("f", "xi")
    ]
    learned_events = {
        *earthquakes_among(training["event"].values.tolist(), training["checksum"].values.tolist(), real)
    } - {None}
    unseen = ~np.isin(real["event"].values, [name for name in learned_events if name])
    if not (nodes[0].size and nodes[1].size and unseen.any()):
        return None
    thresholds = real["threshold"].values
    nearest = float(thresholds[np.argmin(np.abs(thresholds - criterion.threshold))])
    real_ellipses = real.sel(f=nodes[0], xi=nodes[1], method="nearest").sel(threshold=[nearest])
    try:
        return cross_validate(
            real_ellipses.assign_coords(threshold=[criterion.threshold]),
            [Fold(name="all", learned=np.zeros(unseen.size, dtype=np.bool_), judged=unseen)],
            [
                PrintedCandidate(
                    name="criterion",
                    law=criterion.law,
                    lead_law=criterion.lead_law,
                    confidence=criterion.confidence,
                )
            ],
            scheme="real motions",
            confidences=(criterion.confidence,),
            threshold=criterion.threshold,
            metric=criterion.metric,
            truth=StoredTruth(stored_results),
            trials=64,
        )
    except InputError:
        return None


def _content(validation: CrossValidation) -> dict[str, float] | None:
    """Rate with its interval, and how many motions it is of."""
    counts = validation.counts.sel(side="lag").sum(["f", "xi"]).squeeze(["candidate", "confidence"])
    judged_cells = counts["judged"].values > 0
    if not judged_cells.any():
        return None
    rate = validation.containment()
    return {
        **{name: float(rate[name].item()) for name in ("rate", "low", "high")},
        "n_motions": int(judged_cells.sum()),
        "n_events": len(set(counts["event"].values[judged_cells].tolist())),
    }
