"""Arguments that questions share, each declared once, in groups from which questions derive."""

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, TypedDict

from reliab.app import completion
from reliab.app.declaration import Files, Panel, Quantities, Quantity
from reliab.sweep.several import Names, Numbers

if TYPE_CHECKING:
    from reliab.assessment.budget.sizes import Equipment
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


_FREQUENCY = STRUCTURE.option(
    "HZ",
    "Natural frequency of the whole structure [Hz]: 1.2, or 1.2±0.01 (± one standard deviation).",
    names=FREQUENCY_NAMES,
    idle_beside=_REPLACED_BY,
)


class FrequencyOption(TypedDict, total=False):
    """The natural frequency of a structure of one mass."""

    f: Annotated[Quantity | None, _FREQUENCY]


class FrequenciesOption(TypedDict, total=False):
    """Natural frequencies, of which a design takes several."""

    f: Annotated[Quantities | None, _FREQUENCY]


class DampingAndShare(TypedDict, total=False):
    """What else describes a structure of one mass."""

    xi: Annotated[
        Quantity | None,
        STRUCTURE.option(
            "RATIO",
            "Damping ratio of the whole structure: 0.02 for 2 %, or 0.02±0.002.",
            names=_DAMPING,
            idle_beside=_REPLACED_BY,
        ),
    ]
    alpha: Annotated[
        Quantity | None,
        STRUCTURE.option(
            "SHARE",
            "Fraction of the stiffness that is tested physically (default 1).",
            names=_SHARE,
            idle_beside=_REPLACED_BY,
        ),
    ]


class OneStructure(FrequencyOption, DampingAndShare, total=False):
    """A structure of one mass."""


class Structures(TypedDict, total=False):
    """One structure of one mass, or several."""

    f: Annotated[
        Numbers | None,
        STRUCTURE.option("HZ...", "Natural frequencies [Hz].", names=FREQUENCY_NAMES),
    ]
    xi: Annotated[
        Numbers | None, STRUCTURE.option("RATIO...", "Damping ratios, 0.02 for 2 %.", names=_DAMPING)
    ]
    alpha: Annotated[
        Numbers | None,
        STRUCTURE.advanced(
            "SHARE...",
            "Fractions of the stiffness that are tested physically; by default those of the source, or 1.",
            names=_SHARE,
        ),
    ]


class FrameFile(TypedDict, total=False):
    """A frame in place of a structure of one mass."""

    structure: Annotated[
        str | Path | None,
        STRUCTURE.option(
            "FRAME.toml", "Description of a frame and its specimen, instead of `f`, `xi` and `alpha`."
        ),
    ]


class SimulatedModel(TypedDict, total=False):
    """A hybrid test with effects in place of a structure, to be simulated under ground motions."""

    model: Annotated[
        "str | Path | HybridTest | None",
        STRUCTURE.advanced(
            "MODEL.toml", "Updated model with its structure, as `reliab diagnose --out` writes it."
        ),
    ]


class ComingMotion(TypedDict, total=False):
    """The ground motion of a test to come."""

    motion: Annotated[str | Path | None, MOTIONS.option("FILE", "Ground motion of the coming test.")]


class MotionSets(TypedDict, total=False):
    """Sets of a catalogue of ground motions."""

    sets: Annotated[
        Names | None,
        MOTIONS.advanced("NAME...", "Sets of a catalogue to use; held_out is used only if you name it."),
    ]


class MotionSource(MotionSets, total=False):
    """Where ground motions come from."""

    motions: Annotated[
        Files | None,
        MOTIONS.option(
            "SOURCE...",
            "Ground motions: records, folders, or the built-in suite synthetic.",
            completion=completion.suites,
        ),
    ]


class ResultSource(MotionSource, total=False):
    """Ground motions, or what was simulated with them."""

    results: Annotated[
        str | Path | None,
        MOTIONS.option(
            "STORE",
            "Results that `reliab simulate` stored, or real_suite, which comes with reliab.",
            completion=completion.results,
        ),
    ]


class Thresholds(TypedDict, total=False):
    """Errors that a test may have."""

    threshold: Annotated[
        Numbers | None, GOOD.option("ERROR...", "Largest acceptable errors of the whole test, 0.05 for 5 %.")
    ]


class Threshold(TypedDict, total=False):
    """The error that a test may have."""

    threshold: Annotated[
        float | None,
        GOOD.option(
            "ERROR",
            "Largest acceptable error of the whole test (default 0.05, 5 %).",
            idle_beside=("criterion",),
        ),
    ]


class ErrorMetric(TypedDict, total=False):
    """Which error counts."""

    metric: Annotated[
        str | None,
        GOOD.advanced(
            "rms|mte",
            "Error that counts: root mean square (rms, default) or largest value (mte).",
            completion=completion.metrics,
            idle_beside=("criterion",),
        ),
    ]


class ErrorWindow(TypedDict, total=False):
    """Over which part of a record an error is computed."""

    window: Annotated[
        str | None,
        GOOD.advanced(
            "record|SECONDS|arias",
            "Part of the record over which the error is computed; by default that of the source.",
        ),
    ]


class EllipseFile(TypedDict, total=False):
    """Ellipses that were traced before."""

    ellipses: Annotated[
        str | Path | None,
        MOTIONS.option(
            "FILE.csv|FILE.nc",
            "CSV with columns a, b and motion or event, or what `reliab ellipses` wrote; or real_suite.",
            completion=completion.results,
        ),
    ]


class EllipseSourceOptions(ResultSource, EllipseFile, total=False):
    """Where ellipses come from."""


