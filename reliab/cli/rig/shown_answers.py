"""What a rig's tests answer, on the terminal."""

from collections.abc import Mapping
from typing import Any

from reliab.cli.output import console, say, table
from reliab.significant import percent, significant


def show_prediction(content: Mapping[str, Any]) -> None:
    """Print what is predicted of the next test."""
    from_what = f"{content['tests']} tests of {content['earthquakes']} earthquakes"
    rows = table(
        f"The next test of {content['rig']}, from {from_what}",
        {"": "left", "5 %": "right", "median": "right", "95 %": "right"},
    )
    ends = ("low", "median", "high")
    rows.add_row("A", *(f"{content['A'][end]:.4f}" for end in ends))
    rows.add_row("d [ms]", *(f"{content['d_ms'][end]:.2f}" for end in ends))
    rows.add_row("remainder", *(percent(content["remainder"][end]) for end in ends))
    rows.add_row("error RMS^R", *(percent(content["rms"][end]) for end in ends))
    console().print(rows)
    shares = ", ".join(f"{name} {percent(share, 2)}" for name, share in content["drivers"].items())
    _say(
        f"Probability {content['probability']:.2f} that the error stays below "
        f"{percent(content['threshold'])}. "
        f"Its square comes from: {shares}."
    )
    _say(f"By {content['basis']}.")
    scores = ", ".join(
        f"{name} {'unknown' if score is None else significant(score)}"
        for name, score in content["log_scores"].items()
    )
    _say(f"Log scores on earthquakes left out: {scores}. Best: {content['better']}.")
    worst = max(item["r_hat"] for item in content["sampling"].values())
    least = min(item["effective_size"] for item in content["sampling"].values())
    _say(f"Posterior of the variances: R-hat at most {worst:.3f}, at least {least:.0f} independent draws.")
    for note in content["notes"]:
        _say(f"Note: {note}")


def show_plan(content: Mapping[str, Any]) -> None:
    """Print each remedy in a sentence, and what the error depends on."""
    _say(
        f"{percent(content['share_now'])} of the coming tests would have an error below "
        f"{percent(content['threshold'])}; {percent(content['share'])} are wanted. Each remedy alone:"
    )
    for remedy in content["remedies"]:
        _say(f"- {remedy['sentence']}")
    rows = table(
        "Sobol indices of the error's logarithm", {"": "left", "first order": "right", "total": "right"}
    )
    for name, indices in content["sobol"].items():
        rows.add_row(name, f"{indices['first_order']:.2f}", f"{indices['total']:.2f}")
    console().print(rows)


def show_comparison(content: Mapping[str, Any]) -> None:
    """Print both sides, and the probability that each quantity became smaller."""
    first, second = content["tests"]
    rows = table(
        f"{first} tests against {second}",
        {"": "left", "first": "right", "second": "right", "P(better)": "right", "next test": "right"},
    )
    for name, label in (
        ("amplitude_error", "|A - 1|"),
        ("delay_ms", "|d| [ms]"),
        ("remainder", "remainder"),
        ("rms", "error RMS^R"),
    ):
        contrast = content[name]
        rows.add_row(
            label,
            *(significant(contrast[side]) for side in ("before", "after")),
            *(f"{contrast[key]:.2f}" for key in ("probability_better", "next_test_better")),
        )
    console().print(rows)


def _say(text: str) -> None:
    say(text, soft_wrap=True)
