"""The study that reports how often diagnoses of blind campaigns were right."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from reliab.report import Document
from reliab.shipped import shipped
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage, digest
from reliab.study.steps import Material, Show

EVALUATION: Final = "evaluation.json"


class BlindEvaluationStudy(Kind):
    """Diagnoses of blind campaigns against what was hidden in them; the campaigns themselves do not ship."""

    name = "blind_evaluation"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Take the figures that ship."""
        del material, show
        figures = shipped("datasets", f"campaigns/{EVALUATION}")

        def work(folder: Path) -> None:
            shutil.copyfile(figures, folder / EVALUATION)

        inputs = {"figures": digest(figures)}
        return (Stage(name="figures", inputs=inputs, writes=(EVALUATION,), work=work),)

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report the figures of every run."""
        from reliab.report.kinds.blind_evaluation import blind_evaluation_report

        return blind_evaluation_report(
            title=study.title,
            runs=json.loads((folder / EVALUATION).read_text(encoding="utf-8"))["runs"],
            provenance={**study.provenance, "figures, SHA-256": digest(folder / EVALUATION)},
            notes=(study.purpose,) if study.purpose else (),
        )
