"""`reliab rig`: the tests of a rig come, are listed, shown and removed; what they teach is asked."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar

import typer

from reliab.cli.demand import Demand, takes
from reliab.cli.options import (
    OF_REPORT,
    ChannelSkew,
    CriterionFile,
    EquipmentFile,
    ErrorThreshold,
    FeedbackLag,
    JsonTarget,
    MassOfStructure,
    ReadsTests,
    Reported,
    SensorScale,
    StatedDampingRatio,
    StatedShare,
    StructureFile,
    TakenAsExact,
    written_as,
)
from reliab.cli.output import write_json
from reliab.errors import InputError

app = typer.Typer(
    no_args_is_help=True, help="A laboratory's memory: keep a rig's tests, predict the next, notice drift."
)

Rig = Annotated[Path, typer.Argument(metavar="RIG", help="Folder of the rig.")]


@dataclass(frozen=True, kw_only=True)
class AddDemand(ReadsTests):
    """Options of `reliab rig add`, arguments of `reliab.api.add_to_rig`."""

    rig: Annotated[Path, typer.Argument(metavar="RIG", help="Folder of the rig, made where there is none.")]
    tests: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Tests, in any format that `reliab assess` reads.")
    ]
    f: Annotated[str | None, typer.Option("--f", metavar="HZ", help="Natural frequency, 1 or 1±0.01.")] = None
    xi: StatedDampingRatio = None
    alpha: StatedShare = None
    scale: SensorScale = None
    feedback_lag: FeedbackLag = None
    mass: MassOfStructure = None
    skew: ChannelSkew = None
    equipment: EquipmentFile = None
    exact: TakenAsExact = False
    criterion: CriterionFile = None
    structure: StructureFile = None
    threshold: ErrorThreshold = None
    date: Annotated[
        str | None,
        typer.Option("--date", metavar="DATE", help="When they were performed, 2026-03-01 or with a time."),
    ] = None
    event: Annotated[
        str | None, typer.Option("--event", metavar="TEXT", help="Earthquake of their ground motion.")
    ] = None
    specimen: Annotated[str | None, typer.Option("--specimen", metavar="TEXT", help="What was tested.")] = (
        None
    )
    note: Annotated[str | None, typer.Option("--note", metavar="TEXT", help="Anything else.")] = None
    covariate: Annotated[
        list[str] | None,
        typer.Option(
            "--covariate", metavar="NAME=NUMBER...", help="Numbers on which the rig may depend, current=0.4."
        ),
    ] = None
    json_target: JsonTarget = None

    idle_beside: ClassVar[Mapping[str, Any]] = {"structure": ("f", "xi", "alpha", "mass")}


@dataclass(frozen=True, kw_only=True)
class ListDemand(Demand):
    """Options of `reliab rig list`, arguments of `reliab.api.list_rig`."""

    rig: Rig
    json_target: JsonTarget = None


@dataclass(frozen=True, kw_only=True)
class ShowDemand(Demand):
    """Options of `reliab rig show`, arguments of `reliab.api.show_rig_test`."""

    rig: Rig
    test: Annotated[
        str, typer.Argument(metavar="TEST", help="Name of the test, or first digits of its checksum.")
    ]
    json_target: JsonTarget = None


@dataclass(frozen=True, kw_only=True)
class RemoveDemand(Demand):
    """Options of `reliab rig remove`, arguments of `reliab.api.remove_from_rig`."""

    rig: Rig
    tests: Annotated[
        list[str], typer.Argument(metavar="TEST...", help="Names, or first digits of checksums.")
    ]
    json_target: JsonTarget = None


@dataclass(frozen=True, kw_only=True)
class ExportDemand(Demand):
    """Options of `reliab rig export`, arguments of `reliab.api.export_rig`."""

    rig: Rig
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE.csv", callback=written_as(".csv"), help="The table as CSV.")
    ]
    json_target: JsonTarget = None


@app.command("add")
@takes(AddDemand)
def add(demand: AddDemand) -> None:
    """Judge tests and keep them: record, verdict and indices."""
    from reliab import api
    from reliab.cli.output import progress_bar
    from reliab.cli.rig.shown_tests import show_added

    with progress_bar("tests") as progress:
        outcome = demand.ask(api.add_to_rig, "json_target", show=progress)
    content = outcome.to_dict()
    content["faults"] = {file: demand.in_options(fault) for file, fault in content["faults"].items()}
    if not write_json(content, demand.json_target):
        show_added(content)
    if outcome.faults:
        raise InputError(
            "Every file must be a test that can be judged",
            value=f"{len(outcome.faults)} not judged: {', '.join(outcome.faults)}",
            remedy="Mend them as the reasons say, or leave them out; the others are in the rig",
        )


@app.command("list")
@takes(ListDemand)
def list_tests(demand: ListDemand) -> None:
    """List the tests of a rig, and where it has changed."""
    from reliab.api import list_rig
    from reliab.cli.rig.shown_tests import show_list

    listed = demand.ask(list_rig, "json_target")
    content = listed.to_dict()
    if not write_json(content, demand.json_target):
        show_list(content)


@app.command("show")
@takes(ShowDemand)
def show(demand: ShowDemand) -> None:
    """Show all that is kept of a test."""
    from reliab.api import show_rig_test
    from reliab.cli.rig.shown_tests import show_test

    content = demand.ask(show_rig_test, "json_target")
    if not write_json(content, demand.json_target):
        show_test(content)


@app.command("remove")
@takes(RemoveDemand)
def remove(demand: RemoveDemand) -> None:
    """Remove tests from a rig."""
    from reliab.api import remove_from_rig
    from reliab.cli.output import write_line

    removed = demand.ask(remove_from_rig, "json_target")
    if not write_json({"removed": list(removed)}, demand.json_target):
        write_line(f"Removed: {', '.join(removed)}.")


@app.command("export")
@takes(ExportDemand)
def export(demand: ExportDemand) -> None:
    """Write the table of a rig's tests as CSV."""
    from reliab.api import export_rig
    from reliab.cli.output import write_line

    tests = demand.ask(export_rig, "json_target")
    if not write_json({"out": str(demand.out), "tests": tests}, demand.json_target):
        write_line(f"{tests} tests written to {demand.out}")


