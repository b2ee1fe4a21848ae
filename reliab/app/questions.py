"""What each function of `reliab.app.api` is asked, and so each command: groups of options, and its own."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypedDict

from reliab.app import declaration
from reliab.app.declaration import Files, Quantity, argument, collect_options, group, single
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
from reliab.core.stated_value import Names

if TYPE_CHECKING:
    from reliab.motions.motion import Motion


@group
class EllipsesQuestion(Structures, SimulatedModel, Thresholds, ErrorWindow, total=False):
    """What `reliab.ellipses` is asked.

    first_order: Predict ellipses from spectra instead of simulating: fast, but too generous at 5 %.
    """

    first_order: Annotated[bool, METHOD.advanced_flag()]


@group
class TracingQuestion(EllipsesQuestion, ResultSource, ErrorMetric, total=False):
    """What `trace_boundaries` is asked.

    out: Keep the ellipses in a file, which `reliab criterion` reads.
    """

    out: Annotated[str | Path | None, OUTPUT.option("FILE.nc", endings=(".nc",))]


@group
class SweepOptions(Structures, SimulatedModel, total=False):
    """What is simulated for every ground motion.

    grid: Gains and delays to simulate: scaled to each structure, or those of the paper.
    window: Part of the record over which errors are computed; several may be stored.
    engine: How the equation of motion is solved.
    """

    grid: Annotated[str, METHOD.advanced("scaled|paper", default="scaled")]
    window: Annotated[Names | None, GOOD.advanced("record|SECONDS|arias...")]
    engine: Annotated[str, METHOD.advanced("automatic|pole|delay|spectral", default="automatic")]


@group
class SweepRunOptions(TypedDict, total=False):
    """How a sweep is run.

    resume: Continue the store of an interrupted run.
    workers: Threads; all processors by default.
    scheduler: Address of a dask scheduler whose workers solve the motions.
    """

    resume: Annotated[bool, OUTPUT.flag()]
    workers: Annotated[int | None, METHOD.advanced("N", limits={"min": 1})]
    scheduler: Annotated[str | None, METHOD.advanced("ADDRESS")]


class SweepQuestion(SweepOptions, SweepRunOptions, total=False):
    """What `reliab.simulate` is asked."""


class SimulationQuestion(SweepQuestion, MotionSource, total=False):
    """What `simulate_suite` is asked."""


@group
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
    """What `derive_criteria` is asked.

    actuator: The one actuator of `structure` that errs, counted from 1; by default all err alike.
    duration: Length of your records; by default like those of the motions behind the criterion.
    suite: A few records of expected earthquakes, pooled with the motions behind the criterion.
    method: What the confidence means: dirichlet (the default), quantile (the paper's), or another.
    assurance: Probability that the confidence is kept, for methods that take it.
    distribution: Family of distributions for the method quantile.
    law: How the limits depend on f and ξ: table (the default), or another law.
    steps: Steps of the hierarchical methods' chains, a multiple of 4.
    chains: Keep the chains of the hierarchical methods, so that a run can go on with them.
    figures: Folder for figures of the criteria and their posteriors.
    out: Write the criterion, for `reliab assess --criterion`.
    """

    actuator: Annotated[int | None, STRUCTURE.advanced("N")]
    duration: Annotated[float | None, MOTIONS.advanced("SECONDS")]
    suite: Annotated[Files | None, MOTIONS.advanced("NAME|FOLDER...")]
    method: Annotated[str | None, METHOD.option("NAME", completion=declaration.methods)]
    assurance: Annotated[float | None, METHOD.advanced("SHARE")]
    distribution: Annotated[str | None, METHOD.advanced("NAME")]
    law: Annotated[str, METHOD.option("NAME", default="table", completion=declaration.laws)]
    steps: Annotated[int | None, METHOD.advanced("N")]
    chains: Annotated[str | Path | None, METHOD.advanced("FILE.h5")]
    figures: Annotated[str | Path | None, OUTPUT.advanced("FOLDER")]
    out: Annotated[str | Path | None, OUTPUT.option("FILE.json", endings=(".json",))]


@group
class TrialOptions(TypedDict, total=False):
    """Tests for each structure, 512 by default."""

    trials: Annotated[int | None, METHOD.advanced("N", limits={"min": 1})]


@group
class ProbabilityQuestion(
    TrialOptions, Structures, EllipseSourceOptions, Threshold, ErrorMetric, ErrorWindow, total=False
):
    """Criteria that are tested on motions from which they were not learned.

    scheme: leave_one_event_out (the default), k_fold, random_halves, region, magnitude or length.
    """

    scheme: Annotated[str | None, METHOD.option("NAME")]


@group
class ValidationQuestion(ProbabilityQuestion, Confidences, Joint, total=False):
    """What `reliab.validate_criteria` is asked.

    leave_out: Leave out each frequency or damping ratio in turn, too.
    learn: Sets of `motions` to learn from, or real_suite.
    judge: Sets of `motions` to judge; all of them with `learn=real_suite`.
    method: What the confidence means, one method or several; dirichlet by default.
    law: Fitted or printed laws; table and the printed ones by default.
    """

    leave_out: Annotated[str | None, METHOD.advanced("f|xi")]
    learn: Annotated[Names | None, MOTIONS.advanced("SET...")]
    judge: Annotated[Names | None, MOTIONS.advanced("SET...")]
    method: Annotated[Names | None, METHOD.option("NAME...", completion=declaration.methods)]
    law: Annotated[Names | None, METHOD.advanced("NAME...", completion=declaration.laws)]


@group
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
    """What `reliab.assess` is told of a test.

    command_scale: Scale of the recorded command, such as 1±0.001.
    hysteresis: Hysteresis of the displacement sensor over the span of its motion, such as 0.001±0.0003.
    resolution: ADC step of the displacement sensor [mm].
    filter: Analogue low-pass filter of a channel: measured=200, or command=200/4 with its order.
    motion: Ground motion of this test; the limits for A and d are then those of this record.
    """

    command_scale: Annotated[Quantity | None, SENSORS.advanced("RATIO")]
    hysteresis: Annotated[Quantity | None, SENSORS.advanced("SHARE")]
    resolution: Annotated[Quantity | None, SENSORS.advanced("MM", idle_beside=("structure",))]
    filter: Annotated[Iterable[str] | None, SENSORS.advanced("CHANNEL=HZ")]
    motion: Annotated["str | Path | Motion | None", STRUCTURE.advanced("FILE")]


@group
class DesignQuestion(
    FrequenciesOption, DampingAndShare, CriterionFile, Threshold, Confidences, ErrorMetric, total=False
):
    """What `reliab.design_test` is asked.

    structure: Refused with what to ask of a frame.
    """

    structure: Annotated[str | Path | None, STRUCTURE.advanced("FRAME.toml", limits={"hidden": True})]


class MonitorOptions(
    OneStructure, FrameFile, NonlinearModel, LoopOptions, Threshold, ErrorMetric, total=False
):
    """What every monitor is told of its test."""


@group
class MonitorQuestion(MonitorOptions, Mass, SpecimenOptions, Accuracy, ColumnOptions, total=False):
    """What `reliab.follow_test` is asked.

    every: Test time between two messages.
    wait: Pause after which the test counts as finished; longer than any pause in it.
    start_within: How long to wait for the first row; Ctrl-C stops waiting.
    """

    every: Annotated[float, OUTPUT.advanced("SECONDS", default=0.5)]
    wait: Annotated[float, FILE.advanced("SECONDS", default=10.0)]
    start_within: Annotated[float, FILE.advanced("SECONDS", default=600.0)]


class LoopMonitorQuestion(MonitorOptions, Rate, total=False):
    """What `reliab.export_monitor` is asked; the rate is that of the loop."""


@group
class OriginOptions(TestLabels, total=False):
    """Where and by whom a test was made.

    rig: Rig of the test.
    operator: Operator.
    """

    rig: Annotated[str | None, TEST.option("TEXT")]
    operator: Annotated[str | None, TEST.option("TEXT")]


@group
class RecordQuestion(OneStructure, Mass, TestFile, OriginOptions, total=False):
    """What `reliab.record` is asked.

    csv: The recognised channels as CSV, in SI units.
    """

    csv: Annotated[str | Path | None, OUTPUT.option("TEST.csv", endings=(".csv",))]


@group
class CalibrationQuestion(TestFile, total=False):
    """What `reliab.calibrate` is asked.

    out: File for `channels` of the commands that read tests.
    actuator_delay: Delay of the actuator in this test [ms], 12±0.5; 0 if both channels record one signal.
    """

    out: Annotated[str | Path | None, OUTPUT.option("CHANNELS.toml")]
    actuator_delay: Annotated[Quantity | None, TEST.option("MS")]


@group
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
    """What `reliab.add_to_rig` is told of tests.

    note: Further remarks.
    """

    note: Annotated[str | None, TEST.option("TEXT")]


class RigReportQuestion(OneStructure, Threshold, total=False):
    """What `reliab.report_rig` is told of the next test; what is left out is as in the last test."""


@group
class PredictionQuestion(
    ComingMotion, RigReportQuestion, FrameFile, TestLabels, CovariatesOption, total=False
):
    """What `reliab.predict_rig` is asked.

    suite: Suite from which the next motion will be taken: real_suite, synthetic, or a folder.
    """

    suite: Annotated[str | None, MOTIONS.advanced("NAME")]


@group
class MotionQuestion(MotionSets, total=False):
    """How records of ground motions are read.

    time_step: Time step of records that state none.
    units: Unit of records that state none.
    """

    time_step: Annotated[float | None, MOTIONS.advanced("SECONDS")]
    units: Annotated[str | None, MOTIONS.option("g|cm/s2|m/s2")]


class MotionImportQuestion(MotionQuestion, EarthquakeOption, total=False):
    """What `reliab.import_motions` is asked; its earthquake is that of all motions."""


@group
class SyntheticSuiteQuestion(TypedDict, total=False):
    """What `reliab.synthesize_motions` is asked.

    count: Number of components.
    seed: Seed of a suite other than the built-in one.
    """

    count: Annotated[int, MOTIONS.option("N", default=100, limits={"min": 2})]
    seed: Annotated[int | None, MOTIONS.option("N", limits={"min": 0})]


@group
class ExplorerQuestion(OneStructure, EllipseFile, Threshold, ErrorMetric, Confidence, total=False):
    """What `reliab.write_explorer` is asked: above all with what its page opens.

    out: The page to write.
    """

    out: Annotated[str | Path, OUTPUT.option("FILE.html", default=Path("criterion.html"), endings=(".html",))]


MOTION_SOURCES = single(
    "sources", Files, argument("SOURCE..."), "Files, folders or a built-in suite (synthetic)."
)
NEW_SUITE = single(
    "out", Path, OUTPUT.option("FOLDER", is_required=True), "New or empty folder for the suite."
)
NEW_STORE = single("out", Path, OUTPUT.option("STORE", is_required=True), "The Zarr store to write.")
CALIBRATION_TEST = single(
    "test",
    Path,
    argument("FILE"),
    "Test in which both channels record one motion: a sine, a sweep, or steps with pauses, without a "
    "specimen.",
)
RIG = single("rig", Path, argument("RIG"), "Folder of the rig.")
NEW_TESTS = single(
    "tests", list[Path], argument("FILE..."), "Tests, in any format that `reliab assess` reads."
)
KEPT_TEST = single("test", str, argument("TEST"), "Name of the test, or first digits of its checksum.")
KEPT_TESTS = single("tests", Names, argument("TEST..."), "Names, or first digits of checksums.")
RIG_TABLE = single(
    "out", Path, OUTPUT.option("FILE.csv", is_required=True, endings=(".csv",)), "The table as CSV."
)
RIG_PDF = single("out", Path, OUTPUT.option("FILE.pdf", is_required=True, endings=(".pdf",)), "The report.")
RUN_FOLDER = single("folder", Path, argument("DIR"), "Run folder that `reliab run` wrote.")
LISTED_DATA = single(
    "source", str, argument("FILE|https://…"), "The file in the project's sources, or its https address."
)
SAMPLE_FOLDER = single(
    "folder",
    Path,
    argument("[FOLDER]", default=Path("datasets")),
    "Folder for the samples; `datasets` by default.",
)


@group
class StudyArgument(MotionSource, total=False):
    """What `reliab.run_study` is asked.

    study: Folder or file of a study, or the name of one that comes with reliab. Code in the folder is
        executed.
    """

    study: Annotated[str, argument("[STUDY]", default="quick", completion=declaration.studies)]


def select_stated(question: type, request: Mapping[str, Any]) -> dict[str, Any]:
    """Select what another question is asked among what is stated."""
    return {name: request[name] for name in collect_options(question) if request.get(name) is not None}
