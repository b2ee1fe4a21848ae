"""Studies that put criteria to the test: held-out earthquakes, rigs beyond the model, the paper's cases."""

from collections.abc import Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Final

import pandas as pd
from pydantic import Field
from reliab_studies.paper2017.cases_stage import CASES, paper_cases

from reliab.core.plain_values import read_table, write_table
from reliab.core.progress import show_task
from reliab.core.vocabulary import Metric
from reliab.criterion.scope import records_checksum
from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.report.document import Document
from reliab.structures.structure import Structure
from reliab.study.description import CriterionStudy, StudyKind, ValidationTable
from reliab.study.stages import Stage, software_provenance
from reliab.study.steps import (
    CRITERIA,
    ELLIPSES,
    SYNTHETIC,
    Material,
    derivation,
    derivation_of,
    judgement,
    read_run_dataset,
    refusals_of,
    simulation,
    tracing,
    validations_of,
)
from reliab.sweep.ellipse_dataset import open_ellipses

BEYOND: Final = "beyond_the_model.csv"
REBUILT: Final = "rebuilt_error_tests.csv"

_MOTIONS_BEYOND = 20


class CasesTable(ValidationTable):
    """`[validation]`: how criteria are put to the test, and under which motion the paper's cases are run."""

    held_out: str | None = None
    rebuilt_error_trials: Annotated[int, Field(ge=0)] = 6
    """Tests of each kind of actuator and specimen whose error is rebuilt; 0 leaves them out."""


class ValidationStudy(CriterionStudy):
    """Whether criteria keep their promise."""

    validation: CasesTable = CasesTable()


def stages(study: ValidationStudy) -> Sequence[Stage]:
    """Derive and judge criteria; try actuators beyond the model; run the paper's cases if possible."""
    material = Material(study, results=study.motions.results)
    held_out = _find_held_out(study)
    cases = [] if held_out is None else [paper_cases(study.motions.sources or (), held_out)]
    return (
        *simulation(study, material),
        tracing(study, material),
        derivation(study.errors, study.criterion),
        judgement(study, material),
        _try_other_actuators(study, material),
        *_rebuilt(study, material),
        *cases,
    )


def report(study: ValidationStudy, folder: Path) -> Document:
    """Report containment, false-safe rate and accepted share of every scheme, and what lies beyond."""
    from reliab.report.kinds.criterion.report import no_criterion_report
    from reliab.report.sections import rates_table
    from reliab.validation.counts import tabulate

    from .report import validation_report

    validations, traced = validations_of(study, folder), open_ellipses(folder / ELLIPSES)
    title = study.full_title(Material(study, results=study.motions.results).population)
    provenance = {
        **study.provenance,
        "records, SHA-256": records_checksum(traced),
        **software_provenance(folder),
    }
    if not validations:
        return no_criterion_report(
            title=title,
            ellipses=traced,
            reasons=refusals_of(folder),
            provenance=provenance,
            purpose=study.purpose,
        )
    return validation_report(
        title=title,
        rates={
            scheme.replace("_", " "): rates_table(validation) for scheme, validation in validations.items()
        },
        confidence=study.criterion.confidences[0],
        experimental_fraction=study.structures.experimental_fraction,
        window=study.errors.window,
        verdicts=tabulate(next(iter(validations.values()))),
        beyond=read_table(folder / BEYOND),
        rebuilt=read_table(folder / REBUILT) if study.validation.rebuilt_error_trials else None,
        threshold=study.errors.thresholds[0],
        cases=read_run_dataset(folder / CASES) if _find_held_out(study) else None,
        provenance=provenance,
        notes=refusals_of(folder),
        purpose=study.purpose,
    )


def _find_held_out(study: ValidationStudy) -> str | None:
    """Return the motion of the paper's cases, where there are records that may hold it."""
    return study.validation.held_out if study.motions.sources else None


def _try_other_actuators(study: ValidationStudy, material: Material) -> Stage:
    """Try actuators that are not a constant gain and delay."""
    # Without records the rigs are tried under the suite that is built in.
    suite = material.motions if study.motions.sources else load_motions(SYNTHETIC)
    structure = _structure(study)

    def work(folder: Path) -> None:
        from .beyond_the_model import TEST_COLUMNS, rigs_of_delay, try_rigs

        criteria = derivation_of(folder).criteria
        if not criteria:
            write_table(pd.DataFrame(columns=list(TEST_COLUMNS)), folder / BEYOND)
            return
        criterion = criteria[0]
        with show_task("Trying other rigs") as progress:
            tests = try_rigs(
                _spread(suite, _MOTIONS_BEYOND),
                [structure],
                rigs_of_delay,
                criterion,
                count=_MOTIONS_BEYOND,
                progress=progress,
            )
        write_table(tests, folder / BEYOND)

    inputs = {
        "motions": [motion.checksum for motion in _spread(suite, _MOTIONS_BEYOND)],
        "structure": repr(structure),
    }
    return Stage(name="beyond the model", inputs=inputs, reads=(CRITERIA,), writes=(BEYOND,), work=work)


def _rebuilt(study: ValidationStudy, material: Material) -> list[Stage]:
    """Judge simulated tests by their rebuilt error too."""
    trials = study.validation.rebuilt_error_trials
    if not trials:
        return []
    suite = material.motions if study.motions.sources else load_motions(SYNTHETIC)
    motions = _spread(suite, trials)
    structure = _structure(study)
    threshold, metric = study.errors.thresholds[0], study.errors.metrics[0]
    confidence = study.criterion.confidences[0]

    def work(folder: Path) -> None:
        from .rebuilt_error_study.design import Design
        from .rebuilt_error_study.study import try_tests

        design = Design.classify_motions(
            motions,
            [structure],
            trials=trials,
            threshold=threshold,
            metric=Metric(metric),
            confidence=confidence,
        )
        with show_task("Rebuilding the errors of tests") as progress:
            try_tests(design, kept=folder / REBUILT, progress=progress)

    inputs = {
        "motions": [motion.checksum for motion in motions],
        "structure": repr(structure),
        "asked": [threshold, metric, confidence, trials],
    }
    return [Stage(name="rebuilt errors", inputs=inputs, writes=(REBUILT,), work=work)]


def _structure(study: ValidationStudy) -> Structure:
    """Structure with which single tests are simulated."""
    return Structure(frequency=study.structures.f[0], damping_ratio=study.structures.xi[0])


def _spread(suite: MotionSuite, count: int) -> list[Motion]:
    """Take some of the motions, spread over the suite."""
    return list(islice(suite, 0, None, max(1, len(suite) // count)))[:count]


KIND: Final = StudyKind(name="validation", tables=ValidationStudy, stages=stages, report=report)
"""Whether criteria keep their promise."""
