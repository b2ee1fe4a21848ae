"""Options that several commands share, so that one name means one thing everywhere."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, TypeVar

from reliab.app.cli.completion import metrics, papers, results, suites
from reliab.app.cli.demand import Demand, flag, option
from reliab.core.errors import InputError
from reliab.core.files import require_ending

if TYPE_CHECKING:
    from reliab.report.setting import Setting

MOTIONS = option(
    "SOURCE...", "Ground motions: records, folders or a built-in suite (synthetic).", autocompletion=suites
)
SETS = option("NAME...", "Sets of a catalogue; the set held_out is left out unless you name it.")


def written_as(*endings: str) -> Callable[[Path | None], Path | None]:
    """Refuse a file to write whose name ends otherwise, before anything is computed for it."""

    def check(path: Path | None) -> Path | None:
        if path is not None:
            require_ending(path, *endings)
        return path

    return check


RESULTS = option(
    "STORE",
    "Results stored by `reliab simulate`, or real_suite, which comes with reliab.",
    autocompletion=results,
)
ELLIPSES = option(
    "FILE.csv|FILE.nc",
    "File of ellipses: a CSV with columns a, b and motion or event, or one written by `reliab ellipses "
    "--out`.",
    autocompletion=results,
)
FREQUENCIES = option("HZ...", "Natural frequencies [Hz].")
DAMPING_RATIOS = option("RATIO...", "Damping ratios, 0.02 for 2 %.")
THRESHOLDS = option("ERROR...", "Largest acceptable errors of the whole test, 0.05 for 5 %.")
METRIC_NAME = option(
    "rms|mte", "Error of the whole test: RMS^R or MTE^R.", default="rms", autocompletion=metrics
)
WINDOW_NAME = option(
    "record|SECONDS|arias", "Part of the record over which the error is computed.", default="record"
)
WINDOW_IF_GIVEN = option(
    "record|SECONDS|arias",
    "Part of the record over which the error is computed; by default that of the source, "
    "or the whole record.",
)
FRACTIONS = option(
    "SHARE...", "Shares of the structure's stiffness in the laboratory; by default those of the source, or 1."
)
STRUCTURE_FILE = option(
    "FRAME.toml",
    "File of a frame and its specimen (see datasets/frames), in place of --f, --xi, --alpha.",
)
MODEL_FILE = option(
    "MODEL.toml", "Structure and effects of an updated model, as `reliab diagnose --out` writes it."
)
STATED_DAMPING_RATIO = option("RATIO", "Damping ratio, 0.02 for 2 %, or 0.02±0.002.")
STATED_SHARE = option(
    "SHARE", "Share of the structure's stiffness in the laboratory, 1 (all of it) by default."
)
SENSOR_SCALE = option(
    "RATIO", "Scale of the displacement sensor, 1 by default; 1±0.005 where it may be off by 0.5 %."
)
FEEDBACK_LAG = option("MS", "Time by which the force is fed back late [ms], 0 by default.")
MASS_OF_STRUCTURE = option(
    "KG",
    "Mass of the structure, with which the unit of a recorded force is checked; where the "
    "ground acceleration was recorded, too, the force also helps to identify the structure.",
)
CHANNEL_SKEW = option(
    "MS", "Time by which the measured displacement was recorded later than the command [ms], 0±0.05."
)
EQUIPMENT_FILE = option(
    "FILE.toml", "Accuracy of your equipment where no option states it; ordinary equipment by default."
)
SPECIMEN_KNOWN = option(
    "linear|measured",
    "How the specimen is known: linear, or measured: learned from its recorded force, which "
    "needs --mass or --structure. By default linear; where no force was recorded, the interval allows "
    "for yielding.",
)
HELD_BY_FORCE = option(
    "NAME=VALUE",
    "What else the recorded force of a measured specimen contains: lag_ms=2±0.5, attached_kg=12±1, "
    "friction_n=40±20.",
)
TAKEN_AS_EXACT = flag("Take channels, and values that are stated without a standard deviation, as exact.")
_TABLE_BEGINS = b"file,"
CRITERION_FILE = option("FILE.json", "Criterion, as `reliab criterion --out` writes it.")
ERROR_THRESHOLD = option("ERROR", "Largest acceptable error of the whole test, 0.05 for 5 %.")
JSON_TARGET = option("FILE|-", "Write JSON to a file; - prints only JSON to standard output.", name="--json")
COLUMN = option("NAME", "Column of this channel, if it is not recognised.")
UNITS = option("m|mm|in...", "Unit of both displacements.")
TIME_UNITS = option("s|ms", "Unit of the time.")
RATE = option("HZ", "Sampling rate, if there is no time column.")
DELIMITER = option("SIGN", "Character between the columns of a text file.")
TEST_NAME = option("NAME", "Name of the test, if the file holds several.", name="--test")
CHANNELS_FILE = option(
    "CHANNELS.toml", "Names, units, signs, zeros and scales of your laboratory's channels."
)

OF_REPORT = ("title", "date", "paper", "laboratory", "logo")
"""Options about how a report is set; they need a report."""


@dataclass(frozen=True, kw_only=True)
class ReadsTests(Demand):
    """Options of a command that reads a test of a file: which test, which columns, in what units."""

    channels: Path | None = CHANNELS_FILE
    test_name: str | None = TEST_NAME
    command: str | None = COLUMN
    measured: str | None = COLUMN
    time: str | None = COLUMN
    rate: float | None = RATE
    units: str | None = UNITS
    time_units: str | None = TIME_UNITS
    delimiter: str | None = DELIMITER


@dataclass(frozen=True, kw_only=True)
class Reported(Demand):
    """Options of a command that writes a report."""

    title: str | None = option("TEXT", "Title of the report, in place of its own.")
    date: datetime | None = option(
        "", "Date on the report, in place of that of the results.", formats=["%Y-%m-%d"]
    )
    paper: str = option("a4|letter", "Paper of the report.", default="a4", autocompletion=papers)
    laboratory: str | None = option("NAME", "Name of the laboratory on the report.")
    logo: Path | None = option("FILE.svg|png|jpg", "Logo of the laboratory on the report.")

    @property
    def setting(self) -> "Setting":
        """How the report is set."""
        from reliab.report.setting import Setting

        return Setting(
            title=self.title or "",
            date=None if self.date is None else self.date.date(),
            paper=self.paper,
            laboratory=self.laboratory or "",
            logo=self.logo,
        )


_Value = TypeVar("_Value")


@dataclass(frozen=True, kw_only=True)
class JudgesTests(Demand):
    """Options of a command that judges tests; arguments of `reliab.assess`."""

    f: list[str] | None = option("HZ", "Natural frequency, 1 or with its standard deviation 1±0.01.")
    xi: str | None = STATED_DAMPING_RATIO
    alpha: str | None = STATED_SHARE
    scale: str | None = SENSOR_SCALE
    feedback_lag: str | None = FEEDBACK_LAG
    mass: str | None = MASS_OF_STRUCTURE
    skew: str | None = CHANNEL_SKEW
    command_scale: str | None = option("RATIO", "Scale of the recorded command, 1±0.001.")
    hysteresis: str | None = option(
        "SHARE", "Hysteresis of the displacement sensor: width of its loop over the span, 0.001±0.0003."
    )
    resolution: str | None = option("MM", "Step of the converter of the measured displacement [mm].")
    filter: list[str] | None = option(
        "CHANNEL=HZ", "Low-pass filters before the converters: measured=200, command=200/4 with the order."
    )
    equipment: Path | None = EQUIPMENT_FILE
    exact: bool = TAKEN_AS_EXACT
    motion: Path | None = option(
        "FILE",
        "Ground motion of the test; the index is then compared with the boundary of this motion; "
        "errors of a frame's floors and storeys are then relative to their own peaks.",
    )
    criterion: Path | None = CRITERION_FILE
    model: Path | None = option(
        "MODEL.toml", "Model of a nonlinear specimen, as `reliab diagnose` writes it."
    )
    specimen: str | None = SPECIMEN_KNOWN
    force_channel: list[str] | None = HELD_BY_FORCE
    structure: Path | None = STRUCTURE_FILE
    threshold: float | None = ERROR_THRESHOLD
    confidence: list[float] | None = option(
        "SHARE", "Share of the population's ground motions that the criterion holds for, 0.95."
    )
    metric: str | None = option(
        "rms|mte", "Error of the whole test: RMS^R (default) or MTE^R.", autocompletion=metrics
    )

    idle_beside: ClassVar[Mapping[str, Collection[str]]] = {
        "criterion": ("threshold", "confidence", "metric"),
        "structure": ("f", "xi", "alpha", "mass", "model", "confidence"),
    }


def files_of(tests: Sequence[Path] | None, out: Path | None) -> list[Path]:
    """Files of the tests, also those that a pattern such as ``*.csv`` names where the shell does not."""
    files = []
    for path in tests or []:
        names = [] if path.exists() else glob(str(path))  # noqa: PTH207 - absolute patterns too
        files += [Path(name) for name in sorted(names)] or [path]
    if out in files and not _is_table(out):
        raise InputError(
            "The table must not be written over a test", value=f"`out` {out}", remedy="Name another file"
        )
    return [file for file in files if file != out]


def _is_table(path: Path) -> bool:
    """Tell whether a file is the table of an earlier run, which a pattern names among the tests."""
    try:
        return path.read_bytes()[: len(_TABLE_BEGINS)] == _TABLE_BEGINS
    except OSError:
        return True  # it is not there yet


def only_value(values: Sequence[_Value] | None, name: str) -> _Value | None:
    """Take the value of an option that may be repeated for a design, but not for a test."""
    if not values:
        return None
    if len(values) > 1:
        raise InputError(
            f"A test has one `{name}`", value=len(values), remedy="Give several with `design` only"
        )
    return values[0]
