"""Running a study, and making its report again."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from reliab.report import write_pdf
from reliab.shipped import shipped
from reliab.study.description import Study, read_study
from reliab.study.kinds import KINDS
from reliab.study.stages import RunFolder, Stage, study_of
from reliab.study.steps import Material, Show, quietly

REPORT: Final = "report.pdf"
"""File of the report in the folder of a run."""

DEFAULT_STUDY: Final = "quick"
"""The study that is run where none is named."""


def run_study(
    study: Study,
    out: str | Path,
    *,
    show: Show = quietly,
    tell: Callable[[str, bool], None] = lambda _name, _done: None,
) -> Path:
    """Run a study, from its motions to the report; what is done already is not done again.

    Parameters
    ----------
    study : Study
        The study.
    out : str or pathlib.Path
        Its run folder.
    show : callable, optional
        Shows the progress of what it is told the name of.
    tell : callable, optional
        Called after each stage with its name and whether there was something to do.

    Returns
    -------
    pathlib.Path
        The report.

    Raises
    ------
    InputError
        If the study asks for what is not there, or the folder holds something else.
    """
    kind, material = KINDS[study.kind], Material(study)
    folder = RunFolder(Path(out), study=study.model_dump(mode="json"))
    stages = list(kind.stages(material, show))
    for stage in (*stages, _reporting(study, [name for each in stages for name in each.writes])):
        tell(stage.name, folder.perform(stage))
    return folder.path / REPORT


def write_report(folder: str | Path) -> Path:
    """Make the report of a finished run again.

    Parameters
    ----------
    folder : str or pathlib.Path
        The run folder.

    Returns
    -------
    pathlib.Path
        The report, a PDF.

    Raises
    ------
    InputError
        If nothing was run there, or the run is not finished.
    """
    folder = Path(folder)
    study = Study.model_validate(study_of(folder))
    _report(study, folder)
    return folder / REPORT


def open_study(name: str | Path) -> Study:
    """Read a study from its file, or one that ships by its name.

    Parameters
    ----------
    name : str or pathlib.Path
        A TOML file, or a name such as ``quick``.

    Returns
    -------
    Study
        The study.

    Raises
    ------
    InputError
        If there is none, or its file is not allowed.
    """
    path = Path(name)
    if not path.exists() and not path.suffix and len(path.parts) == 1:
        path = shipped("studies", f"{name}.toml")
    return read_study(path)


def shipped_studies() -> dict[str, Study]:
    """Return every study that ships, by its name."""
    folder = shipped("studies", f"{DEFAULT_STUDY}.toml").parent
    return {path.stem: read_study(path) for path in sorted(folder.glob("*.toml"))}


def _reporting(study: Study, reads: list[str]) -> Stage:
    def work(folder: Path) -> None:
        _report(study, folder)

    return Stage(
        name="report", inputs=study.model_dump(mode="json"), reads=reads, writes=(REPORT,), work=work
    )


def _report(study: Study, folder: Path) -> None:
    write_pdf(KINDS[study.kind].report(study, folder), folder / REPORT, date=study.date)