@dataclass(frozen=True, kw_only=True)
class OfNextTest(Demand):
    """Options about the structure of the next test, and the error that it may have."""

    f: Annotated[str | None, typer.Option("--f", metavar="HZ", help="Natural frequency.")] = None
    xi: Annotated[
        str | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 by default.")
    ] = None
    alpha: Annotated[
        str | None,
        typer.Option("--alpha", metavar="SHARE", help="Share of the stiffness in the laboratory, 1."),
    ] = None
    threshold: ErrorThreshold = None


@dataclass(frozen=True, kw_only=True)
class PredictDemand(OfNextTest):
    """Options of `reliab rig predict`, arguments of `reliab.api.predict_rig`."""

    rig: Rig
    structure: StructureFile = None
    motion: Annotated[
        Path | None,
        typer.Option(
            "--motion", metavar="FILE", help="Ground motion; the loop is simulated with drawn actuators."
        ),
    ] = None
    suite: Annotated[
        str | None,
        typer.Option(
            "--suite", metavar="NAME", help="Any motion of a suite: real_suite, synthetic, or a folder."
        ),
    ] = None
    date: Annotated[
        str | None, typer.Option("--date", metavar="DATE", help="When; after the last test by default.")
    ] = None
    specimen: Annotated[
        str | None, typer.Option("--specimen", metavar="TEXT", help="On what; the last one by default.")
    ] = None
    covariate: Annotated[
        list[str] | None,
        typer.Option(
            "--covariate", metavar="NAME=NUMBER...", help="Numbers that all tests have, peak_mm=40 too."
        ),
    ] = None
    json_target: JsonTarget = None


@app.command("predict")
@takes(PredictDemand)
def predict(demand: PredictDemand) -> None:
    """Predict the next test: A, d and error with their intervals, and the probability that it is good."""
    from reliab.api import predict_rig
    from reliab.cli.rig.shown_answers import show_prediction

    content = demand.ask(predict_rig, "json_target").to_dict()
    if not write_json(content, demand.json_target):
        show_prediction(content)


@dataclass(frozen=True, kw_only=True)
class PlanDemand(OfNextTest):
    """Options of `reliab rig plan`, arguments of `reliab.api.plan_rig`."""

    rig: Rig
    share: Annotated[
        float, typer.Option("--share", metavar="SHARE", help="Share of coming tests that shall be good.")
    ] = 0.95
    json_target: JsonTarget = None


@dataclass(frozen=True, kw_only=True)
class CompareDemand(Demand):
    """Options of `reliab rig compare`, arguments of `reliab.api.compare_rigs`."""

    rig: Rig
    other: Annotated[
        Path | None, typer.Argument(metavar="[OTHER]", help="Folder of the rig to compare with.")
    ] = None
    since: Annotated[
        str | None,
        typer.Option("--since", metavar="DATE", help="Date of a change of the same rig, in its place."),
    ] = None
    json_target: JsonTarget = None


@app.command("plan")
@takes(PlanDemand)
def plan(demand: PlanDemand) -> None:
    """Say what to change so that nearly all coming tests are good."""
    from reliab.api import plan_rig
    from reliab.cli.rig.shown_answers import show_plan

    content = demand.ask(plan_rig, "json_target").to_dict()
    if not write_json(content, demand.json_target):
        show_plan(content)


@app.command("compare")
@takes(CompareDemand)
def compare(demand: CompareDemand) -> None:
    """Say whether a rig became better, or another is better."""
    from reliab.api import compare_rigs
    from reliab.cli.rig.shown_answers import show_comparison

    content = demand.ask(compare_rigs, "json_target").to_dict()
    if not write_json(content, demand.json_target):
        show_comparison(content)


@dataclass(frozen=True, kw_only=True)
class RigReportDemand(Reported):
    """Options of `reliab rig report`, arguments of `reliab.api.report_rig`."""

    rig: Rig
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE.pdf", callback=written_as(".pdf"), help="The report.")
    ]
    f: Annotated[
        str | None, typer.Option("--f", metavar="HZ", help="Natural frequency; that of the last test.")
    ] = None
    xi: Annotated[
        str | None, typer.Option("--xi", metavar="RATIO", help="Damping ratio; that of the last test.")
    ] = None
    alpha: Annotated[
        str | None,
        typer.Option("--alpha", metavar="SHARE", help="Share in the laboratory; that of the last."),
    ] = None
    threshold: Annotated[
        float | None,
        typer.Option("--threshold", metavar="ERROR", help="Error of the whole test; that of the last test."),
    ] = None
    json_target: JsonTarget = None


@app.command("report")
@takes(RigReportDemand)
def report(demand: RigReportDemand) -> None:
    """Write two pages on what the rig does, what to expect and what to change, and an appendix."""
    from reliab.api import report_rig
    from reliab.cli.output import write_line

    written = demand.ask(report_rig, *OF_REPORT, "json_target", setting=demand.setting)
    if not write_json({"report": str(written)}, demand.json_target):
        write_line(f"Report: {written}")
