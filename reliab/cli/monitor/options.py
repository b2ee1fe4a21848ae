"""Options of `reliab monitor`."""

from typing import Annotated

import typer

from reliab.cli.completion import samples

Source = Annotated[
    str,
    typer.Argument(
        metavar="FILE|-",
        autocompletion=samples,
        help="CSV file that is or will be written to, or - to read rows from standard input; or sample_test, "
        "which ships.",
    ),
]
Frequency = Annotated[
    str | None,
    typer.Option("--f", metavar="HZ", help="Natural frequency, 1 or with its standard deviation 1±0.01."),
]
DampingRatio = Annotated[
    str | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %, or 0.02±0.002.")
]
Alpha = Annotated[
    str, typer.Option("--alpha", metavar="SHARE", help="Share of the stiffness in the laboratory.")
]
Scale = Annotated[
    str,
    typer.Option(
        "--scale",
        metavar="RATIO",
        help="Scale of the displacement sensor; 1±0.005 where it may be off by 0.5 %.",
    ),
]
FeedbackLag = Annotated[
    str,
    typer.Option("--feedback-lag", metavar="MS", help="Time by which the force is fed back late [ms]."),
]
Threshold = Annotated[
    float, typer.Option("--threshold", metavar="ERROR", help="Largest error of a good test, 0.05 for 5 %.")
]
Column = Annotated[str | None, typer.Option(metavar="NAME", help="Name of the column, if not recognised.")]
Rate = Annotated[
    float | None, typer.Option("--rate", metavar="HZ", help="Sampling rate; by default read from the times.")
]
Units = Annotated[
    str | None, typer.Option("--units", metavar="m|mm|in...", help="Unit of both displacements.")
]
Every = Annotated[
    float, typer.Option("--every", metavar="SECONDS", help="Time of the test between two messages.")
]
Wait = Annotated[
    float,
    typer.Option(
        "--wait",
        metavar="SECONDS",
        help="Time without new rows after which the test counts as finished; longer than any pause of "
        "the test.",
    ),
]
StartWithin = Annotated[
    float,
    typer.Option(
        "--start-within",
        metavar="SECONDS",
        help="Time within which the file must appear and have its first row; Ctrl-C ends the waiting.",
    ),
]
JsonTarget = Annotated[
    str | None,
    typer.Option(
        "--json",
        metavar="FILE|-",
        help="One JSON object in a line for each message; '-' prints only these to standard output.",
    ),
]
