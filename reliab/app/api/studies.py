"""`reliab.run_study`: a study from its name to the report; which studies ship; a report made again."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Unpack

from reliab.app import options, questions
from reliab.app.api.sources import as_list
from reliab.app.declaration import asks
from reliab.core.columns import Columns
from reliab.core.plain_values import PlainResult, ResultWithRows
from reliab.report.setting import ReportSetting
from reliab.study import running
from reliab.study.running import ANSWER, list_shipped, open_study, write_report

_OUT = Path("reliab-run")


@dataclass(frozen=True, kw_only=True)
class PerformedStudy(PlainResult):
    """A study that was run: its folder, its report and its stages."""

    keys: ClassVar[Mapping[str, str]] = {
        "study": "title",
        "folder": "folder",
        "report": "report",
        "stages": "stages",
        "answer": "answer",
    }

    title: str
    folder: Path
    report: Path
    stages: Mapping[str, bool]
    answer: str = ""  # What the report says in one sentence


@asks(questions.StudyArgument, options.Folder)
def run_study(
    study: str | Path = "quick",
    *,
    out: str | Path | None = None,
    setting: ReportSetting | None = None,
    tell: Callable[[str, bool], None] = lambda _name, _is_new: None,
    **request: Unpack[options.MotionSource],
) -> PerformedStudy:
    """Run a study: simulate, fit, derive, validate, report.

    Parameters
    ----------
    tell : callable, optional
        Called after each stage with its name and whether there was something to do.

    Raises
    ------
    InputError
        If there is no such study, it asks for what is not there, or the folder holds something else.
    """
    description = open_study(study)
    if request["motions"] or request["sets"]:
        description = description.replace_motions(as_list(request["motions"]), as_list(request["sets"]))
    place = Path(study).resolve()
    name = place.parent.name if place.name == "study.toml" else place.stem
    folder = _OUT / name if out is None else Path(out)
    stages: dict[str, bool] = {}

    def count(stage: str, is_new: bool) -> None:  # noqa: FBT001 - called by position
        stages[stage] = is_new
        tell(stage, is_new)

    report = running.run_study(description, folder, tell=count, setting=setting)
    answer_file = folder / ANSWER
    answer = answer_file.read_text(encoding="utf-8") if answer_file.exists() else ""
    return PerformedStudy(title=description.title, folder=folder, report=report, stages=stages, answer=answer)


@dataclass(frozen=True)
class StudyList(ResultWithRows):
    """Studies that ship."""

    rows_in = "studies"
    keys: ClassVar[Mapping[str, str]] = {"studies": "rows"}
    table_columns: ClassVar[Columns] = {"study": ("name", ""), "kind": ("kind", ""), "title": ("title", "")}

    rows: list[dict[str, str]]


def list_studies() -> StudyList:
    """List the studies that ship.

    Returns
    -------
    StudyList
        Their names, kinds and titles.

    Examples
    --------
    >>> "quick" in [row["name"] for row in list_studies().rows]
    True
    """
    return StudyList(list_shipped())


@dataclass(frozen=True, kw_only=True)
class WrittenReport(PlainResult):
    """A report that was made of a finished run."""

    folder: Path
    report: Path


@asks(questions.RunArgument)
def report_run(folder: str | Path, *, setting: ReportSetting | None = None) -> WrittenReport:
    """Write the PDF of a finished run again, from its folder alone."""
    return WrittenReport(folder=Path(folder), report=write_report(folder, setting=setting))
