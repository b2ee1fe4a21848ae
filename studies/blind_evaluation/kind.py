"""The study that reports how often diagnoses of blind campaigns were right."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from reliab.core.shipped import shipped
from reliab.report.document import Document
from reliab.study.description import Study, StudyKind
from reliab.study.stages import Stage, digest, read_result, software_provenance

EVALUATION: Final = "evaluation.json"


def stages(study: Study) -> Sequence[Stage]:
    """Take the figures that ship; the campaigns themselves do not."""
    del study
    figures = shipped("datasets", f"campaigns/{EVALUATION}")

    def work(folder: Path) -> None:
        shutil.copyfile(figures, folder / EVALUATION)

    inputs = {"figures": digest(figures)}
    return (Stage(name="figures", inputs=inputs, writes=(EVALUATION,), work=work),)


def report(study: Study, folder: Path) -> Document:
    """Report the figures of every run."""
    from .report import blind_evaluation_report

    return blind_evaluation_report(
        title=study.title,
        runs=read_result(folder / EVALUATION)["runs"],
        provenance={
            **study.provenance,
            "figures, SHA-256": digest(folder / EVALUATION),
            **software_provenance(folder),
        },
        notes=(study.purpose,) if study.purpose else (),
    )


KIND: Final = StudyKind(name="blind_evaluation", tables=Study, stages=stages, report=report)
"""Diagnoses of blind campaigns against what was hidden in them."""
