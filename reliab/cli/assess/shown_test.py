"""What `reliab assess --details` prints about a test, below the verdict."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.shown_briefly import budget_table, show_remarks
from reliab.cli.output import console, say, table
from reliab.significant import percent, share_in_words, significant
from reliab.vocabulary import PERCENT

if TYPE_CHECKING:
    from reliab.assessment import Assessment


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
    from reliab.assessment import ERROR_NAMES

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
    from reliab.assessment import PART_NAMES

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
    promise = f"{share} of the population's ground motions" if share else "; no share of motions is promised"
    against = (
        f"{promise}, window {assessment.criterion.provenance.window}"
        if assessment.placement is None
        else f" for {assessment.placement.motion}, {significant(assessment.placement.window[0])} to "
        f"{assessment.placement.window[1]:.4g} s of its record"
    )
    size = "no limits for leads" if assessment.index is None else f"{significant(assessment.index)} (limit 1)"
    shown = table(
        f"By the index: {assessment.verdict_by_index.word.shout.lower()}, {size}{against}",
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
    from reliab.assessment import probability_text

    if assessment.placement is not None:
        yield (
            "A constant gain A and delay d alone would cause an error of "
            f"{percent(assessment.placement.error, decimals=2)} under {assessment.placement.motion} "
            f"({significant(assessment.placement.window[0])} to {assessment.placement.window[1]:.4g} s of "
            "its record)."
        )
    if assessment.index_probability is not None:
        basis = "its own ground motion" if assessment.placement is not None else "further ground motions"
        yield (
            f"Probability, by A and d under {basis}, that the error stays below the threshold: "
            f"{probability_text(assessment.index_probability)}."
        )
    for reason in assessment.verdict_by_index.would_decide:
        yield f"The index: {reason}"
    if summary["stability_margin"] is not None:
        yield (
            f"Stability margin: {percent(summary['stability_margin'], decimals=0)} of the critical delay is "
            "free."
        )
    advice = summary["improve"]
    share = advice["share_of_delay"] if advice["first"] == "delay" else 1.0 - advice["share_of_delay"]
    yield (
        f"Of the index, most comes from the {advice['first']} ({percent(share, decimals=0)}). Tolerable "
        f"while the other stays as it is: {_or_none('delay', advice['tolerable_delay_ms'], ' ms')}, "
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
