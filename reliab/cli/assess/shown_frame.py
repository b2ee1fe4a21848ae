"""What `reliab assess --structure` prints about a test of a frame."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.shown_channels import show_channels
from reliab.cli.output import console, table
from reliab.significant import significant

if TYPE_CHECKING:
    from reliab.assessment import FrameAssessment


def show_frame(assessment: "FrameAssessment") -> None:
    """Print verdict, error, tracking at the modes, and what to know."""
    content = assessment.to_dict()
    terminal = console()
    terminal.print(_quantities(content))
    terminal.print(_modes(content))
    for sentence in _sentences(content):
        terminal.print(sentence, markup=False, highlight=False)
    for warning in content["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
    show_channels(content["recording"]["channels"])
    for note in content["notes"]:
        terminal.print(f"Note: {note}", markup=False, highlight=False)


def _quantities(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    metric, threshold = content["metric"], content["threshold"]
    judged, margin = content["error"][metric], content["stability_margin"]
    critical = content["critical_delay_ms"]
    rows = {
        "verdict": content["verdict"].replace("_", " ").upper(),
        f"error, {metric}": f"{100 * judged['value']:.2f} %",
        "90 % interval": f"{100 * judged['low']:.2f} to {100 * judged['high']:.2f} %",
        f"probability below {100 * threshold:g} %": f"{content['probability']:.3f}",
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


def _sentences(content: dict[str, Any]) -> Iterator[str]:
    from reliab.assessment import PART_NAMES

    yield from content["reasons"]
    yield from (f"What would decide: {remedy}" for remedy in content["would_decide"])
    resolved = content["over_frequency"]
    if resolved is not None:
        low, high = resolved["frequency_hz"][0], resolved["frequency_hz"][-1]
        yield (
            f"A and d over frequency are known from {significant(low)} to {significant(high)} Hz and "
            f"account for an RMS^R of {resolved['error']['rms']:.2%}; without them "
            f"{resolved['error']['remaining_rms']:.2%} would remain."
        )
    first = content["error"]["improve_first"]
    remaining = content["error"]["parts"][first]["remaining_rms"]
    yield f"Improve first: {PART_NAMES[first]}; without its part RMS^R would be {remaining:.2%}."
