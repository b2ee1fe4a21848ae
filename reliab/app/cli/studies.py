"""`reliab run` and `report`: a study from its motions to the report, and its report again."""

from pathlib import Path
from typing import Annotated

from reliab.app import completion, options, outputs
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import progress_bar, say, show_table, write_json
from reliab.app.declaration import argument

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
def run(asked: Asked) -> None:
    """Run a study: simulate, fit, derive, validate, report."""
    from reliab.app.api.studies import list_studies, run_study

    if asked.list_all:
        content = asked.ask(list_studies, "list_all", "json_target", why="together with `list_all`").to_dict()
        if not write_json(content, asked.json_target):
            rows = [tuple(row.values()) for row in content["studies"]]
            show_table("Studies that ship", ("study", "kind", "title"), rows)
        return

    def tell(name: str, done: bool) -> None:  # noqa: FBT001 - called by position
        if asked.json_target != "-":
            say(f"{'done' if done else 'kept':>5}  {name}")

    performed = asked.ask(
        run_study, *_COVER, "json_target", setting=asked.setting(), show=progress_bar, tell=tell
    )
    if not write_json(performed.to_dict(), asked.json_target):
        say(*filter(None, (performed.answer, f"Report: {performed.report}")))


class _Run(outputs.Cover, total=False):
    folder: Annotated[Path, argument("DIR", "Run folder that `reliab run` wrote.")]


@takes(_Run)
def report(asked: Asked) -> None:
    """Rebuild the PDF of a finished run."""
    from reliab.app.api.studies import report_run

    written = asked.ask(report_run, *_COVER, "json_target", setting=asked.setting())
    if not write_json(written.to_dict(), asked.json_target):
        say(f"Report: {written.report}")
