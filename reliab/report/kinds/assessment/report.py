"""Report of one measured test, to be filed with it: verdict, error, and where it comes from."""

from collections.abc import Mapping, Sequence
from typing import Final, Literal

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.error_of_test import CANCELLING, ErrorOfTest
from reliab.assessment.frame_responses import ResponseErrors
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.parts import PART_NAMES, Parts, part_in_words
from reliab.assessment.rebuilt_error.spread import DisplacementError, Estimate
from reliab.assessment.tracking_index import LEVEL
from reliab.assessment.uncertainty_budget import BudgetItem
from reliab.assessment.verdict import Word, error_in_words, next_steps
from reliab.core.significant_digits import (
    decimals_of_interval,
    decimals_of_uncertainty,
    percent,
    percent_and_interval,
    percent_with_interval,
    share_in_words,
    significant,
    value_and_interval,
)
from reliab.core.vocabulary import ERROR_NAMES, MILLI, PERCENT, Metric
from reliab.recordings.recording import Recording
from reliab.report.document import Block, Document, Figure, Points, Section, Table, provenance_of, text_table
from reliab.report.figures.measured_test import error_over_time, tracking_overview
from reliab.report.numbers import MISSING, Fixed, Significant, WrittenNumber, write_in_line
from reliab.report.prose import Prose, meaning_of_confidence, prose, replace_arguments_by_options, spell_out

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
    recording: Recording,
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


