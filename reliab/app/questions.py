"""What each function of `reliab.app.api` is asked, and so each command: groups of options, and its own."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from reliab.app import completion
from reliab.app.declaration import Files, Quantity, collect_options
from reliab.app.options import (
    FILE,
    GOOD,
    METHOD,
    MOTIONS,
    OUTPUT,
    SENSORS,
    STRUCTURE,
    TEST,
    Accuracy,
    ColumnOptions,
    ComingMotion,
    Confidence,
    Confidences,
    CovariatesOption,
    CriterionFile,
    DampingAndShare,
    EarthquakeOption,
    EllipseFile,
    EllipseSourceOptions,
    ErrorMetric,
    ErrorWindow,
    FrameFile,
    FrequenciesOption,
    Joint,
    LoopOptions,
    Mass,
    MotionSets,
    MotionSource,
    NonlinearModel,
    OneStructure,
    Rate,
    ResultSource,
    SimulatedModel,
    Skew,
    SpecimenOptions,
    Structures,
    TestFile,
    TestLabels,
    Threshold,
    Thresholds,
)
from reliab.sweep.several import Names

if TYPE_CHECKING:
    from reliab.motions.motion import Motion


class EllipsesQuestion(Structures, SimulatedModel, Thresholds, ErrorWindow, total=False):
    """What `reliab.ellipses` is asked."""

    first_order: Annotated[
        bool,
        METHOD.advanced_flag(
            "Predict ellipses from spectra instead of simulating: fast, but too generous at 5 %."
        ),
    ]


class TracingQuestion(EllipsesQuestion, ResultSource, ErrorMetric, total=False):
    """What `trace_boundaries` is asked."""

    out: Annotated[
        str | Path | None,
        OUTPUT.option(
            "FILE.nc", "Keep the ellipses in a file, which `reliab criterion` reads.", endings=(".nc",)
        ),
    ]


class SweepOptions(Structures, SimulatedModel, total=False):
    """What is simulated for every ground motion."""

    grid: Annotated[
        str,
        METHOD.advanced(
            "scaled|paper",
            "Gains and delays to simulate: scaled to each structure, or those of the paper.",
            default="scaled",
        ),
    ]
    window: Annotated[
        Names | None,
        GOOD.advanced(
            "record|SECONDS|arias...",
            "Part of the record over which errors are computed; several may be stored.",
        ),
    ]
    engine: Annotated[
        str,
        METHOD.advanced(
            "automatic|pole|delay|spectral", "How the equation of motion is solved.", default="automatic"
        ),
    ]


class SweepRunOptions(TypedDict, total=False):
    """How a sweep is run."""

    resume: Annotated[bool, OUTPUT.flag("Continue the store of an interrupted run.")]
    workers: Annotated[
        int | None, METHOD.advanced("N", "Threads; all processors by default.", limits={"min": 1})
    ]
    scheduler: Annotated[
        str | None, METHOD.advanced("ADDRESS", "Address of a dask scheduler whose workers solve the motions.")
    ]


class SweepQuestion(SweepOptions, SweepRunOptions, total=False):
    """What `reliab.simulate` is asked."""


class SimulationQuestion(SweepQuestion, MotionSource, total=False):
    """What `simulate_suite` is asked."""


class CriterionQuestion(
    ComingMotion,
    Structures,
    FrameFile,
    SimulatedModel,
    EllipseSourceOptions,
    Thresholds,
    Confidences,
    ErrorMetric,
    ErrorWindow,
    Joint,
    total=False,
):
    """What `derive_criteria` is asked."""

    actuator: Annotated[
        int | None,
        STRUCTURE.advanced(
            "N", "The one actuator of `structure` that errs, counted from 1; by default all err alike."
        ),
    ]
    duration: Annotated[
        float | None,
        MOTIONS.advanced(
            "SECONDS",
            "Length of your records; by default like those of the motions behind the criterion.",
        ),
    ]
    suite: Annotated[
        Files | None,
        MOTIONS.advanced(
            "NAME|FOLDER...",
            "A few records of expected earthquakes, pooled with the motions behind the criterion.",
        ),
    ]
    method: Annotated[
        str | None,
        METHOD.option(
            "NAME",
            "What the confidence means: dirichlet (the default), quantile (the paper's), or another.",
            completion=completion.methods,
        ),
    ]
    assurance: Annotated[
        float | None,
        METHOD.advanced("SHARE", "Probability that the confidence is kept, for methods that take it."),
    ]
    distribution: Annotated[
        str | None, METHOD.advanced("NAME", "Family of distributions for the method quantile.")
    ]
    law: Annotated[
        str,
        METHOD.option(
            "NAME",
            "How the limits depend on f and ξ: table (the default), or another law.",
            default="table",
            completion=completion.laws,
        ),
    ]
    steps: Annotated[
        int | None, METHOD.advanced("N", "Steps of the hierarchical methods' chains, a multiple of 4.")
    ]
    chains: Annotated[
        str | Path | None,
        METHOD.advanced(
            "FILE.h5", "Keep the chains of the hierarchical methods, so that a run can go on with them."
        ),
    ]
    compare: Annotated[bool, METHOD.advanced_flag("Test distributions and laws on unseen earthquakes, too.")]
    figures: Annotated[
        str | Path | None,
        OUTPUT.advanced("FOLDER", "Folder for figures of the criteria and their posteriors."),
    ]
    out: Annotated[
        str | Path | None,
        OUTPUT.option(
            "FILE.json", "Write the criterion, for `reliab assess --criterion`.", endings=(".json",)
        ),
    ]


class TrialOptions(TypedDict, total=False):
    """How many tests are simulated."""

    trials: Annotated[
        int | None,
        METHOD.advanced(
            "N",
            "Tests for each structure, 512 by default.",
            limits={"min": 1},
        ),
    ]


class ProbabilityQuestion(
    TrialOptions, Structures, EllipseSourceOptions, Threshold, ErrorMetric, ErrorWindow, total=False
):
    """Criteria that are tested on motions from which they were not learned."""

    scheme: Annotated[
        str | None,
        METHOD.option(
            "NAME",
            "leave_one_event_out (the default), k_fold, random_halves, region, magnitude or length.",
        ),
    ]


class ValidationQuestion(ProbabilityQuestion, Confidences, Joint, total=False):
    """What `reliab.validate_criteria` is asked."""

    leave_out: Annotated[
        str | None, METHOD.advanced("f|xi", "Leave out each frequency or damping ratio in turn, too.")
    ]
    learn: Annotated[
        Names | None, MOTIONS.advanced("SET...", "Sets of `motions` to learn from, or real_suite.")
    ]
    judge: Annotated[
        Names | None,
        MOTIONS.advanced("SET...", "Sets of `motions` to judge; all of them with `learn=real_suite`."),
    ]
    method: Annotated[
        Names | None,
        METHOD.option(
            "NAME...",
            "What the confidence means, one method or several; dirichlet by default.",
            completion=completion.methods,
        ),
    ]
    law: Annotated[
        Names | None,
        METHOD.advanced(
            "NAME...",
            "Fitted or printed laws; table and the printed ones by default.",
            completion=completion.laws,
        ),
    ]


class AssessmentQuestion(
    OneStructure,
    Mass,
    SpecimenOptions,
    NonlinearModel,
    TestFile,
    LoopOptions,
    Accuracy,
    Skew,
    Threshold,
    CriterionFile,
    ErrorMetric,
    Confidence,
    total=False,
):
    """What `reliab.assess` is told of a test."""

    command_scale: Annotated[
        Quantity | None, SENSORS.advanced("RATIO", "Scale of the recorded command, such as 1±0.001.")
    ]
    hysteresis: Annotated[
        Quantity | None,
        SENSORS.advanced(
            "SHARE",
            "Hysteresis of the displacement sensor over the span of its motion, such as 0.001±0.0003.",
        ),
    ]
    resolution: Annotated[
        Quantity | None,
        SENSORS.advanced("MM", "ADC step of the displacement sensor [mm]."),
    ]
    filter: Annotated[
        Iterable[str] | None,
        SENSORS.advanced(
            "CHANNEL=HZ",
            "Analogue low-pass filter of a channel: measured=200, or command=200/4 with its order.",
        ),
    ]
    motion: Annotated[
        "str | Path | Motion | None",
        STRUCTURE.advanced(
            "FILE", "Ground motion of this test; the limits for A and d are then those of this record."
        ),
    ]


class DesignQuestion(
    FrequenciesOption, DampingAndShare, CriterionFile, Threshold, Confidences, ErrorMetric, total=False
):
    """What `reliab.design_test` is asked."""

    structure: Annotated[
        str | Path | None,
        STRUCTURE.advanced("FRAME.toml", "Refused with what to ask of a frame.", limits={"hidden": True}),
    ]


class MonitorOptions(
    OneStructure, FrameFile, NonlinearModel, LoopOptions, Threshold, ErrorMetric, total=False
):
    """What every monitor is told of its test."""


class MonitorQuestion(MonitorOptions, Mass, SpecimenOptions, Accuracy, ColumnOptions, total=False):
    """What `reliab.follow_test` is asked."""

    every: Annotated[float, OUTPUT.advanced("SECONDS", "Test time between two messages.", default=0.5)]
    wait: Annotated[
        float,
        FILE.advanced(
            "SECONDS",
            "Pause after which the test counts as finished; longer than any pause in it.",
            default=10.0,
        ),
    ]
    start_within: Annotated[
        float,
        FILE.advanced(
            "SECONDS",
            "How long to wait for the first row; Ctrl-C stops waiting.",
            default=600.0,
        ),
    ]


class LoopMonitorQuestion(MonitorOptions, Rate, total=False):
    """What `reliab.export_monitor` is asked; the rate is that of the loop."""


class OriginOptions(TestLabels, total=False):
    """Where and by whom a test was made."""

    rig: Annotated[str | None, TEST.option("TEXT", "Rig of the test.")]
    operator: Annotated[str | None, TEST.option("TEXT", "Operator.")]


class RecordQuestion(OneStructure, Mass, TestFile, OriginOptions, total=False):
    """What `reliab.record` is asked."""

    csv: Annotated[
        str | Path | None,
        OUTPUT.option("TEST.csv", "The recognised channels as CSV, in SI units.", endings=(".csv",)),
    ]


class CalibrationQuestion(TestFile, total=False):
    """What `reliab.calibrate` is asked."""

    out: Annotated[
        str | Path | None,
        OUTPUT.option("CHANNELS.toml", "File for `channels` of the commands that read tests."),
    ]
    actuator_delay: Annotated[
        Quantity | None,
        TEST.option(
            "MS",
            "Delay of the actuator in this test [ms], 12±0.5; 0 if both channels record one signal.",
        ),
    ]


class AddedTestQuestion(
    OneStructure,
    FrameFile,
    Mass,
    TestFile,
    LoopOptions,
    Accuracy,
    Skew,
    Threshold,
    CriterionFile,
    TestLabels,
    EarthquakeOption,
    CovariatesOption,
    total=False,
):
    """What `reliab.add_to_rig` is told of tests."""

    note: Annotated[str | None, TEST.option("TEXT", "Further remarks.")]


class RigReportQuestion(OneStructure, Threshold, total=False):
    """What `reliab.report_rig` is told of the next test; what is left out is as in the last test."""


class PredictionQuestion(
    ComingMotion, RigReportQuestion, FrameFile, TestLabels, CovariatesOption, total=False
):
    """What `reliab.predict_rig` is asked."""

    suite: Annotated[
        str | None,
        MOTIONS.advanced(
            "NAME", "Suite from which the next motion will be taken: real_suite, synthetic, or a folder."
        ),
    ]


class MotionQuestion(MotionSets, total=False):
    """How records of ground motions are read."""

    time_step: Annotated[float | None, MOTIONS.advanced("SECONDS", "Time step of records that state none.")]
    units: Annotated[str | None, MOTIONS.option("g|cm/s2|m/s2", "Unit of records that state none.")]


class MotionImportQuestion(MotionQuestion, EarthquakeOption, total=False):
    """What `reliab.import_motions` is asked; its earthquake is that of all motions."""


class SyntheticSuiteQuestion(TypedDict, total=False):
    """What `reliab.synthesize_motions` is asked."""

    count: Annotated[int, MOTIONS.option("N", "Number of components.", default=100, limits={"min": 2})]
    seed: Annotated[
        int | None, MOTIONS.option("N", "Seed of a suite other than the built-in one.", limits={"min": 0})
    ]


class ExplorerQuestion(OneStructure, EllipseFile, Threshold, ErrorMetric, Confidence, total=False):
    """What `reliab.write_explorer` is asked: above all with what its page opens."""

    out: Annotated[
        str | Path,
        OUTPUT.option("FILE.html", "The page to write.", default=Path("criterion.html"), endings=(".html",)),
    ]


def select_stated(question: type, request: Mapping[str, Any]) -> dict[str, Any]:
    """Select what another question is asked among what is stated."""
    return {name: request[name] for name in collect_options(question) if request.get(name) is not None}
