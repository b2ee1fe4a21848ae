"""`reliab run` and `report`: a study from its motions to the report, and its report again."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from reliab.app import completion, options, outputs
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import progress_bar, say, show_table
from reliab.app.declaration import argument

if TYPE_CHECKING:
    from reliab.app.api.studies import StudyList

_COVER = tuple(outputs.Cover.__annotations__)


class _Study(options.MotionSource, outputs.Folder, outputs.Listing, outputs.Cover, total=False):
    study: Annotated[
        str,
        argument(
            "[STUDY]",
            "Folder or file of a study, or the name of one that comes with reliab. Code in the folder is "
            "executed.",
            default="quick",
            completion=completion.studies,
        ),
    ]


@takes(_Study)
def run(request: Request) -> None:
    """Run a study: simulate, fit, derive, validate, report."""
    from reliab.app.api.studies import PerformedStudy, list_studies, run_study

    if request.list_all:
        reason = "together with `list_all`"
        request.answer(list_studies, _show_studies, "list_all", reason=reason)
        return

    def tell(name: str, done: bool) -> None:  # noqa: FBT001 - called by position
        if request.json_target != "-":
            say(f"{'done' if done else 'kept':>5}  {name}")

    def show(performed: PerformedStudy) -> None:
        say(*filter(None, (performed.answer, f"Report: {performed.report}")))

    request.answer(run_study, show, *_COVER, setting=request.setting(), show=progress_bar, tell=tell)


def _show_studies(studies: "StudyList") -> None:
    show_table("Studies that ship", ("study", "kind", "title"), [tuple(row.values()) for row in studies.rows])


class _Run(outputs.Cover, total=False):
    folder: Annotated[Path, argument("DIR", "Run folder that `reliab run` wrote.")]


@takes(_Run)
def report(request: Request) -> None:
    """Rebuild the PDF of a finished run."""
    from reliab.app.api.studies import report_run

    request.answer(report_run, lambda run: say(f"Report: {run.report}"), *_COVER, setting=request.setting())
