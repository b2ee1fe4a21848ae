"""`reliab report`: the PDF of a finished run."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.demand import takes
from reliab.cli.options import OF_REPORT, JsonTarget, Reported
from reliab.cli.output import console, write_json


@dataclass(frozen=True, kw_only=True)
class ReportDemand(Reported):
    """Options of `reliab report`, arguments of `reliab.report_run`."""

    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Run folder that `reliab run` wrote.")]
    json_target: JsonTarget = None


@takes(ReportDemand)
def report(demand: ReportDemand) -> None:
    """Write the PDF of a finished run again, from its folder alone."""
    from reliab.api import report_run

    written = demand.ask(report_run, *OF_REPORT, "json_target")
    if not write_json(written.to_dict(), demand.json_target):
        console().print(f"Report: {written.report}", highlight=False)
