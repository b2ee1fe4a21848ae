"""`reliab assess`: the verdict on a test, or what is tolerable before one."""

from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from reliab.cli.assess.filed_report import Report
from reliab.cli.assess.meaning import applicable, matched, only_value, refuse_idle
from reliab.cli.completion import metrics, samples
from reliab.cli.option_names import as_options
from reliab.cli.options import (
    JsonTarget,
    Laboratory,
    Logo,
    Paper,
    ReportDate,
    ReportTitle,
    StructureFile,
    setting_of,
)

Tests = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="[TEST]...",
        autocompletion=samples,
        help="Command and measured displacement: CSV, MATLAB, HDF5, NetCDF; or sample_test, which ships. "
        "Several give a table.",
    ),
]
Frequencies = Annotated[
    list[str] | None,
    typer.Option(
        "--f",
        metavar="HZ",
        help="Natural frequency, 1 or with its standard deviation 1±0.01; several for --design.",
    ),
]
DampingRatio = Annotated[
    str | None,
    typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %, or 0.02±0.002."),
]
Alpha = Annotated[
    str | None,
    typer.Option(
        "--alpha",
        metavar="SHARE",
        help="Share of the stiffness in the laboratory, 1 by default.",
    ),
]
Scale = Annotated[
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
Mass = Annotated[
    str | None,
    typer.Option(
        "--mass",
        metavar="KG",
        help="Mass of the structure; with it a recorded force is also used to identify the structure.",
    ),
]
MotionFile = Annotated[
    Path | None,
    typer.Option(
        "--motion",
        metavar="FILE",
        help="Ground motion of the test; the index is then judged by the boundary of this motion.",
    ),
]
CriterionFile = Annotated[
    Path | None,
    typer.Option(
        "--criterion", metavar="FILE.json", help="Criterion, as `reliab criterion --out` writes it."
    ),
]
ModelFile = Annotated[
    Path | None,
    typer.Option(
        "--model", metavar="MODEL.toml", help="Model of a nonlinear specimen, as `reliab diagnose` writes it."
    ),
]
Threshold = Annotated[
    float | None, typer.Option("--threshold", metavar="ERROR", help="Error of the whole test, 0.05 for 5 %.")
]
MetricName = Annotated[
    str | None,
    typer.Option(
        "--metric",
        autocompletion=metrics,
        metavar="rms|mte",
        help="Error of the whole test: RMS^R (default) or MTE^R.",
    ),
]
Confidences = Annotated[
    list[float] | None,
    typer.Option(
        "--confidence", metavar="SHARE", help="Share of ground motions, 0.95; several for --design."
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
    str | None, typer.Option("--delimiter", metavar="SIGN", help="What separates columns of a text.")
]
Design = Annotated[
    bool, typer.Option("--design", help="Print tolerable errors before a test; no test is read.")
]
Check = Annotated[bool, typer.Option("--check", help="Exit with code 1 unless the test is reliable.")]
FigureFile = Annotated[
    Path | None,
    typer.Option(
        "--figure", metavar="FILE.svg|png|pdf", help="With --design: chart of tolerable errors over f."
    ),
]
ReportFile = Annotated[
    Path | None,
    typer.Option("--report", metavar="FILE.pdf", help="Report of two pages, to be filed with the test."),
]
TableFile = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="FILE.csv", help="Table of the verdicts, one row for each test; itself no test."
    ),
]


def assess(
    *,
    context: typer.Context,
    tests: Tests = None,
    f: Frequencies = None,
    xi: DampingRatio = None,
    alpha: Alpha = None,
    scale: Scale = None,
    feedback_lag: FeedbackLag = None,
    mass: Mass = None,
    motion: MotionFile = None,
    criterion: CriterionFile = None,
    model: ModelFile = None,
    structure: StructureFile = None,
    threshold: Threshold = None,
    confidence: Confidences = None,
    metric: MetricName = None,
    command: Column = None,
    measured: Column = None,
    time: Column = None,
    rate: Rate = None,
    units: Units = None,
    time_units: TimeUnits = None,
    delimiter: Delimiter = None,
    design: Design = False,
    figure: FigureFile = None,
    report: ReportFile = None,
    title: ReportTitle = None,
    date: ReportDate = None,
    paper: Paper = "a4",
    laboratory: Laboratory = None,
    logo: Logo = None,
    out: TableFile = None,
    check: Check = False,
    json_target: JsonTarget = None,
) -> None:
    """Judge a real test by the error that its command and measured displacement reveal."""
    refuse_idle(context, design=design)
    asked: dict[str, Any] = {"xi": xi, "threshold": threshold, "metric": metric, "criterion": criterion}
    if design:
        from reliab.api import design_test
        from reliab.cli.assess.design import answer_design

        tolerable = design_test(**applicable(context, {**asked, "f": f, "confidence": confidence}))
        answer_design(tolerable, figure, json_target)
        return
    from reliab.cli.assess.verdicts import answer

    asked |= {"f": only_value(f, "f"), "alpha": alpha, "mass": mass, "structure": structure}
    asked |= {"scale": scale, "feedback_lag": feedback_lag, "model": model, "motion": motion}
    asked |= {"confidence": only_value(confidence, "confidence"), "command": command, "measured": measured}
    asked |= {"time": time, "rate": rate, "units": units, "time_units": time_units, "delimiter": delimiter}
    files = [test for test in matched(tests or []) if test != out]
    setting = setting_of(title, date, paper, laboratory, logo)
    reliable = answer(
        files,
        applicable(context, asked),
        out=out,
        json_target=json_target,
        report=None if report is None else Report(report, setting),
        say=partial(as_options, command=context.find_root().command),
    )
    if check and not reliable:
        raise typer.Exit(1)
