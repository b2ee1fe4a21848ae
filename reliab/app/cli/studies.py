"""`reliab run` and `report`: a study from its motions to the report, and its report again."""

from reliab.app import options, questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, show_rows

_COVER = tuple(options.Cover.__annotations__)


@takes(questions.StudyArgument, options.Folder, options.Listing, options.Cover)
def run(request: Request) -> None:
    """Run a study: simulate, fit, derive, validate, report."""
    from reliab.app.api.studies import PerformedStudy, list_studies, run_study

    if request.list_all:
        request.answer(
            list_studies,
            lambda studies: show_rows("Studies that ship", studies.table_columns, studies.rows),
            "list_all",
            reason="together with `list_all`",
        )
        return

    def tell(name: str, is_new: bool) -> None:  # noqa: FBT001 - called by position
        if request.json_target != "-":
            say(f"{'done' if is_new else 'kept':>5}  {name}")

    def show(result: PerformedStudy) -> None:
        say(*filter(None, (result.answer, f"Report: {result.report}")))

    request.answer(run_study, show, *_COVER, setting=request.setting(), tell=tell)


@takes(options.Cover, questions.RunArgument)
def report(request: Request) -> None:
    """Rebuild the PDF of a finished run."""
    from reliab.app.api.studies import report_run

    request.answer(report_run, lambda run: say(f"Report: {run.report}"), *_COVER, setting=request.setting())
