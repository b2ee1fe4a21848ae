"""What `reliab assess --structure --details` prints about a test of a frame, below the verdict."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.shown_briefly import budget_table
from reliab.cli.assess.shown_channels import show_channels
from reliab.cli.output import console, table
from reliab.significant import percent, percent_with_interval, significant

if TYPE_CHECKING:
    from reliab.assessment import FrameAssessment


def show_frame(assessment: "FrameAssessment") -> None:
    """Print stability, tracking at the modes, warnings and notes: the details below the verdict."""
    content = assessment.to_dict()
    terminal = console()
    terminal.print(_quantities(content))
    terminal.print(_modes(content))
    terminal.print(budget_table(content))
    terminal.print(responses_table(content))
    for sentence in (content["responses"]["in_words"], *_sentences(content)):
        terminal.print(sentence, markup=False, highlight=False)
    for warning in content["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
    show_channels(content["recording"]["channels"])
    for note in content["notes"]:
        terminal.print(f"Note: {note}", markup=False, highlight=False)


def _quantities(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    margin, critical = content["stability_margin"], content["critical_delay_ms"]
    rows = {
        "A": f"{content['A']:.4f}",
        "d": f"{content['d_ms']:.3f} ms",
        "critical delay": "none" if critical is None else f"{critical:.3f} ms",
        "stability margin": "none" if margin is None else f"{margin:.3f}",
    }
    if content["by_index"] is not None:
        by_index = content["by_index"]
        index = "unknown" if by_index["index"] is None else significant(by_index["index"])
        rows["index of the criterion"] = f"{index}: {by_index['verdict'].replace('_', ' ')}"
    shown = table(f"Test of {content['structure']}", {"": "left", "value": "left"})
    for name, value in rows.items():
        shown.add_row(name, value)
    return shown


def _modes(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    headings = ("mode", "f, Hz", "damping ratio", "specimen's share", "A(f)", "d(f), ms")
    shown = table("Tracking at the modes of the structure", dict.fromkeys(headings, "right"))
    for place, mode in enumerate(content["modes"], start=1):
        shown.add_row(
            str(place),
            f"{mode['f_hz']:.3f}",
            f"{mode['xi']:.4f}",
            f"{mode['alpha']:.3f}",
            "unknown" if mode["A"] is None else f"{mode['A']:.4f}",
            "unknown" if mode["d_ms"] is None else f"{mode['d_ms']:.3f}",
        )
    return shown


def responses_table(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    """Errors of floors and storeys."""
    headings = ("response", "RMS, mm", "largest, mm", "RMS^R", "MTE^R")
    shown = table(
        "Errors of floors and storeys", {"response": "left", **dict.fromkeys(headings[1:], "right")}
    )
    for one in content["responses"]["each"]:
        lengths = (
            f"{significant(size['value'])} ({significant(size['low'])} to {significant(size['high'])})"
            for size in (one["rms_mm"], one["peak_mm"])
        )
        shares = (
            "unknown" if size is None else percent_with_interval(size["value"], size["low"], size["high"])
            for size in (one["rms"], one["mte"])
        )
        shown.add_row(one["name"], *lengths, *shares)
    return shown


def _sentences(content: dict[str, Any]) -> Iterator[str]:
    resolved = content["over_frequency"]
    if resolved is not None:
        low, high = resolved["frequency_hz"][0], resolved["frequency_hz"][-1]
        yield (
            f"A and d over frequency are known from {significant(low)} to {significant(high)} Hz and "
            f"account for an RMS^R of {percent(resolved['error']['rms'], decimals=2)}; without them "
            f"{percent(resolved['error']['remaining_rms'], decimals=2)} would remain."
        )
