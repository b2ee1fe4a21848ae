"""The answer about a test in a dozen sentences, from what its `to_dict` holds."""

from collections.abc import Iterator, Mapping
from typing import Any, Final

from reliab.assessment.error_of_test import CANCELLING
from reliab.assessment.parts import part_in_words
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.verdict import Word, error_in_words, next_steps
from reliab.core.significant_digits import (
    decimals_of_interval,
    decimals_of_uncertainty,
    percent,
    percent_with_interval,
    significant,
)
from reliab.core.vocabulary import ERROR_NAMES, PERCENT, Metric

_LARGEST: Final = 3  # entries of the budget


def headline(content: Mapping[str, Any]) -> str:
    """State the verdict, the error, how likely it is to be small enough, and what leaves a test undecided."""
    word, metric, error = Word(content["verdict"]).shout, content["metric"], content["error"]
    if error[metric]["value"] is None:
        return f"{word}: {content['reasons'][-1]}"
    size = Estimate(**{end: error[metric][end] for end in ("value", "low", "high")})
    name = f"{ERROR_NAMES[metric]}{_governing_suffix(error)}"
    sentence = error_in_words(name, size, content["threshold"], content["probability"])
    budget, is_single_reason = content.get("budget", []), len(content["reasons"]) == 1
    if content["verdict"] == Word.UNDECIDED and not is_single_reason:
        sentence += "; not to be relied on for these reasons:"
    elif content["verdict"] == Word.UNDECIDED and budget:
        sentence += f"; least known: {budget[0]['quantity']}"
    return f"{word}: {sentence}"


def _governing_suffix(error: Mapping[str, Any]) -> str:
    """Of several displacements the one with the largest error, to follow a name."""
    return f" of {error['governing']}" if "governing" in error else ""


def findings(content: Mapping[str, Any]) -> Iterator[str]:
    """Say how large the error is, what its interval comes from, and how the actuator tracked."""
    error, budget = content["error"], content.get("budget", [])
    yield from content["reasons"][:-1]  # the last one says the size, as the headline does
    if error[content["metric"]]["value"] is not None:
        sizes = (f"{ERROR_NAMES[name]} {_interval(error[name])}" for name in Metric)
        yield f"Errors with 90 % intervals: {'; '.join(sizes)}."
    if budget:
        decimals = decimals_of_uncertainty(PERCENT * budget[0]["contribution"], digits=2)
        entries = (
            f"{item['quantity']} ±{percent(item['contribution'], decimals=decimals)}"
            for item in budget[:_LARGEST]
        )
        yield f"Largest contributions to the interval: {', '.join(entries)}."
    yield _tracking(content)


def _interval(size: Mapping[str, Any]) -> str:
    return percent_with_interval(*(size[end] for end in ("value", "low", "high")))


def _decimals(size: Mapping[str, Any]) -> int:
    """Decimals in per cent that the interval of an error allows."""
    return decimals_of_interval(*(PERCENT * size[end] for end in ("value", "low", "high")))


def _tracking(content: Mapping[str, Any]) -> str:
    actuators = [{"name": "", **actuator} for actuator in content.get("actuators", [content])]
    descriptions = (
        f"{'actuator ' if actuator['name'] else ''}{actuator['name']} A = {actuator['A']:.4f}, d = "
        f"{significant(actuator['d_ms'])} ms".lstrip()
        for actuator in actuators
    )
    line = f"Tracking: {'; '.join(descriptions)}"
    index_content = content.get("by_index")
    if index_content is None or index_content["index"] is None:
        return f"{line}."
    index_line = f"By the criterion for A and d: {index_content['verdict'].replace('_', ' ')}"
    return f"{line}. {index_line}. {index_content['reasons'][-1]}"


def actions(content: Mapping[str, Any]) -> Iterator[str]:
    """Say what to do next."""
    error = content["error"]
    first, narrowing = error["improve_first"], error.get("would_decide", ())
    if first is not None:
        remaining = percent(error["parts"][first]["remaining_rms"], decimals=_decimals(error["rms"]))
        yield (
            f"Improve first: {part_in_words(first)}; without it the {ERROR_NAMES[Metric.RMS]}"
            f"{_governing_suffix(error)} would be {remaining}."
        )
    elif error["parts"]:
        yield CANCELLING
    yield from (f"To narrow the interval: {remedy[:1].lower()}{remedy[1:]}" for remedy in narrowing)
    yield from next_steps(content["would_decide"], narrowing)