class Confidence(TypedDict, total=False):
    """Share of the ground motions that a criterion promises."""

    confidence: Annotated[
        float | None,
        GOOD.advanced(
            "SHARE",
            "Fraction of comparable ground motions that the limits must cover (default 0.95).",
            idle_beside=("structure", "criterion"),
        ),
    ]


class Confidences(TypedDict, total=False):
    """Shares of the ground motions that a criterion promises."""

    confidence: Annotated[
        Numbers | None,
        GOOD.option(
            "SHARE...",
            "Fractions of comparable ground motions that the limits must cover.",
            idle_beside=("structure", "criterion"),
        ),
    ]


class Joint(TypedDict, total=False):
    """Whether limits hold together."""

    joint: Annotated[
        bool | None,
        METHOD.advanced(
            "",
            "Apply the confidence to a and b together, or to each alone; by default the method decides.",
            names=("--joint/--each",),
        ),
    ]


class Rate(TypedDict, total=False):
    """How often a test is sampled."""

    rate: Annotated[float | None, FILE.advanced("HZ", "Sampling rate [Hz], if there is no time column.")]


class ColumnOptions(Rate, total=False):
    """Which columns of a file are which channels."""

    command: Annotated[
        str | None, FILE.advanced("NAME", "Name of the command column, if reliab does not find it.")
    ]
    measured: Annotated[
        str | None, FILE.advanced("NAME", "Name of the measured column, if reliab does not find it.")
    ]
    time: Annotated[str | None, FILE.advanced("NAME", "Name of the time column, if reliab does not find it.")]
    units: Annotated[
        str | None, FILE.option("m|mm|in...", "Unit of both displacements, if the file does not state it.")
    ]
    channels: Annotated[
        str | Path | None,
        FILE.option(
            "CHANNELS.toml",
            "Names, units, signs, zeros, scales and calibration of your laboratory's channels.",
        ),
    ]


class TestFile(ColumnOptions, total=False):
    """How the file of a test is read."""

    test_name: Annotated[
        str | None,
        FILE.option("NAME", "Name of the test, if the file holds several; all for all.", names=("--test",)),
    ]
    time_units: Annotated[
        str | None, FILE.advanced("s|ms", "Unit of the time, if the file does not state it.")
    ]
    delimiter: Annotated[str | None, FILE.advanced("SIGN", "Column separator of a text file, such as ';'.")]


class Mass(TypedDict, total=False):
    """The mass of a structure."""

    mass: Annotated[
        Quantity | None,
        STRUCTURE.advanced(
            "KG",
            "Mass of the structure [kg]; also checks the unit of a recorded force.",
            idle_beside=_REPLACED_BY,
        ),
    ]


class SpecimenOptions(TypedDict, total=False):
    """How a specimen is known."""

    specimen: Annotated[
        str | None,
        STRUCTURE.advanced(
            "linear|measured",
            "linear: it stayed elastic; measured: learn it from its force (with `mass` or `structure`).",
        ),
    ]
    force_channel: Annotated[
        Iterable[str] | None,
        SENSORS.advanced(
            "NAME=VALUE",
            "Lag, attached mass or friction of the force: lag_ms=2±0.5, attached_kg=12±1, friction_n=40±20.",
        ),
    ]


class NonlinearModel(TypedDict, total=False):
    """A nonlinear specimen."""

    model: Annotated[
        "str | Path | UpdatedModel | None",
        STRUCTURE.advanced(
            "MODEL.toml",
            "Model of a nonlinear specimen, as `reliab diagnose` writes it.",
            idle_beside=_REPLACED_BY,
        ),
    ]


class LoopOptions(TypedDict, total=False):
    """What lies between structure and recording."""

    scale: Annotated[
        Quantity | None,
        SENSORS.option(
            "RATIO",
            "Scale of the displacement sensor: 1±0.005 if it may be off by 0.5 %.",
        ),
    ]
    feedback_lag: Annotated[
        Quantity | None,
        SENSORS.advanced("MS", "Delay of the fed-back force [ms] (default 0)."),
    ]


class Accuracy(TypedDict, total=False):
    """How exactly a laboratory measures."""

    equipment: Annotated[
        "str | Path | Equipment | None",
        SENSORS.option(
            "FILE.toml",
            "Accuracy of your equipment; anything left out gets a typical laboratory uncertainty.",
        ),
    ]
    exact: Annotated[
        bool,
        SENSORS.advanced_flag(
            "Assume that the channels and all values without a standard deviation are exact."
        ),
    ]


class Skew(TypedDict, total=False):
    """The clock of one channel against the other."""

    skew: Annotated[
        Quantity | None,
        SENSORS.advanced(
            "MS",
            "Time offset of the measured channel relative to the command [ms], such as 0±0.05.",
        ),
    ]


class CriterionFile(TypedDict, total=False):
    """A criterion of one's own."""

    criterion: Annotated[
        "str | Path | Criterion | None",
        GOOD.option(
            "FILE.json", "Criterion that `reliab criterion --out` wrote; by default the shipped one."
        ),
    ]


class TestLabels(TypedDict, total=False):
    """What is kept beside a test."""

    specimen: Annotated[str | None, TEST.option("TEXT", "Specimen of the test.")]
    date: Annotated[str | None, TEST.option("DATE", "Date of the test, 2026-03-01 or with a time.")]


class EarthquakeOption(TypedDict, total=False):
    """The earthquake behind a ground motion."""

    event: Annotated[str | None, TEST.option("NAME", "Earthquake of the ground motion.")]


class CovariatesOption(TypedDict, total=False):
    """Quantities on which a rig may depend."""

    covariate: Annotated[
        Iterable[str] | None,
        TEST.advanced(
            "NAME=NUMBER...", "Quantities that may affect the rig, such as current=0.4 or peak_mm=40."
        ),
    ]
