"""What `reliab assess --structure` prints about a test of a frame, below the verdict."""

from collections.abc import Iterator
from typing import Any

from reliab.app.cli.assess.shown_briefly import budget_table, show_remarks
from reliab.app.cli.output import console, say, table
from reliab.core.significant_digits import percent, percent_with_interval, significant


def show_frame(content: dict[str, Any], *, details: bool) -> None:
    """Print the errors of several displacements, and if asked all that is below the verdict."""
    terminal = console()
    if "degrees_of_freedom" in content["error"]:
        terminal.print(_degrees(content))
    if not details:
        return
    terminal.print(_parts(content["error"]))
    terminal.print(_quantities(content))
    terminal.print(_modes(content["modes"]))
    terminal.print(budget_table(content))
    terminal.print(_responses(content))
    say(*(content["responses"]["in_words"], *_sentences(content)))
    show_remarks(content)


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


def _parts(error: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    from reliab.assessment.error_of_test import part_in_words

    degrees = error.get("degrees_of_freedom", {"RMS^R": error})
    judged = {name: degree for name, degree in degrees.items() if degree["parts"]}
    shown = table("RMS^R of each part of the error", {"part": "left", **dict.fromkeys(judged, "right")})
    for part in error["parts"]:
        sizes = (percent(degree["parts"][part]["rms"], decimals=2) for degree in judged.values())
        shown.add_row(part_in_words(part), *sizes)
    return shown


def _quantities(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    margin, critical = content["stability_margin"], content["critical_delay_ms"]
    rows = {}
    for actuator in content.get("actuators", [content]):
        whose = f" of actuator {actuator['name']}" if "name" in actuator else ""
        rows[f"A{whose}"] = f"{actuator['A']:.4f}"
        rows[f"d{whose}"] = f"{actuator['d_ms']:.3f} ms"
    rows["critical delay"] = "none" if critical is None else f"{critical:.3f} ms"
    rows["stability margin"] = "none" if margin is None else f"{margin:.3f}"
    if content.get("by_index") is not None:
        by_index = content["by_index"]
        index = "unknown" if by_index["index"] is None else significant(by_index["index"])
        rows["index of the criterion"] = f"{index}: {by_index['verdict'].replace('_', ' ')}"
    shown = table(f"Test of {content['structure']}", {"": "left", "value": "left"})
    for name, value in rows.items():
        shown.add_row(name, value)
    return shown


def _modes(modes: list[dict[str, Any]]) -> Any:  # noqa: ANN401 - Rich's table
    headings = ("mode", "f, Hz", "damping ratio", "specimen's share", "A(f)", "d(f), ms")
    shown = table("Tracking at the modes of the structure", dict.fromkeys(headings, "right"))
    for place, mode in enumerate(modes, start=1):
        shown.add_row(
            str(place),
            f"{mode['f_hz']:.3f}",
            f"{mode['xi']:.4f}",
            f"{mode['alpha']:.3f}",
            "unknown" if mode["A"] is None else f"{mode['A']:.4f}",
            "unknown" if mode["d_ms"] is None else f"{mode['d_ms']:.3f}",
        )
    return shown


def _responses(content: dict[str, Any]) -> Any:  # noqa: ANN401 - Rich's table
    """Errors of floors and storeys."""
    unit = content["responses"]["unit"]
    headings = ("response", f"RMS, {unit}", f"largest, {unit}", "RMS^R", "MTE^R")
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
    yield from ((content.get("by_index") or {}).get("reasons") or ())[-1:]
    if "critical_direction" in content and content["critical_delay_ms"] is not None:
        moved = ", ".join(
            f"{name} {significant(value, 2)}" for name, value in content["critical_direction"].items()
        )
        yield (
            "The critical delay is common to all actuators: with it the loop oscillates at "
            f"{significant(content['critical_frequency_hz'])} Hz in the motion {moved}."
        )
    resolved = content.get("over_frequency")
    if resolved is not None:
        low, high = resolved["frequency_hz"][0], resolved["frequency_hz"][-1]
        yield (
            f"A and d over frequency are known from {significant(low)} to {significant(high)} Hz and "
            f"account for an RMS^R of {percent(resolved['error']['rms'], decimals=2)}; without them "
            f"{percent(resolved['error']['remaining_rms'], decimals=2)} would remain."
        )
