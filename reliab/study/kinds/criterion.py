"""Studies that derive criteria: simulate, trace, derive, validate."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from reliab.progress import Show
from reliab.report import Document
from reliab.study.description import CriterionStudy
from reliab.study.kind import Kind
from reliab.study.material import Material
from reliab.study.real_motions import REAL_MOTIONS, on_real_motions, real_share
from reliab.study.stages import Stage, made_with
from reliab.study.steps import (
    ELLIPSES,
    derivation,
    derivation_of,
    judgement,
    refusals_of,
    simulation,
    tracing,
    validations_of,
)
from reliab.sweep import open_ellipses


def stages(study: CriterionStudy, show: Show) -> Sequence[Stage]:
    """Simulate, trace, derive and validate; then judge on the real motions that ship."""
    material = Material(study, results=study.motions.results)
    return (
        *simulation(study, material, show),
        tracing(study, material, show),
        derivation(study.errors, study.criterion),
        judgement(study, material, show),
        *on_real_motions(study, material),
    )


def report(study: CriterionStudy, folder: Path) -> Document:
    """Report the criteria with the containment on held-out earthquakes."""
    from reliab.report.kinds.criterion import criterion_report, no_criterion_report
    from reliab.report.sections import rates_table

    population = Material(study, results=study.motions.results).population
    derived, traced = derivation_of(folder), open_ellipses(folder / ELLIPSES)
    title = study.titled(population)
    provenance = {**study.provenance, **made_with(folder)}
    if not derived.criteria:
        return no_criterion_report(
            title=title,
            ellipses=traced,
            reasons=derived.refusals,
            provenance=provenance,
            purpose=study.purpose,
        )
    tables = [rates_table(validation) for validation in validations_of(study, folder).values()]
    coverage = tables[0][tables[0]["measure"] == "containment"] if tables else None
    return criterion_report(
        title=title,
        ellipses=traced,
        criteria=derived.criteria,
        coverage=coverage,
        population=population,
        real_motions=real_share(folder / REAL_MOTIONS),
        provenance=provenance,
        notes=refusals_of(folder),
        purpose=study.purpose,
    )


KIND: Final = Kind(name="criterion", tables=CriterionStudy, stages=stages, report=report)
"""How much amplitude error and delay a test may have."""
