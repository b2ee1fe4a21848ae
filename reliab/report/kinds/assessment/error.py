"""The error of a test and where it comes from, for its report."""

from collections.abc import Mapping
from typing import Final, Literal

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.error_of_test import CANCELLING, ErrorOfTest
from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.parts import PART_NAMES, Parts, part_in_words
from reliab.assessment.rebuilt_error.spread import DisplacementError, Estimate
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.assessment.verdict import Word, error_in_words, next_steps
from reliab.core.significant_digits import (
    decimals_of_interval,
    decimals_of_uncertainty,
    percent,
    percent_and_interval,
    percent_with_interval,
    significant,
    value_and_interval,
)
from reliab.core.vocabulary import ERROR_NAMES, MILLI, PERCENT, Metric
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.report.document import Block, Document, Figure, Source, Table, text_table
from reliab.report.figures.measured_test import error_over_time
from reliab.report.numbers import MISSING
from reliab.report.prose import Prose, prose
from reliab.report.sources import SOURCES
from reliab.report.wording import replace_arguments_by_options, spell_out

TONES: Final[Mapping[Word, Literal["plain", "good", "bad"]]] = {
    Word.RELIABLE: "good",
    Word.UNDECIDED: "plain",
    Word.NOT_RELIABLE: "bad",
}
"""How a report shows each verdict."""


def document_of_test(
    assessment: JudgedTest,
    blocks: tuple[Block, ...],
    *,
    facts: Mapping[str, Prose],
    provenance: Mapping[str, str],
    title: str = "",
    sources: tuple[Source, ...] = SOURCES,
) -> Document:
    """Head the blocks about a test with its verdict and with what was asked."""
    recording = assessment.recording
    test = f"{recording.name}, {recording.duration:.1f} s at {1.0 / recording.time_step:.5g} Hz"
    return Document(
        kind="Assessment of a real-time hybrid simulation",
        title=title or recording.name,
        verdict=error_sentence(assessment.error, assessment.verdict),
        tone=TONES[assessment.verdict],
        facts={"Test": test, **facts},
        blocks=blocks,
        provenance=provenance,
        sources=sources,
        sheet=True,
    )


def remarks(assessment: JudgedTest, *notes: str) -> list[Prose]:
    """Say why a test is undecided, what to do next, and what to read before relying on the verdict."""
    sentences = (
        # the last reason is the headline
        *(assessment.reasons[:-1] if assessment.verdict is Word.UNDECIDED else ()),
        *next_steps(assessment.would_decide, assessment.error.would_decide),
        *assessment.warnings,
        *assessment.recording.notes,
        *notes,
    )
    return [replace_arguments_by_options(sentence) for sentence in sentences]


_STRETCHES, _PARTS_DRAWN = 40, 4


def errors_table(error: ErrorOfTest, recording: Recording) -> Table:
    """Tabulate the error with its interval, and its parts."""
    decimals = decimals_of_error(error.estimate(Metric.RMS))
    rows = [
        (f"{name[:1].upper()}{name[1:]}", *write_interval(error.estimate(metric)), "")
        for metric, name in ERROR_NAMES.items()
    ]
    for name, share in error.parts.by_name.items():
        own_error, remaining = (f"{PERCENT * size:.{decimals}f}" for size in (share.rms, share.remaining_rms))
        rows.append((f"RMS error from {PART_NAMES[name]} alone", own_error, "", remaining))
    return text_table(
        rows,
        ("Error, over the peak of the exact displacement", "Found [%]", "90 % interval", "Without it"),
        caption=(
            f"Error over the test's own {recording.duration:.4g} s: root mean square and largest "
            "value of measured minus exact displacement. The last column: what would remain without this "
            "part."
        ),
        label="tab:errors",
    )


def decimals_of_error(size: Estimate) -> int:
    """Return with how many decimals in per cent an error is written."""
    return decimals_of_interval(*(PERCENT * end for end in (size.value, size.low, size.high)))


def write_interval(size: Estimate) -> tuple[str, str]:
    """Write an error and its 90 % interval [%]."""
    value, interval = percent_and_interval(size.value, size.low, size.high)
    return value.removesuffix(" %"), interval.removesuffix(" %")


