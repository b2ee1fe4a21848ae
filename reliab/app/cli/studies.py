"""`reliab run`, `report`, `samples`, `fetch` and `info`: studies, what ships, and facts for a bug report."""

from typing import Any

from reliab.app import options, questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import say, show_rows, write_line

_COVER = tuple(options.Cover.__annotations__)


@takes(questions.StudyArgument, options.FOLDER, options.LISTING, options.Cover)
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


@takes(options.Cover, questions.RUN_FOLDER)
def report(request: Request) -> None:
    """Rebuild the PDF of a finished run."""
    from reliab.app.api.studies import report_run

    request.answer(report_run, lambda run: say(f"Report: {run.report}"), *_COVER, setting=request.setting())


@takes(questions.LISTED_DATA)
def fetch(request: Request) -> None:
    """Fetch the data that are too large for the package: results.nc of real_suite."""
    from reliab.app.api.studies import fetch_dataset

    request.answer(
        fetch_dataset,
        lambda path: write_line(f"{path}: the checksum is as listed"),
        content=lambda path: {"file": str(path)},
    )


@takes(questions.SAMPLE_FOLDER)
def samples(request: Request) -> None:
    """Write sample files into a folder; files that you changed are kept."""
    from reliab.app.api.studies import copy_samples

    request.answer(
        copy_samples,
        lambda paths: write_line("\n".join(map(str, paths))),
        content=lambda paths: {"samples": [*map(str, paths)]},
    )


@takes()
def info(request: Request) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    from reliab.app.api.studies import describe_installation

    request.answer(describe_installation, _show_facts, content=dict)


def _show_facts(facts: dict[str, Any]) -> None:
    for name, value in facts.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")
