"""Options that several commands share, so that one name means one thing everywhere."""

from dataclasses import fields
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.completion import metrics, papers, results, suites
from reliab.errors import InputError

if TYPE_CHECKING:
    from reliab.report import Setting

Motions = Annotated[
    list[str] | None,
    typer.Option(
        "--motions",
        autocompletion=suites,
        metavar="SOURCE...",
        help="Records, folders or a built-in suite (synthetic).",
    ),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--sets",
        metavar="NAME...",
        help="Sets of a catalogue; the set held_out is left out unless you name it.",
    ),
]
Results = Annotated[
    Path | None,
    typer.Option(
        "--results",
        autocompletion=results,
        metavar="STORE",
        help="Results that `reliab simulate` stored, or real_suite, shipped.",
    ),
]
Ellipses = Annotated[
    Path | None,
    typer.Option(
        "--ellipses",
        autocompletion=results,
        metavar="FILE.csv|FILE.nc",
        help="Ellipses: columns a, b and motion or event; or as `reliab ellipses --out` keeps them.",
    ),
]
Frequencies = Annotated[
    list[float] | None, typer.Option("--f", metavar="HZ...", help="Natural frequencies [Hz].")
]
DampingRatios = Annotated[
    list[float] | None, typer.Option("--xi", metavar="RATIO...", help="Damping ratios, 0.02 for 2 %.")
]
Thresholds = Annotated[
    list[float] | None, typer.Option("--threshold", metavar="ERROR...", help="Errors, 0.05 for 5 %.")
]
MetricName = Annotated[
    str,
    typer.Option(
        "--metric", autocompletion=metrics, metavar="rms|mte", help="Error of the whole test: RMS^R or MTE^R."
    ),
]
WindowName = Annotated[
    str,
    typer.Option(
        "--window",
        metavar="record|SECONDS|arias",
        help="Part of the record over which the error is computed.",
    ),
]
WindowIfGiven = Annotated[
    str | None,
    typer.Option(
        "--window",
        metavar="record|SECONDS|arias",
        help="Part of the record over which the error is computed; by default that of the source, "
        "or the whole record.",
    ),
]
Fractions = Annotated[
    list[float] | None,
    typer.Option(
        "--alpha",
        metavar="SHARE...",
        help="Shares of the stiffness in the laboratory; by default those of the source, or 1.",
    ),
]
StructureFile = Annotated[
    Path | None,
    typer.Option(
        "--structure",
        metavar="FRAME.toml",
        help="A frame with its part in the laboratory (see datasets/frames), in place of --f, --xi, --alpha.",
    ),
]
ModelFile = Annotated[
    Path | None,
    typer.Option(
        "--model",
        metavar="MODEL.toml",
        help="Structure and effects of an updated model, as `reliab diagnose --out` writes it.",
    ),
]
FirstOrder = Annotated[
    bool,
    typer.Option(
        "--first-order",
        help="Predict ellipses from the records' spectra instead of simulating; unsafe at large errors: "
        "at 5 % the simulated b is 16 to 44 % smaller.",
    ),
]
ReportTitle = Annotated[
    str | None, typer.Option("--title", metavar="TEXT", help="Title of the report, in place of its own.")
]
ReportDate = Annotated[
    datetime | None,
    typer.Option("--date", formats=["%Y-%m-%d"], help="Date on the report, in place of that of the results."),
]
Paper = Annotated[
    str, typer.Option("--paper", autocompletion=papers, metavar="a4|letter", help="Paper of the report.")
]
Laboratory = Annotated[
    str | None, typer.Option("--laboratory", metavar="NAME", help="Name of the laboratory on the report.")
]
Logo = Annotated[
    Path | None,
    typer.Option("--logo", metavar="FILE.svg|png|jpg", help="Logo of the laboratory on the report."),
]
OF_REPORT = ("title", "date", "paper", "laboratory", "logo")
"""Options about how a report is set; they need a report."""

JsonTarget = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="FILE|-", help="Write JSON to a file; - prints only JSON to standard output."
    ),
]


def setting_of(
    title: str | None, date: datetime | None, paper: str, laboratory: str | None, logo: Path | None
) -> "Setting":
    """Take the options about how a report is set."""
    from reliab.report import Setting

    return Setting(
        title=title or "",
        date=None if date is None else date.date(),
        paper=paper,
        laboratory=laboratory or "",
        logo=logo,
    )


def given_options(context: typer.Context) -> list[str]:
    """Name the options that the user gave, as Python spells them."""
    return [
        name
        for name in context.params
        if (source := context.get_parameter_source(name)) is not None and source.name == "COMMANDLINE"
    ]


def options_of(demand: type, context: typer.Context) -> dict[str, Any]:
    """Take the options of a call that a demand has fields for.

    Returns values of the options by the names of the fields; None for one that may be repeated and is not
    given.
    """
    values = {field.name: context.params[field.name] for field in fields(demand)}
    return {name: None if value == () else value for name, value in values.items()}


def refuse_others(context: typer.Context, option: str) -> None:
    """Refuse options beside one that is used alone."""
    others = [name for name in given_options(context) if name != option]
    if others:
        raise InputError(
            f"--{others[0].replace('_', '-')} has no effect beside --{option.partition('_')[0]}",
            remedy="Leave it out",
        )


ONE_HERTZ, TWO_PERCENT, FIVE_PERCENT = 1.0, 0.02, 0.05
"""The paper's structure and threshold, the defaults of commands."""
