"""Options that several commands share, so that one name means one thing everywhere."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reliab.cli.completion import metrics, papers, results, suites
from reliab.cli.demand import Demand
from reliab.files import require_ending

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


def written_as(*endings: str) -> Callable[[Path | None], Path | None]:
    """Refuse a file to write whose name ends otherwise, before anything is computed for it."""

    def check(path: Path | None) -> Path | None:
        if path is not None:
            require_ending(path, *endings)
        return path

    return check


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
        help="Shares of the structure's stiffness in the laboratory; by default those of the source, or 1.",
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
StatedDampingRatio = Annotated[
    str | None,
    typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %, or 0.02±0.002."),
]
StatedShare = Annotated[
    str | None,
    typer.Option(
        "--alpha",
        metavar="SHARE",
        help="Share of the structure's stiffness in the laboratory, 1 (all of it) by default.",
    ),
]
SensorScale = Annotated[
    str | None,
    typer.Option(
        "--scale",
        metavar="RATIO",
        help="Scale of the displacement sensor, 1 by default; 1±0.005 where it may be off by 0.5 %.",
    ),
]
FeedbackLag = Annotated[
    str | None,
    typer.Option(
        "--feedback-lag",
        metavar="MS",
        help="Time by which the force is fed back late [ms], 0 by default.",
    ),
]
MassOfStructure = Annotated[
    str | None,
    typer.Option(
        "--mass",
        metavar="KG",
        help="Mass of the structure; with it the unit of a recorded force is examined, and beside "
        "a recorded ground acceleration the force is also used to identify the structure.",
    ),
]
ChannelSkew = Annotated[
    str | None,
    typer.Option(
        "--skew",
        metavar="MS",
        help="Time by which the measured displacement was recorded later than the command [ms], 0±0.05.",
    ),
]
EquipmentFile = Annotated[
    Path | None,
    typer.Option(
        "--equipment",
        metavar="FILE.toml",
        help="Accuracy of your equipment where no option states it; ordinary equipment by default.",
    ),
]
SpecimenKnown = Annotated[
    str | None,
    typer.Option(
        "--specimen",
        metavar="linear|measured",
        help="How the specimen is known: linear, or measured: learned from its recorded force, which "
        "needs --mass or --structure. By default linear, but it may have yielded where no force was "
        "recorded.",
    ),
]
HeldByForce = Annotated[
    list[str] | None,
    typer.Option(
        "--force-channel",
        metavar="NAME=VALUE",
        help="What the force of a measured specimen holds beside it: lag_ms=2±0.5, attached_kg=12±1, "
        "friction_n=40±20.",
    ),
]
TakenAsExact = Annotated[
    bool,
    typer.Option(
        "--exact",
        help="Take channels, and values that are stated without a standard deviation, as exact.",
    ),
]
CriterionFile = Annotated[
    Path | None,
    typer.Option(
        "--criterion", metavar="FILE.json", help="Criterion, as `reliab criterion --out` writes it."
    ),
]
ErrorThreshold = Annotated[
    float | None,
    typer.Option("--threshold", metavar="ERROR", help="Error of the whole test, 0.05 for 5 %."),
]
JsonTarget = Annotated[
    str | None,
    typer.Option(
        "--json", metavar="FILE|-", help="Write JSON to a file; - prints only JSON to standard output."
    ),
]
Column = Annotated[str | None, typer.Option(metavar="NAME", help="Name of the column, if not recognised.")]
Units = Annotated[
    str | None, typer.Option("--units", metavar="m|mm|in...", help="Unit of both displacements.")
]
TimeUnits = Annotated[str | None, typer.Option("--time-units", metavar="s|ms", help="Unit of the time.")]
Rate = Annotated[
    float | None, typer.Option("--rate", metavar="HZ", help="Sampling rate, if there is no time column.")
]
Delimiter = Annotated[
    str | None,
    typer.Option("--delimiter", metavar="SIGN", help="Character between the columns of a text file."),
]
TestName = Annotated[
    str | None, typer.Option("--test", metavar="NAME", help="Which test, if the file holds several.")
]
ChannelsFile = Annotated[
    Path | None,
    typer.Option(
        "--channels",
        metavar="CHANNELS.toml",
        help="Names, units, signs, zeros and scales of your laboratory's channels.",
    ),
]

OF_REPORT = ("title", "date", "paper", "laboratory", "logo")
"""Options about how a report is set; they need a report."""


@dataclass(frozen=True, kw_only=True)
class ReadsTests(Demand):
    """Options of a command that reads a test of a file: which test, which columns, in what units."""

    channels: ChannelsFile = None
    test_name: TestName = None
    command: Column = None
    measured: Column = None
    time: Column = None
    rate: Rate = None
    units: Units = None
    time_units: TimeUnits = None
    delimiter: Delimiter = None


@dataclass(frozen=True, kw_only=True)
class Reported(Demand):
    """Options of a command that writes a report."""

    title: Annotated[
        str | None, typer.Option("--title", metavar="TEXT", help="Title of the report, in place of its own.")
    ] = None
    date: Annotated[
        datetime | None,
        typer.Option(
            "--date", formats=["%Y-%m-%d"], help="Date on the report, in place of that of the results."
        ),
    ] = None
    paper: Annotated[
        str, typer.Option("--paper", autocompletion=papers, metavar="a4|letter", help="Paper of the report.")
    ] = "a4"
    laboratory: Annotated[
        str | None, typer.Option("--laboratory", metavar="NAME", help="Name of the laboratory on the report.")
    ] = None
    logo: Annotated[
        Path | None,
        typer.Option("--logo", metavar="FILE.svg|png|jpg", help="Logo of the laboratory on the report."),
    ] = None

    @property
    def setting(self) -> "Setting":
        """How the report is set."""
        from reliab.report import Setting

        return Setting(
            title=self.title or "",
            date=None if self.date is None else self.date.date(),
            paper=self.paper,
            laboratory=self.laboratory or "",
            logo=self.logo,
        )
