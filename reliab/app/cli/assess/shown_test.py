"""What `reliab assess --details` prints about a test below the verdict, and `assess` about several tests."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.app.cli.assess.shown_briefly import budget_table, index_in_words, show_remarks
from reliab.app.cli.output import console, say, table
from reliab.core.significant_digits import counted, percent, share_in_words, significant
from reliab.core.vocabulary import PERCENT

if TYPE_CHECKING:
    from reliab.assessment.assessment import Assessment
from pathlib import Path

_COLUMNS = {
    "test": "left",
    "verdict": "left",
    "error": "right",
    "90 % interval": "right",
    "probability": "right",
    "A": "right",
    "d, ms": "right",
}


def show_assessment(assessment: "Assessment", summary: dict[str, Any]) -> None:
    """Print parts of the error, budget, indices, warnings and notes: the details below the verdict."""
    terminal = console()
    say(_asked(assessment))
    terminal.print(_errors(summary))
    terminal.print(budget_table(summary))
    terminal.print(_indices(assessment, summary))
    say(*_sentences(assessment, summary))
    show_remarks(summary)


def _asked(assessment: "Assessment") -> str:
    from reliab.assessment.verdict import ERROR_NAMES

    stated = ", ".join(
        f"{symbol} = {assessment.stated[name]}{unit}"
        for name, symbol, unit in (("f", "f", " Hz"), ("xi", "ξ", ""), ("alpha", "α", ""))
    )
    return (
        f"Structure {stated}; threshold {percent(assessment.criterion.threshold)} "
        f"({ERROR_NAMES[assessment.metric]}); window of the error: the whole test, "
        f"{assessment.recording.duration:.4g} s. RMS^R is the root mean square, MTE^R the largest value, "
        "of measured minus exact displacement, both over the peak of the exact displacement."
    )


def _errors(summary: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    from reliab.assessment.error_of_test import PART_NAMES

    shown = table(
        f"Error of {summary['test']}, rebuilt from its command and measured displacement",
        {"error": "left", "value": "right", "90 % interval": "left"},
    )
    for name, key in (("RMS^R", "rms"), ("MTE^R", "mte")):
        size = summary["error"][key]
        shown.add_row(
            name,
            percent(size["value"], decimals=2),
            f"{PERCENT * size['low']:.2f} … {percent(size['high'], decimals=2)}",
        )
    for name, part in summary["error"]["parts"].items():
        shown.add_row(
            f"  from {PART_NAMES[name]}",
            percent(part["rms"], decimals=2),
            f"RMS^R without it: {percent(part['remaining_rms'], decimals=2)}",
        )
    return shown


def _indices(assessment: "Assessment", summary: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    share = (
        "" if summary["confidence"] is None else f" for {share_in_words(summary['confidence'], decimals=0)}"
    )
    promise = f"{share} of comparable ground motions" if share else "; no share of motions promised"
    against = (
        f"{promise}, window {assessment.criterion.provenance.window}"
        if assessment.placement is None
        else f" for {assessment.placement.motion}, {significant(assessment.placement.window[0])} to "
        f"{assessment.placement.window[1]:.4g} s of its record"
    )
    size = "no limits for leads" if assessment.index is None else f"{significant(assessment.index)} (limit 1)"
    shown = table(
        f"Index of the criterion: {size}{against}",
        {"index": "left", "value": "right", "95 % interval": "left", "tolerable alone": "right"},
    )
    a, b = assessment.limits
    sign = "−" if summary["d_ms"] < 0.0 else ""
    shown.add_row(
        "A, amplitude", f"{summary['A']:.5f}", _range(summary["A_interval"], 5), f"1 ± {a**0.5:.5f}"
    )
    shown.add_row(
        "d, delay, ms", f"{summary['d_ms']:.4f}", _range(summary["d_ms_interval"], 4), f"{sign}{b**0.5:.4f}"
    )
    return shown


def _range(ends: list[float], digits: int) -> str:
    low, high = ends
    return f"{low:.{digits}f} … {high:.{digits}f}"


def _sentences(assessment: "Assessment", summary: dict[str, Any]) -> Iterator[str]:
    from reliab.assessment.verdict import probability_text

    if assessment.placement is not None:
        yield (
            "A constant gain A and delay d alone would cause an error of "
            f"{percent(assessment.placement.error, decimals=2)} under {assessment.placement.motion} "
            f"({significant(assessment.placement.window[0])} to {assessment.placement.window[1]:.4g} s of "
            "its record)."
        )
    if assessment.index_probability is not None:
        basis = "its own ground motion" if assessment.placement is not None else "comparable ground motions"
        yield (
            f"By A and d, the error stays below the threshold under {basis} with probability "
            f"{probability_text(assessment.index_probability)}."
        )
    yield index_in_words(summary["by_index"])
    yield from assessment.verdict_by_index.would_decide
    if summary["stability_margin"] is not None:
        yield (
            f"Stability margin: {percent(summary['stability_margin'], decimals=0)} of the critical delay, "
            "from which on the loop is unstable, is free."
        )
    advice = summary["improve"]
    share = advice["share_of_delay"] if advice["first"] == "delay" else 1.0 - advice["share_of_delay"]
    yield (
        f"The {advice['first']} contributes most to the index ({percent(share, decimals=0)}). Tolerable with "
        f"this amplitude: {_or_none('delay', advice['tolerable_delay_ms'], ' ms')}; with this delay: "
        f"{_or_none('amplitude error', advice['tolerable_amplitude_error'], '')}."
    )
    yield _tracking(summary["tracking"])


def _or_none(what: str, tolerable: float, unit: str) -> str:
    return f"{what} {significant(tolerable)}{unit}" if tolerable > 0.0 else f"no {what}"


def _tracking(measures: dict[str, Any]) -> str:
    force = "recorded force" if measures["energy_of_recorded_force"] else "a linear specimen"
    return (
        f"Tracking of the command: largest error {percent(measures['mte'], decimals=2)} of its peak, RMS "
        f"error {percent(measures['rms'], decimals=2)} of its own; tracking indicator "
        f"{significant(measures['tracking_indicator_m2'])} m²; phase and amplitude error indices "
        f"{significant(measures['paei_phase_rad'])} rad and {measures['paei_amplitude']:+.4f}; energy "
        f"error {100.0 * measures['energy_error']:+.1f} % of the largest strain energy ({force})."
    )


def show_several(contents: list[dict[str, Any]]) -> None:
    """Print the verdicts of tests."""
    judged = [content for content in contents if "fault" not in content]
    asked = f", {judged[0]['metric'].upper()} against {percent(judged[0]['threshold'])}" if judged else ""
    shown = table(f"Verdicts on {counted(len(contents), 'test')}{asked}", _COLUMNS)
    for content in contents:
        shown.add_row(*_row(content))
    terminal = console()
    terminal.print(shown)
    for content in contents:
        say(*(f"{content['file']}: {sentence}" for sentence in _why(content)))


def show_same_test(content: dict[str, Any]) -> None:
    """Print the verdicts on runs of one test."""
    from reliab.assessment.verdict import probability_text

    asked = f"{content['metric'].upper()} against {percent(content['threshold'])}"
    columns = {"run": "left", "verdict": "left", "gain": "right", "d, ms": "right"}
    columns |= dict.fromkeys(("alone", "all runs", "90 % interval", "probability"), "right")
    shown = table(f"{len(content['runs'])} runs of one test, {asked}", columns)
    for run in content["runs"]:
        ends = (percent(run["error"][end], decimals=2) for end in ("low", "high"))
        shown.add_row(
            run["file"],
            run["verdict"].replace("_", " "),
            f"{run['gain']:.3f}",
            f"{run['d_ms']:.2f}",
            *(percent(run[way]["value"], decimals=2) for way in ("alone", "error")),
            " to ".join(ends),
            probability_text(run["probability"]),
        )
    terminal = console()
    terminal.print(shown)
    say(*content["warnings"])


def _row(content: dict[str, Any]) -> list[str]:
    if "fault" in content:
        return [content["file"], "not judged", *[""] * (len(_COLUMNS) - 2)]
    from reliab.assessment.verdict import probability_text

    error = content["error"][content["metric"]]
    return [
        content["file"],
        content["verdict"].replace("_", " "),
        percent(error["value"], decimals=2),
        f"{PERCENT * error['low']:.2f} … {percent(error['high'], decimals=2)}",
        probability_text(content["probability"]),
        f"{content['A']:.5f}",
        f"{content['d_ms']:.4f}",
    ]


def _why(content: dict[str, Any]) -> list[str]:
    """Say below the table why a test is not reliable or not judged."""
    if "fault" in content:
        return [content["fault"].removeprefix(f"{Path(content['file']).name}: ")]
    warnings = [f"Warning: {warning}" for warning in content["warnings"]]
    return warnings if content["reliable"] else [*content["reasons"], *warnings]
