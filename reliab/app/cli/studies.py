"""`reliab run` and `report`: a study from its motions to the report, and its report again."""

from dataclasses import dataclass
from pathlib import Path

from reliab.app.cli import options
from reliab.app.cli.completion import studies
from reliab.app.cli.demand import argument, flag, option, takes
from reliab.app.cli.output import console, progress_bar, say, table, write_json


@dataclass(frozen=True, kw_only=True)
class RunDemand(options.Reported):
    """Options of `reliab run`, arguments of `reliab.perform_study`."""

    study: str = argument(
        "[STUDY]",
        "Folder or file of a study, or the name of one that comes with reliab. Code in the folder is "
        "executed.",
        default="quick",
        autocompletion=studies,
    )
    out: Path | None = option("DIR", "Run folder; reliab-run/STUDY by default.")
    motions: list[str] | None = options.MOTIONS
    sets: list[str] | None = options.SETS
    list_all: bool = flag("List the studies that ship.", name="--list")
    json_target: str | None = options.JSON_TARGET


@takes(RunDemand)
def run(demand: RunDemand) -> None:
    """Run a study: simulate, fit, derive, validate, report."""
    from reliab.app.api.studies import list_studies, perform_study

    if demand.list_all:
        content = demand.ask(
            list_studies, "list_all", "json_target", why="together with `list_all`"
        ).to_dict()
        if not write_json(content, demand.json_target):
            shown = table("Studies that ship", {"study": "left", "kind": "left", "title": "left"})
            for row in content["studies"]:
                shown.add_row(*row.values())
            console().print(shown)
        return

    def tell(name: str, done: bool) -> None:  # noqa: FBT001 - called by position
        if demand.json_target != "-":
            say(f"{'done' if done else 'kept':>5}  {name}")

    performed = demand.ask(perform_study, *options.OF_REPORT, "json_target", show=progress_bar, tell=tell)
    if not write_json(performed.to_dict(), demand.json_target):
        say(f"Report: {performed.report}")


@dataclass(frozen=True, kw_only=True)
class ReportDemand(options.Reported):
    """Options of `reliab report`, arguments of `reliab.app.api.report_run`."""

    folder: Path = argument("DIR", "Run folder that `reliab run` wrote.")
    json_target: str | None = options.JSON_TARGET


@takes(ReportDemand)
def report(demand: ReportDemand) -> None:
    """Write the PDF of a finished run again, from its folder alone."""
    from reliab.app.api.studies import report_run

    written = demand.ask(report_run, *options.OF_REPORT, "json_target")
    if not write_json(written.to_dict(), demand.json_target):
        say(f"Report: {written.report}")
