"""The study that reproduces Guo and others (2017) from the raw records."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import xarray as xr

from reliab.errors import InputError
from reliab.motions import Motion, MotionSuite, load_motions
from reliab.report import Document
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage
from reliab.study.steps import ELLIPSES, Material, Show, simulation, tracing
from reliab.sweep import open_ellipses

EXAMPLE: Final = "example.nc"
CASES: Final = "cases.nc"

_EXAMPLE_MOTION = "KOBE/NIS000"
_CASES_MOTION = "KOBE/KJM000"
_HELD_OUT = "held_out"


class PaperStudy(Kind):
    """Every table, figure and numbered equation of the paper beside what is printed."""

    name = "paper"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Simulate and trace all structures, then the example and the four cases."""
        if material.study.motions.sources is None:
            raise InputError(
                "The paper is reproduced from the records of its Table 2",
                value="no ground motions",
                remedy="Give the folder of the records with --motions",
            )
        return (
            _example(material, show),
            _cases(material),
            *simulation(material, show),
            tracing(material, show),
        )

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report the reproduction."""
        from reliab.report.kinds.paper import paper_report

        return paper_report(
            title=study.title,
            example=_opened(folder / EXAMPLE),
            ellipses=open_ellipses(folder / ELLIPSES),
            cases=_opened(folder / CASES),
            provenance={"study": study.title, "study, SHA-256": study.digest()},
        )


def _example(material: Material, show: Show) -> Stage:
    """Simulate the paper's example under one motion."""

    def work(folder: Path) -> None:
        from reliab.validation.paper_example import run_paper_example

        with show("Simulating the example"):
            example = run_paper_example(_named(material.motions, _EXAMPLE_MOTION))
        example.to_netcdf(folder / EXAMPLE, engine="h5netcdf")

    inputs = {"motion": _named(material.motions, _EXAMPLE_MOTION).checksum}
    return Stage(name="example", inputs=inputs, writes=(EXAMPLE,), work=work)


def _cases(material: Material) -> Stage:
    """Simulate the four cases under the motion that is held out."""
    held_out = load_motions(*(material.study.motions.sources or ()), sets=[_HELD_OUT])
    motion = _named(held_out, _CASES_MOTION)

    def work(folder: Path) -> None:
        from reliab.report.kinds.paper_cases import cases_dataset
        from reliab.validation.paper_cases import run_paper_cases

        cases_dataset(run_paper_cases(motion)).to_netcdf(folder / CASES, engine="h5netcdf")

    return Stage(name="cases", inputs={"motion": motion.checksum}, writes=(CASES,), work=work)


def _named(motions: MotionSuite, name: str) -> Motion:
    if name not in motions.names:
        raise InputError(
            f"The paper's study needs the motion {name}",
            value=f"{len(motions)} motions without it",
            remedy="Give a folder whose catalogue names it",
        )
    return motions[motions.names.index(name)]


def _opened(path: Path) -> xr.Dataset:
    with xr.open_dataset(path, engine="h5netcdf") as file:
        dataset: xr.Dataset = file.load()
    return dataset
