"""Options that several commands share, so that one name means one thing everywhere."""

from pathlib import Path
from typing import Annotated

import typer

Motions = Annotated[
    list[str] | None,
    typer.Option("--motions", metavar="SOURCE...", help="Records, folders or a built-in suite (synthetic)."),
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
        "--results", metavar="STORE", help="Results that `reliab simulate` stored, or real_suite, shipped."
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
    str, typer.Option("--metric", metavar="rms|mte", help="Error of the whole test: RMS^R or MTE^R.")
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
FractionIfGiven = Annotated[
    float | None,
    typer.Option(
        "--alpha",
        metavar="SHARE",
        help="Share of the stiffness in the laboratory; by default that of the source, or 1.",
    ),
]
ExperimentalFraction = Annotated[
    float, typer.Option("--alpha", metavar="SHARE", help="Share of the stiffness in the laboratory.")
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
JsonTarget = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="FILE|-", help="Write JSON to a file; - prints only JSON to standard output."
    ),
]

ONE_HERTZ, TWO_PERCENT, FIVE_PERCENT = 1.0, 0.02, 0.05
"""The paper's structure and threshold, where a command is told nothing else."""
