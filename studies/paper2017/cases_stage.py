"""The stage of a study that runs the paper's four cases under a motion that is held out."""

from pathlib import Path
from typing import Final

from reliab.core.progress import show_task
from reliab.motions.loading import load_motions
from reliab.study.stages import Stage
from reliab.study.steps import motion_by_name
from reliab.sweep.netcdf import write_netcdf

CASES: Final = "cases.nc"

_HELD_OUT = "held_out"


def paper_cases(sources: tuple[str, ...], name: str) -> Stage:
    """Run the paper's four cases under a motion that is held out."""
    motion = motion_by_name(load_motions(*sources, sets=[_HELD_OUT]), name)

    def work(folder: Path) -> None:
        from .cases import cases_dataset, run_paper_cases

        with show_task("Simulating the four cases"):
            outcomes = run_paper_cases(motion)
        write_netcdf(cases_dataset(outcomes, motion), folder / CASES)

    return Stage(name="cases", inputs={"motion": motion.checksum}, writes=(CASES,), work=work)