def assessment_report(
    assessment: Assessment,
    *,
    title: str = "",
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report the verdict on a test."""
    error, recording = assessment.error, assessment.recording
    sections = [
        Section(
            title="The error of this test",
            blocks=(
                errors_table(error, recording),
                budget_table(error.budget, error.would_decide),
                histories_figure(error.displacements[0], error.parts, recording),
            ),
        ),
        Section(title="What to know", blocks=(Points(items=(*_cautions(assessment), *notes)),)),
        Section(title="What to improve", blocks=(advice(assessment),)),
        Section(title="Amplitude and delay", blocks=(_numbers(assessment), _plane(assessment))),
        Section(title="How it was judged", blocks=(_method(assessment),)),
    ]
    return document_of_test(
        assessment,
        tuple(sections),
        title=title,
        facts=_facts(assessment),
        provenance=provenance_of(provenance, assessment.criterion.provenance),
    )


def _facts(assessment: Assessment) -> dict[str, Prose]:
    structure, recording = assessment.structure, assessment.recording
    basis = (
        f"the boundary of its own ground motion, {assessment.placement.motion}"
        if assessment.placement
        else _describe_population(assessment)
    )
    window = (
        assessment.criterion.provenance.window
        if assessment.placement is None
        else f"{assessment.placement.window[0]:.4g} to {assessment.placement.window[1]:.4g} s of the record"
    )
    return {
        "Structure": prose(
            "$f =$ {f} Hz, $xi =$ {xi}, share of the stiffness in the laboratory $alpha =$ {alpha}",
            f=_write_stated_value(assessment, "f", structure.frequency),
            xi=_write_stated_value(assessment, "xi", structure.damping_ratio),
            alpha=_write_stated_value(assessment, "alpha", structure.experimental_fraction),
        ),
        "Threshold and window": (
            f"{percent(assessment.error.threshold)}, over the test's own {recording.duration:.4g} s"
        ),
        "Check by A and d": (
            f"{spell_out(assessment.verdict_by_index.word).capitalize()}. "
            f"{assessment.verdict_by_index.reasons[-1]} "
            f"Limits of {basis}; window of the error: {window}"
        ),
    }


def _describe_population(assessment: Assessment) -> str:
    """Say for which ground motions the criterion speaks, and where the test lies among them."""
    population, position = assessment.criterion.provenance.population, assessment.scope.position
    share = share_in_words(assessment.promise)
    if not population or position is None:
        return f"{share} of the ground motions behind the criterion"
    return f"{share} of motions like these, with the test {position} of them: {population}"


def _write_stated_value(assessment: Assessment, name: str, value: float) -> str:
    return str(assessment.stated.get(name, f"{value:g}"))


def _numbers(assessment: Assessment) -> Table:
    tracking = assessment.tracking
    (low_a, high_a), (low_d, high_d) = tracking.interval(LEVEL)
    a, b = assessment.limits
    critical, limit = MILLI * assessment.critical_delay, f"1 ± {significant(np.sqrt(a))}"
    delay = (MILLI * size for size in (tracking.delay, low_d, high_d))
    rows = [
        ("Amplitude A", *value_and_interval(tracking.amplitude, low_a, high_a), limit),
        ("Equivalent delay d [ms]", *value_and_interval(*delay), significant(np.sqrt(b))),
        (
            "Index (A − 1)²/a + d²/b",
            *_index(assessment),
            "1",
        ),
        *_own_boundary_rows(assessment),
        *_tracking(assessment),
        (
            "Delay that makes the loop unstable [ms], free share of it [%]",
            (
                f"{f'{critical:.2f}' if np.isfinite(critical) else 'none'}, "
                f"{Fixed(decimals=1, factor=PERCENT)(assessment.stability_margin).digits}"
            ),
            "",
            "",
        ),
        ("Noise in the measured displacement [%]", f"{PERCENT * tracking.noise_share:.2f}", "", ""),
    ]
    return text_table(
        rows,
        ("Quantity", "Found", f"{percent(LEVEL, decimals=0)} interval", "Limit"),
        caption=prose(
            "Indices of the test. The limit of $A$ is that of a test without delay, the limit of $d$ that of"
            " a test without amplitude error."
        ),
        label="tab:numbers",
    )


def _index(assessment: Assessment) -> tuple[str, str]:
    if assessment.index is None or assessment.index_interval is None:
        return MISSING, ""
    return value_and_interval(assessment.index, *assessment.index_interval)


def _own_boundary_rows(assessment: Assessment) -> list[tuple[str, str, str, str]]:
    if assessment.placement is None:
        return []
    low, high = (PERCENT * limit for limit in assessment.placement.error_interval)
    bound = f"{PERCENT * assessment.criterion.threshold:g}"
    row = (
        "Error under its own motion [%]",
        *value_and_interval(PERCENT * assessment.placement.error, low, high),
        bound,
    )
    return [row]


def _tracking(assessment: Assessment) -> list[tuple[str, str, str, str]]:
    measures = assessment.measures
    small = Fixed(decimals=4, signed=True)
    energy = Fixed(decimals=1, factor=PERCENT, signed=True)
    return [
        (
            "Largest tracking error over the command's peak [%]",
            f"{PERCENT * measures.maximum_error:.2f}",
            "",
            "",
        ),
        ("RMS tracking error over the command's RMS [%]", f"{PERCENT * measures.rms_error:.2f}", "", ""),
        (
            "Phase [rad] and amplitude error indices",
            _both(Fixed(decimals=4)(measures.phase_error), small(measures.amplitude_error)),
            "",
            "",
        ),
        (
            "Tracking indicator [m²], energy error over strain energy [%]",
            _both(Significant()(measures.tracking_indicator), energy(measures.energy_error)),
            "",
            "",
        ),
    ]


def _both(first: WrittenNumber, second: WrittenNumber) -> str:
    return f"{write_in_line(first)}, {write_in_line(second)}"


def _plane(assessment: Assessment) -> Figure:
    share = share_in_words(assessment.promise)
    boundaries = {f"{share} of motions": (assessment.population.a, assessment.population.b)}
    if assessment.placement is not None:
        boundaries = {
            f"motion {assessment.placement.motion}": (assessment.placement.a, assessment.placement.b),
            **boundaries,
        }
    windows = assessment.windows if assessment.windows.centre.size else None
    window_phrase = (
        ""
        if windows is None
        else f" Right: both in windows of {significant(windows.length)} s (bars: two standard "
        "deviations); look for a trend, which a steady rig does not show."
    )
    return Figure(
        drawing=tracking_overview(assessment.tracking, boundaries=boundaries, windows=windows),
        caption=(
            "Left: the index accepts the test inside the ellipse; the grey cloud shows the uncertainty "
            f"from noise.{window_phrase}"
        ),
        label="fig:plane",
    )


_SPECIMENS = {
    "stated": "a linear structure with the stated properties",
    "modelled": "a structure with the specimen of the model",
    "measured": "a structure with the specimen learned from its force",
}


def _cautions(assessment: Assessment) -> list[Prose]:
    warnings = () if assessment.placement else assessment.criterion.provenance.warnings
    return [
        *remarks(assessment, *warnings),
        prose(
            f"The error is that of {_SPECIMENS[assessment.error.specimen_known]}, whatever the actuator did; "
            "$A$ and $d$ do not describe friction, backlash or saturation."
        ),
    ]


def _method(assessment: Assessment) -> Prose:
    return (
        *prose(
            "The error is rebuilt from command and measured displacement: their difference, filtered by "
            "the structure's own equation of motion, gives the deviation of the test from the undisturbed "
            "structure. $A$ and $d$ are the amplitude and delay of the frequency-domain evaluation index "
            "@guo2014 between command and measured displacement, corrected for noise in the command and "
            "for the ends of the record; intervals come from resampled blocks of the residual. The index "
            "$(A - 1)^2 \\/ a + d^2 \\/ b$ is that of @guo2017. "
        ),
        *_basis(assessment),
    )


def _basis(assessment: Assessment) -> Prose:
    """Say what the index was compared with."""
    criterion = assessment.criterion
    if assessment.placement:
        return prose(
            "The error of a test with this gain and delay was simulated under its own ground motion and "
            "compared with the threshold."
        )
    if assessment.speaks_for_none:
        return prose("No share of motions is stated for the limits $a$ and $b$.")
    return prose(
        "The limits $a$ and $b$ are those that {share} of comparable ground motions exceed ({meaning}).",
        share=percent(criterion.confidence),
        meaning=meaning_of_confidence(criterion.method),
    )
