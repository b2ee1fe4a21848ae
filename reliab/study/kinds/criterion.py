"""Studies that derive criteria: simulate, trace, derive, validate."""

from collections.abc import Sequence
from pathlib import Path

from reliab.report import Document
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage
from reliab.study.steps import (
    ELLIPSES,
    Material,
    Show,
    criteria_of,
    derivation,
    judgement,
    simulation,
    tracing,
    validation_of,
)
from reliab.sweep import open_ellipses


class CriterionStudy(Kind):
    """How much amplitude error and delay a test may have."""

    name = "criterion"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Simulate, trace, derive and validate."""
        return (
            *simulation(material, show),
            tracing(material, show),
            derivation(material.study),
            judgement(material, show),
        )

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report the criteria with the containment on held-out earthquakes."""
        from reliab.report.kinds.criterion import criterion_report
        from reliab.report.kinds.rates import rates_table

        rates = rates_table(validation_of(study, folder, study.validation.schemes[0]))
        return criterion_report(
            title=study.title,
            ellipses=open_ellipses(folder / ELLIPSES),
            criteria=criteria_of(folder),
            coverage=rates[rates["measure"] == "containment"],
            provenance=study.provenance,
            purpose=study.purpose,
        )
