"""`reliab report`: the PDF of a finished run."""

from dataclasses import dataclass
from pathlib import Path

from reliab.cli.demand import argument, takes
from reliab.cli.options import JSON_TARGET, OF_REPORT, Reported
from reliab.cli.output import say, write_json


@dataclass(frozen=True, kw_only=True)
class ReportDemand(Reported):
    """Options of `reliab report`, arguments of `reliab.report_run`."""

    folder: Path = argument("DIR", "Run folder that `reliab run` wrote.")
    json_target: str | None = JSON_TARGET


@takes(ReportDemand)
def report(demand: ReportDemand) -> None:
    """Write the PDF of a finished run again, from its folder alone."""
    from reliab.api import report_run

    written = demand.ask(report_run, *OF_REPORT, "json_target")
    if not write_json(written.to_dict(), demand.json_target):
        say(f"Report: {written.report}")
