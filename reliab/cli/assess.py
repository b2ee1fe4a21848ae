"""`reliab assess`: the verdict on a test, or what is tolerable before one."""

from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reliab.cli.options import (
    FIVE_PERCENT,
    ONE_HERTZ,
    TWO_PERCENT,
    ExperimentalFraction,
    JsonTarget,
    MetricName,
    WindowName,
)
from reliab.cli.output import console, table, write_json
from reliab.errors import InputError

if TYPE_CHECKING:
    from reliab.criterion import Criterion
    from reliab.motions import Motion
    from reliab.validation.assessment import Assessment

_NINETY_FIVE = 0.95
_NOT_RELIABLE = 1

Test = Annotated[
    Path | None,
    typer.Argument(metavar="[TEST]", help="Command and measured displacement: CSV, MATLAB, HDF5, NetCDF."),
]
Frequencies = Annotated[
    list[float] | None,
    typer.Option("--f", metavar="HZ", help="Natural frequency; several for --design."),
]
DampingRatio = Annotated[float, typer.Option("--xi", metavar="RATIO", help="Damping ratio, 0.02 for 2 %.")]
MotionFile = Annotated[
    Path | None,
    typer.Option("--motion", metavar="FILE", help="The test's ground motion: verdict by its own boundary."),
]
CriterionFile = Annotated[
    Path | None,
    typer.Option("--criterion", metavar="FILE.json", help="As `reliab criterion --out` writes it."),
]
Threshold = Annotated[
    float | None, typer.Option("--threshold", metavar="ERROR", help="Error of the whole test, 0.05 for 5 %.")
]
Confidences = Annotated[
    list[float] | None,
    typer.Option("--confidence", metavar="SHARE", help="Share of ground motions; several for --design."),
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
Check = Annotated[bool, typer.Option("--check", help="Exit with code 1 when the test is not reliable.")]
FigureFile = Annotated[
    Path | None,
    typer.Option(
        "--figure", metavar="FILE.svg|png|pdf", help="With --design: chart of tolerable errors over f."
    ),
]
ReportFile = Annotated[
    Path | None, typer.Option("--report", metavar="FILE.pdf", help="Two pages to be filed with the test.")
]
ReportDate = Annotated[
    datetime | None,
    typer.Option("--date", formats=["%Y-%m-%d"], help="Date on the report; today by default."),
]


def assess(
    *,
    test: Test = None,
    f: Frequencies = None,
    xi: DampingRatio = TWO_PERCENT,
    motion: MotionFile = None,
    criterion: CriterionFile = None,
    threshold: Threshold = None,
    confidence: Confidences = None,
    metric: MetricName = "rms",
    window: WindowName = "record",
    alpha: ExperimentalFraction = 1.0,
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
    date: ReportDate = None,
    check: Check = False,
    json_target: JsonTarget = None,
) -> None:
    """Judge a real test by its command and measured displacement."""
    chosen = _read_criterion(criterion, threshold, confidence)
    error = threshold or FIVE_PERCENT
    if design:
        from reliab.cli.design_mode import state_tolerances

        state_tolerances(f or [ONE_HERTZ], xi, error, confidence, metric, chosen, figure, json_target)
        return
    if test is None:
        raise InputError(
            "A test's file is needed", value="none", remedy="Name it, or ask what is tolerable with --design"
        )
    from reliab.indices.window import Window
    from reliab.loop.structure import Structure
    from reliab.validation.assessment import assess as judge
    from reliab.validation.assessment import read_recording

    recording = read_recording(
        test,
        command=command,
        measured=measured,
        time=time,
        rate_hz=rate,
        units=units,
        time_units=time_units,
        delimiter=delimiter,
    )
    found = judge(
        recording,
        Structure(frequency=_only(f, ONE_HERTZ, "--f"), damping_ratio=xi, experimental_fraction=alpha),
        motion=None if motion is None else _read_motion(motion),
        criterion=chosen,
        threshold=error,
        confidence=_only(confidence, _NINETY_FIVE, "--confidence"),
        metric=metric,
        error_window=Window.parse(window),
    )
    if report is not None:
        _write_report(found, test, report, date)
    if not write_json(found.to_dict(), json_target):
        _show(found)
    if check and not found.reliable:
        raise typer.Exit(_NOT_RELIABLE)


def _write_report(found: "Assessment", test: Path, report: Path, date: datetime | None) -> None:
    import hashlib

    from reliab.report import write_pdf
    from reliab.report.kinds.assessment import assessment_report

    checksum = hashlib.sha256(test.read_bytes()).hexdigest()
    document = assessment_report(found, provenance={"file": test.name, "file, SHA-256": checksum})
    write_pdf(document, report, date=(date or datetime.now(tz=UTC)).date())


def _only(values: list[float] | None, default: float, option: str) -> float:
    if values is not None and len(values) > 1:
        raise InputError(
            f"A test has one value of {option}", value=values, remedy="Give several with --design only"
        )
    return values[0] if values else default


def _read_motion(path: Path) -> "Motion":
    from reliab.motions import read_motion

    return read_motion(path)


def _read_criterion(
    path: Path | None, threshold: float | None, confidence: list[float] | None
) -> "Criterion | None":
    if path is None:
        return None
    if threshold is not None or confidence:
        raise InputError(
            "A criterion brings its own threshold and confidence",
            value="--criterion with --threshold or --confidence",
            remedy="Leave these out, or derive another criterion",
        )
    from reliab.criterion import Criterion

    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            "The criterion's file must be readable",
            value=getattr(error, "strerror", None) or "no text",
            remedy="Write one with `reliab criterion --out`",
            where=str(path),
        ) from error
    return Criterion.from_json(text)


