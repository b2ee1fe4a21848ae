"""Arguments that questions share, each declared once, in groups from which questions derive."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, TypedDict

from reliab.app import declaration
from reliab.app.declaration import Files, Panel, Quantities, Quantity, argument, group, single
from reliab.core.stated_value import Names, Numbers

if TYPE_CHECKING:
    from reliab.assessment.budget.sizes import Equipment
    from reliab.assessment.measured_specimen.force_channel import ForceChannel
    from reliab.criterion.criterion import Criterion
    from reliab.simulation.hybrid_test.model import HybridTest
    from reliab.simulation.hybrid_test.model_file import UpdatedModel

STRUCTURE: Final = Panel("Your structure")
MOTIONS: Final = Panel("Ground motions")
TEST: Final = Panel("Your test")
FILE: Final = Panel("Your file")
SENSORS: Final = Panel("Your sensors")
GOOD: Final = Panel("What is good enough")
METHOD: Final = Panel("Method")
OUTPUT: Final = Panel("Output")
COVER: Final = Panel("Report cover")
HELP: Final = Panel("Help")
PANELS: Final = (STRUCTURE, MOTIONS, TEST, FILE, SENSORS, GOOD, METHOD, OUTPUT, COVER, HELP)
"""Parts of the help in their order."""

FREQUENCY_NAMES, _DAMPING, _SHARE = ("", "--frequency"), ("", "--damping"), ("", "--share")
_REPLACED_BY = ("structure",)


_FREQUENCY = STRUCTURE.option("HZ", names=FREQUENCY_NAMES, idle_beside=_REPLACED_BY)


@group
class FrequencyOption(TypedDict, total=False):
    """Natural frequency of the whole structure [Hz]: 1.2, or 1.2±0.01 (± one standard deviation)."""

    f: Annotated[Quantity | None, _FREQUENCY]


class FrequenciesOption(TypedDict, total=False):
    """Natural frequencies, of which a design takes several."""

    f: Annotated[Quantities | None, _FREQUENCY]


@group
class DampingAndShare(TypedDict, total=False):
    """What else describes a structure of one mass.

    xi: Damping ratio of the whole structure: 0.02 for 2 %, or 0.02±0.002.
    alpha: Fraction of the stiffness that is tested physically (default 1).
    """

    xi: Annotated[Quantity | None, STRUCTURE.option("RATIO", names=_DAMPING, idle_beside=_REPLACED_BY)]
    alpha: Annotated[Quantity | None, STRUCTURE.option("SHARE", names=_SHARE, idle_beside=_REPLACED_BY)]


class OneStructure(FrequencyOption, DampingAndShare, total=False):
    """A structure of one mass."""


@group
class Structures(TypedDict, total=False):
    """One structure of one mass, or several.

    f: Natural frequencies [Hz].
    xi: Damping ratios, 0.02 for 2 %.
    alpha: Fractions of the stiffness that are tested physically; by default those of the source, or 1.
    """

    f: Annotated[Numbers | None, STRUCTURE.option("HZ...", names=FREQUENCY_NAMES)]
    xi: Annotated[Numbers | None, STRUCTURE.option("RATIO...", names=_DAMPING)]
    alpha: Annotated[Numbers | None, STRUCTURE.advanced("SHARE...", names=_SHARE)]


@group
class FrameFile(TypedDict, total=False):
    """Description of a frame and its specimen, instead of `f`, `xi` and `alpha`."""

    structure: Annotated[str | Path | None, STRUCTURE.option("FRAME.toml")]


@group
class SimulatedModel(TypedDict, total=False):
    """Updated model with its structure, as `reliab diagnose --out` writes it."""

    model: Annotated["str | Path | HybridTest | None", STRUCTURE.advanced("MODEL.toml")]


@group
class ComingMotion(TypedDict, total=False):
    """Ground motion of the coming test."""

    motion: Annotated[str | Path | None, MOTIONS.option("FILE")]


@group
class MotionSets(TypedDict, total=False):
    """Sets of a catalogue to use; held_out is used only if you name it."""

    sets: Annotated[Names | None, MOTIONS.advanced("NAME...")]


@group
class MotionSource(MotionSets, total=False):
    """Ground motions: records, folders, or the built-in suite synthetic."""

    motions: Annotated[Files | None, MOTIONS.option("SOURCE...", completion=declaration.suites)]


@group
class ResultSource(MotionSource, total=False):
    """Results that `reliab simulate` stored, or real_suite, which comes with reliab."""

    results: Annotated[str | Path | None, MOTIONS.option("STORE", completion=declaration.results)]


@group
class Thresholds(TypedDict, total=False):
    """Largest acceptable errors of the whole test, 0.05 for 5 %."""

    threshold: Annotated[Numbers | None, GOOD.option("ERROR...")]


@group
class Threshold(TypedDict, total=False):
    """Largest acceptable error of the whole test (default 0.05, 5 %)."""

    threshold: Annotated[float | None, GOOD.option("ERROR", idle_beside=("criterion",))]


@group
class ErrorMetric(TypedDict, total=False):
    """Error that counts: root mean square (rms, default) or largest value (mte)."""

    metric: Annotated[
        str | None, GOOD.advanced("rms|mte", completion=declaration.metrics, idle_beside=("criterion",))
    ]


@group
class ErrorWindow(TypedDict, total=False):
    """Part of the record over which the error is computed; by default that of the source."""

    window: Annotated[str | None, GOOD.advanced("record|SECONDS|arias")]


@group
class EllipseFile(TypedDict, total=False):
    """CSV with columns a, b and motion or event, or what `reliab ellipses` wrote; or real_suite."""

    ellipses: Annotated[str | Path | None, MOTIONS.option("FILE.csv|FILE.nc", completion=declaration.results)]


class EllipseSourceOptions(ResultSource, EllipseFile, total=False):
    """Where ellipses come from."""


@group
class Confidence(TypedDict, total=False):
    """Fraction of comparable ground motions that the limits must cover (default 0.95)."""

    confidence: Annotated[float | None, GOOD.advanced("SHARE", idle_beside=("structure", "criterion"))]


@group
class Confidences(TypedDict, total=False):
    """Fractions of comparable ground motions that the limits must cover."""

    confidence: Annotated[Numbers | None, GOOD.option("SHARE...", idle_beside=("structure", "criterion"))]


@group
class Joint(TypedDict, total=False):
    """Apply the confidence to a and b together, or to each alone; by default the method decides."""

    joint: Annotated[bool | None, METHOD.advanced("", names=("--joint/--each",))]


@group
class Rate(TypedDict, total=False):
    """Sampling rate [Hz], if there is no time column."""

    rate: Annotated[float | None, FILE.advanced("HZ")]


@group
class ColumnOptions(Rate, total=False):
    """Which columns of a file are which channels.

    command: Name of the command column, if reliab does not find it.
    measured: Name of the measured column, if reliab does not find it.
    time: Name of the time column, if reliab does not find it.
    units: Unit of both displacements, if the file does not state it.
    channels: Names, units, signs, zeros, scales and calibration of your laboratory's channels.
    """

    command: Annotated[str | None, FILE.advanced("NAME")]
    measured: Annotated[str | None, FILE.advanced("NAME")]
    time: Annotated[str | None, FILE.advanced("NAME")]
    units: Annotated[str | None, FILE.option("m|mm|in...")]
    channels: Annotated[str | Path | None, FILE.option("CHANNELS.toml")]


@group
class TestFile(ColumnOptions, total=False):
    """How the file of a test is read.

    test_name: Name of the test, if the file holds several; all for all.
    time_units: Unit of the time, if the file does not state it.
    delimiter: Column separator of a text file, such as ';'.
    """

    test_name: Annotated[str | None, FILE.option("NAME", names=("--test",))]
    time_units: Annotated[str | None, FILE.advanced("s|ms")]
    delimiter: Annotated[str | None, FILE.advanced("SIGN")]


@group
class Mass(TypedDict, total=False):
    """Mass of the structure [kg]; also checks the unit of a recorded force."""

    mass: Annotated[Quantity | None, STRUCTURE.advanced("KG", idle_beside=_REPLACED_BY)]


@group
class SpecimenOptions(TypedDict, total=False):
    """How a specimen is known.

    specimen: linear: it stayed elastic; measured: learn it from its force (with `mass` or `structure`).
    force_channel: Lag, attached mass or friction of the force: lag_ms=2±0.5, attached_kg=12±1,
        friction_n=40±20.
    """

    specimen: Annotated[str | None, STRUCTURE.advanced("linear|measured")]
    force_channel: Annotated["Iterable[str] | ForceChannel | None", SENSORS.advanced("NAME=VALUE")]


@group
class NonlinearModel(TypedDict, total=False):
    """Model of a nonlinear specimen, as `reliab diagnose` writes it."""

    model: Annotated[
        "str | Path | UpdatedModel | None", STRUCTURE.advanced("MODEL.toml", idle_beside=_REPLACED_BY)
    ]


@group
class LoopOptions(TypedDict, total=False):
    """What lies between structure and recording.

    scale: Scale of the displacement sensor: 1±0.005 if it may be off by 0.5 %.
    feedback_lag: Delay of the fed-back force [ms] (default 0).
    """

    scale: Annotated[Quantity | None, SENSORS.option("RATIO")]
    feedback_lag: Annotated[Quantity | None, SENSORS.advanced("MS")]


@group
class Accuracy(TypedDict, total=False):
    """How exactly a laboratory measures.

    equipment: Accuracy of your equipment; anything left out gets a typical laboratory uncertainty.
    exact: Assume that the channels and all values without a standard deviation are exact.
    """

    equipment: Annotated["str | Path | Equipment | None", SENSORS.option("FILE.toml")]
    exact: Annotated[bool, SENSORS.advanced_flag()]


@group
class Skew(TypedDict, total=False):
    """Time offset of the measured channel relative to the command [ms], such as 0±0.05."""

    skew: Annotated[Quantity | None, SENSORS.advanced("MS")]


@group
class CriterionFile(TypedDict, total=False):
    """Criterion that `reliab criterion --out` wrote; by default the shipped one."""

    criterion: Annotated["str | Path | Criterion | None", GOOD.option("FILE.json")]


@group
class TestLabels(TypedDict, total=False):
    """What is kept beside a test.

    specimen: Specimen of the test.
    date: Date of the test, 2026-03-01 or with a time.
    """

    specimen: Annotated[str | None, TEST.option("TEXT")]
    date: Annotated[str | None, TEST.option("DATE")]


@group
class EarthquakeOption(TypedDict, total=False):
    """Earthquake of the ground motion."""

    event: Annotated[str | None, TEST.option("NAME")]


@group
class CovariatesOption(TypedDict, total=False):
    """Quantities that may affect the rig, such as current=0.4 or peak_mm=40."""

    covariate: Annotated[Iterable[str] | None, TEST.advanced("NAME=NUMBER...")]


JSON = single(
    "json_target",
    str | None,
    OUTPUT.option("FILE|-", names=("--json",)),
    "Write JSON to a file; - prints only JSON to standard output.",
)
LISTING = single("list_all", bool, OUTPUT.flag(names=("--list",)), "List what ships and can be chosen.")
CHECK = single("check", bool, OUTPUT.flag(), "Exit with code 1 unless the test is reliable.")
DETAILS = single("details", bool, OUTPUT.flag(), "Print all results, not only the most important ones.")
CHART = single(
    "figure",
    Path | None,
    OUTPUT.option("FILE.svg|png|pdf", endings=(".svg", ".png", ".pdf")),
    "Draw the answer as a chart.",
)
FOLDER = single("out", Path | None, OUTPUT.option("DIR"), "Folder for report and results.")


@group
class Cover(TypedDict, total=False):
    """How a report is set.

    title: Title of the report, in place of its own.
    date: Date on the report, 2026-03-01, in place of that of the results.
    paper: Paper of the report.
    laboratory: Name of the laboratory on the report.
    logo: Logo of the laboratory on the report.
    """

    title: Annotated[str | None, COVER.advanced("TEXT")]
    date: Annotated[str | None, COVER.advanced("DATE")]
    paper: Annotated[str, COVER.advanced("a4|letter", default="a4", completion=declaration.papers)]
    laboratory: Annotated[str | None, COVER.advanced("NAME")]
    logo: Annotated[str | Path | None, COVER.advanced("FILE.svg|png|jpg")]


@group
class Tests(FrameFile, total=False):
    """Tests of a command line, and a table of what is found.

    tests: Files with command and measured displacement: text, MATLAB, HDF5, TDMS or NetCDF; or sample_test,
        which comes with reliab.
    out: Write the answer as a table, one row for each test.
    """

    tests: Annotated[list[Path] | None, argument("[TEST]...", default=None, completion=declaration.samples)]
    out: Annotated[Path | None, OUTPUT.option("FILE.csv", endings=(".csv",))]
