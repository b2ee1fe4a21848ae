"""`reliab report`: the PDF of a finished run."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.options import JsonTarget, Laboratory, Logo, Paper, ReportDate, ReportTitle, setting_of
from reliab.cli.output import console, write_json


def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Run folder that `reliab run` wrote.")],
    *,
    title: ReportTitle = None,
    date: ReportDate = None,
    paper: Paper = "a4",
    laboratory: Laboratory = None,
    logo: Logo = None,
    json_target: JsonTarget = None,
) -> None:
    """Write the PDF of a finished run again, from its folder alone."""
    from reliab.study import write_report

    written = write_report(folder, setting=setting_of(title, date, paper, laboratory, logo))
    if not write_json({"folder": str(folder), "report": str(written)}, json_target):
        console().print(f"Report: {written}", highlight=False)
