"""Options of `reliab validate`."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.completion import laws, methods

Threshold = Annotated[
    float | None, typer.Option("--threshold", metavar="ERROR", help="Error, 0.05 for 5 %, the default.")
]
Scheme = Annotated[
    str | None,
    typer.Option(
        "--scheme",
        metavar="NAME",
        help="How earthquakes are divided: leave_one_event_out (default), k_fold or random_halves.",
    ),
]
LeaveOut = Annotated[
    str | None,
    typer.Option(
        "--leave-out", metavar="f|xi", help="Also leave out each frequency or damping ratio in turn."
    ),
]
Learn = Annotated[
    list[str] | None,
    typer.Option(
        "--learn",
        metavar="SET...",
        help="Sets of --motions to learn from, or real_suite: the shipped results of 100 real motions.",
    ),
]
Judge = Annotated[
    list[str] | None,
    typer.Option(
        "--judge", metavar="SET...", help="Sets of --motions to judge; all of them with --learn real_suite."
    ),
]
Methods = Annotated[
    list[str] | None,
    typer.Option(
        "--method",
        autocompletion=methods,
        metavar="NAME...",
        help="Meanings of the confidence; dirichlet by default.",
    ),
]
Joint = Annotated[
    bool | None,
    typer.Option(
        "--joint/--each",
        help="Whether the confidence holds for a and b together or for each of them separately; by "
        "default as the method defines it.",
    ),
]
Laws = Annotated[
    list[str] | None,
    typer.Option(
        "--law",
        autocompletion=laws,
        metavar="NAME...",
        help="Fitted or printed laws; table and printed by default.",
    ),
]
Confidences = Annotated[
    list[float] | None, typer.Option("--confidence", metavar="SHARE...", help="Stated shares of the motions.")
]
Tests = Annotated[
    int | None,
    typer.Option(
        "--trials",
        min=1,
        help="Tests per structure, near the boundaries, 512 by default; with --rebuilt-error, tests of each "
        "kind of actuator and specimen, 6 by default.",
    ),
]
Calibration = Annotated[
    bool,
    typer.Option(
        "--calibration",
        help="Compare the probabilities that are stated for tests with how many of the tests are good.",
    ),
]
Case = Annotated[
    str | None,
    typer.Option("--case", metavar="MOTION", help="Run the paper's four cases under this motion instead."),
]
IntegratorName = Annotated[
    str | None,
    typer.Option(
        "--integrator",
        metavar="NAME",
        help="For --case: chen_ricles (the paper's), central_difference, operator_splitting or exact.",
    ),
]
CompensatorName = Annotated[
    str | None,
    typer.Option(
        "--compensator",
        metavar="NAME",
        help="For --case: inverse (the paper's), feedforward, polynomial_extrapolation or none.",
    ),
]
RebuiltError = Annotated[
    bool,
    typer.Option(
        "--rebuilt-error",
        help="Judge simulated tests by their rebuilt error, by criteria, and by the boundary of the "
        "test's motion.",
    ),
]
TestsFile = Annotated[
    Path | None,
    typer.Option(
        "--tests",
        metavar="FILE.csv",
        help="For --rebuilt-error: file of all tests and verdicts, from which an interrupted run resumes.",
    ),
]
