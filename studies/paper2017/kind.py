"""The study that reproduces Guo and others (2017) from the raw records."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from reliab.core.errors import InputError
from reliab.core.progress import show_task
from reliab.report.document import Document
from reliab.study.description import SimulatedStudy, StudyKind
from reliab.study.stages import Stage, software_provenance
from reliab.study.steps import ELLIPSES, Material, motion_by_name, read_run_dataset, simulation, tracing
from reliab.sweep.ellipse_dataset import open_ellipses
from reliab.sweep.netcdf import write_netcdf

from .cases_stage import CASES, paper_cases

EXAMPLE: Final = "example.nc"

_EXAMPLE_MOTION = "KOBE/NIS000"
_CASES_MOTION = "KOBE/KJM000"


def stages(study: SimulatedStudy) -> Sequence[Stage]:
    """Simulate and trace all structures, then the example and the four cases."""
    if study.motions.sources is None:
        raise InputError(
            "The paper is reproduced from the records of its Table 2",
            value="no ground motions",
            remedy="Give the folder of the records with `motions`",
        )
    material = Material(study)
    return (
        _example(material),
        paper_cases(study.motions.sources, _CASES_MOTION),
        *simulation(study, material),
        tracing(study, material),
    )


def report(study: SimulatedStudy, folder: Path) -> Document:
    """Report the reproduction."""
    from .pages.report import paper_report

    return paper_report(
        title=study.title,
        example=read_run_dataset(folder / EXAMPLE),
        ellipses=open_ellipses(folder / ELLIPSES),
        cases=read_run_dataset(folder / CASES),
        purpose=study.purpose,
        provenance={**study.provenance, **software_provenance(folder)},
    )


def _example(material: Material) -> Stage:
    """Simulate the paper's example under one motion."""

    def work(folder: Path) -> None:
        from .example import run_paper_example

        with show_task("Simulating the example"):
            example = run_paper_example(motion_by_name(material.motions, _EXAMPLE_MOTION))
        write_netcdf(example, folder / EXAMPLE)

    inputs = {"motion": motion_by_name(material.motions, _EXAMPLE_MOTION).checksum}
    return Stage(name="example", inputs=inputs, writes=(EXAMPLE,), work=work)


KIND: Final = StudyKind(name="paper", tables=SimulatedStudy, stages=stages, report=report)
"""Every table, figure and numbered equation of the paper, compared with what is printed."""