def _show(found: "Assessment") -> None:
    summary = found.to_dict()
    terminal = console()
    terminal.print(_verdict(found), style="bold green" if found.reliable else "bold red", highlight=False)
    shown = table(
        summary["test"],
        {"index": "left", "value": "right", "95 % interval": "left", "tolerable alone": "right"},
    )
    a, b = found.limits
    shown.add_row(
        "A, amplitude", f"{summary['A']:.5f}", _range(summary["A_interval"], 5), f"1 ± {a**0.5:.5f}"
    )
    shown.add_row(
        "d, delay, ms", f"{summary['d_ms']:.4f}", _range(summary["d_ms_interval"], 4), f"{b**0.5:.4f}"
    )
    terminal.print(shown)
    for sentence in _sentences(found, summary):
        terminal.print(sentence, highlight=False, markup=False)
    for warning in summary["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
    for note in summary["notes"]:
        terminal.print(f"Note: {note}", markup=False, highlight=False)


def _verdict(found: "Assessment") -> str:
    criterion = found.criterion
    against = f"{criterion.confidence:.0%} of ground motions" if found.own is None else found.own.motion
    return (
        f"{'RELIABLE' if found.reliable else 'NOT RELIABLE'} at an error of {criterion.threshold:.0%} "
        f"({criterion.metric.upper()}) for {against}: index {found.index:.3g} against 1"
    )


def _range(ends: list[float], digits: int) -> str:
    low, high = ends
    return f"{low:.{digits}f} … {high:.{digits}f}"


def _or_none(what: str, tolerable: float, unit: str) -> str:
    return f"{what} {tolerable:.3g}{unit}" if tolerable > 0.0 else f"no {what}"


def _sentences(found: "Assessment", summary: dict[str, Any]) -> list[str]:
    sentences = []
    if found.own is not None:
        sentences.append(f"Error under {found.own.motion}: {found.own.error:.2%}.")
    if summary["probability"] is not None:
        sentences.append(f"Probability of staying below the threshold: {summary['probability']:.3f}.")
    if summary["stability_margin"] is not None:
        sentences.append(
            f"Stability margin: {summary['stability_margin']:.0%} of the critical delay is free."
        )
    advice = summary["improve"]
    share = advice["share_of_delay"] if advice["first"] == "delay" else 1.0 - advice["share_of_delay"]
    sentences.append(
        f"Improve first: the {advice['first']} ({share:.0%} of the index). "
        f"Tolerable with the other as it is: {_or_none('delay', advice['tolerable_delay_ms'], ' ms')}, "
        f"{_or_none('amplitude error', advice['tolerable_amplitude_error'], '')}."
    )
    return sentences