def budget_table(budget: tuple[BudgetItem, ...], narrowing: tuple[str, ...]) -> Table:
    """Tabulate what is not known exactly, the largest first; `narrowing`: what would help most."""
    largest = PERCENT * max((item.contribution for item in budget), default=0.0)
    decimals = decimals_of_uncertainty(largest, digits=2)
    rows = [
        (
            item.quantity,
            "" if item.size is None else f"{significant(item.size, 2)} {item.unit}",
            str(item.source),
            f"{PERCENT * item.contribution:.{decimals}f}",
        )
        for item in budget
    ]
    return text_table(
        rows,
        ("Not known exactly", "Std. deviation", "Source", "Effect on the error [%]"),
        caption=(
            "What is not known exactly, and the standard deviation of the error that each alone causes. "
            f"To narrow the interval: {replace_arguments_by_options(' '.join(narrowing))}"
            if budget
            else "Nothing widens the interval."
        ),
        label="tab:budget",
    )


def responses_table(responses: ResponseErrors) -> Table:
    """Errors of floors and storeys, the largest first."""
    rows = [
        (
            response.name.capitalize(),
            *(
                f"{' ('.join(value_and_interval(size.value, size.low, size.high))})"
                for size in (response.rms_mm, response.peak_mm)
            ),
            *(
                MISSING if size is None else percent_with_interval(size.value, size.low, size.high)
                for size in (response.rms, response.mte)
            ),
        )
        for response in responses.each
    ]
    return text_table(
        rows,
        ("Response", f"RMS [{responses.unit}]", f"Largest [{responses.unit}]", "RMS error", "Largest error"),
        caption="Deviation of the computed floors and storeys from those of the undisturbed "
        f"frame, with 90 % intervals. {responses.sentence}",
        label="tab:responses",
    )


def histories_figure(
    rebuilt: DisplacementError,
    parts: Parts,
    recording: Recording | CoupledRecording,
    *,
    name: str = "response",
) -> Figure:
    """Draw exact and measured history of a displacement, the error with its band, and its largest parts."""
    times = np.linspace(0.0, recording.duration, rebuilt.reference.size)
    shares = parts.rms_over_time(recording.time_step, recording.duration / _STRETCHES)
    largest = sorted(shares, key=lambda cause: -parts.by_name[cause].rms)[:_PARTS_DRAWN]
    return Figure(
        drawing=error_over_time(
            times=times,
            reference=rebuilt.reference,
            measured_values=rebuilt.reference + rebuilt.smooth_error,
            error=rebuilt.smooth_error,
            band=(rebuilt.low, rebuilt.high),
            parts={_label(cause): shares[cause] for cause in shares if cause in largest},
        ),
        caption=(
            f"Top: exact and measured {name}. Middle: their difference, the error, with its 90 % band. "
            "Bottom: what the error comes from."
        ),
        label="fig:error",
    )


def _label(cause: str) -> str:
    """Name a part of an error briefly: of several actuators as "1 delay"."""
    return PART_NAMES.get(cause, cause.removeprefix("actuator_").replace("_", " "))


def improve_first(error: ErrorOfTest) -> str:
    """Say which part of the error to improve first, and what would remain."""
    if not error.parts.by_name:
        return "No displacement stands out of the noise."
    first = error.parts.first
    if first is None:
        return CANCELLING
    remaining = percent(
        error.parts.by_name[first].remaining_rms, decimals=decimals_of_error(error.estimate(Metric.RMS))
    )
    return (
        f"Improve first: {part_in_words(first)}. "
        f"Without it the RMS error{error.displacement_suffix} would be "
        f"{remaining}."
    )


def error_sentence(error: ErrorOfTest, word: Word) -> Prose:
    """State the verdict on a test, its error, and the probability that it is small enough."""
    size = error.estimate(error.metric)
    if np.isnan(size.value):
        return f"The test is {spell_out(word)}: no displacement stands out of the noise of its sensors."
    name = f"{ERROR_NAMES[error.metric]}{error.displacement_suffix}"
    size_phrase = error_in_words(name, size, error.threshold, error.probability, show_interval=True)
    return prose("The test is *{word}*: {how_large}.", word=spell_out(word), how_large=size_phrase)


def advice(assessment: Assessment) -> Prose:
    """Say what to improve first, by the error and by the index."""
    improvement = assessment.improvement
    share = improvement.share_of_delay if improvement.first == "delay" else 1.0 - improvement.share_of_delay
    late, off = MILLI * improvement.tolerable_delay, improvement.tolerable_amplitude_error
    return " ".join(
        (
            improve_first(assessment.error),
            f"The {improvement.first} contributes {percent(share, 2)} of the index.",
            f"With this amplitude a delay of {late:.2f} ms is tolerable."
            if late > 0.0
            else "With this amplitude no delay is tolerable.",
            f"With this delay an amplitude error of {percent(off, 2)} is tolerable."
            if off > 0.0
            else "With this delay no amplitude error is tolerable.",
        )
    )
