"""What `reliab assess --structure` prints about a test with several actuators."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from reliab.cli.assess.shown_briefly import budget_table, widest
from reliab.cli.assess.shown_channels import show_channels
from reliab.cli.assess.shown_frame import responses_table
from reliab.cli.output import console, table
from reliab.significant import percent, percent_with_interval, significant

if TYPE_CHECKING:
    from reliab.assessment import CoupledAssessment

_STYLES = {"reliable": "bold green", "undecided": "bold yellow", "not_reliable": "bold red"}


def show_coupled(assessment: "CoupledAssessment", *, details: bool) -> None:
    """Print the verdict, the error of each degree of freedom and what to improve first; details if asked."""
    content = assessment.to_dict()
    terminal = console()
    terminal.print(
        f"{content['verdict'].replace('_', ' ').upper()}: {content['reasons'][-1]}",
        style=_STYLES[content["verdict"]],
        highlight=False,
        markup=False,
    )
    terminal.print(_degrees(content))
    for sentence in _sentences(content):
        terminal.print(sentence, highlight=False, markup=False)
    for warning in content["warnings"]:
        terminal.print(f"Warning: {warning}", style="yellow", markup=False, highlight=False)
    if not details:
        terminal.print("For all results, add --details.", highlight=False)
        return
    terminal.print(_parts(content))
    terminal.print(budget_table(content))
    terminal.print(responses_table(content))
    terminal.print(content["responses"]["in_words"], markup=False, highlight=False)
    show_channels(content["recording"]["channels"])
    for note in content["notes"]:
        terminal.print(f"Note: {note}", markup=False, highlight=False)


def _degrees(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    headings = {"degree of freedom": "left", "RMS^R": "right", "MTE^R": "right", "below": "right"}
    shown = table(f"Error of {content['structure']}, with 90 % intervals", headings)
    for name, degree in content["error"]["degrees_of_freedom"].items():
        if not degree["judged"]:
            shown.add_row(name, "not judged", "", "")
            continue
        sizes = (
            percent_with_interval(*(degree[metric][end] for end in ("value", "low", "high")))
            for metric in ("rms", "mte")
        )
        shown.add_row(name, *sizes, significant(degree["probability"], 2))
    return shown


def _sentences(content: dict[str, Any]) -> Iterator[str]:
    from reliab.assessment import cause_in_words

    error = content["error"]
    yield from content["reasons"][:-1]
    yield from (f"What would decide: {remedy}" for remedy in content["would_decide"])
    if error["improve_first"] is not None:
        remaining = percent(error["parts"][error["improve_first"]]["remaining_rms"], decimals=2)
        yield (
            f"Improve first: {cause_in_words(error['improve_first'])}; without it RMS^R of "
            f"{error['governing']} would be {remaining}."
        )
    yield from widest(content)
    tracked = (
        f"actuator {actuator['name']} A = {actuator['A']:.4f}, d = {significant(actuator['d_ms'])} ms"
        for actuator in content["actuators"]
    )
    yield f"Tracking: {'; '.join(tracked)}."
    if content["critical_delay_ms"] is not None:
        moved = ", ".join(
            f"{name} {significant(value, 2)}" for name, value in content["critical_direction"].items()
        )
        yield (
            f"Unstable from a delay of {significant(content['critical_delay_ms'])} ms of all actuators, at "
            f"{significant(content['critical_frequency_hz'])} Hz in the motion {moved}: stability margin "
            f"{significant(content['stability_margin'], 2)}."
        )


def _parts(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    from reliab.assessment import cause_in_words

    names = [name for name, degree in content["error"]["degrees_of_freedom"].items() if degree["judged"]]
    shown = table("RMS^R of each part of the error", {"part": "left", **dict.fromkeys(names, "right")})
    for part in content["error"]["parts"]:
        sizes = (
            percent(content["error"]["degrees_of_freedom"][name]["parts"][part]["rms"], decimals=2)
            for name in names
        )
        shown.add_row(cause_in_words(part), *sizes)
    return shown
