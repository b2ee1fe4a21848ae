"""Report of one measured test of a partitioned frame, to be filed with it."""

from collections.abc import Mapping

import numpy as np

from reliab.assessment import LEVEL, FrameAssessment, ModeOfTest, Word
from reliab.report.document import Block, Document, Figure, Paragraph, Points, Section, Table
from reliab.report.figures.tracking_over_frequency import amplitude_and_delay_over_frequency
from reliab.report.kinds.assessment.error import (
    TONES,
    budget_table,
    error_sentence,
    errors_table,
    histories_figure,
    improve_first,
    quantities_table,
    responses_table,
)
from reliab.report.numbers import MISSING
from reliab.report.prose import Prose, prose
from reliab.report.provenance import provenance_of
from reliab.report.sources import SOURCES
from reliab.significant import percent, share_in_words, significant
from reliab.vocabulary import MILLI, PERCENT

_KILO = 1e3


def frame_assessment_report(assessment: FrameAssessment, *, provenance: Mapping[str, object]) -> Document:
    """Report the verdict on a test of a frame."""
    of_test, budget = (assessment.error, assessment.recording), assessment.error.budget
    sections = (
        Section(
            title="The error of this test",
            blocks=(errors_table(*of_test), budget_table(budget), histories_figure(*of_test)),
        ),
        Section(title="Floors and storeys", blocks=(responses_table(assessment.responses),)),
        Section(title="What to know", blocks=(Points(items=tuple(_cautions(assessment))),)),
        Section(title="What to improve", blocks=(Paragraph(text=improve_first(assessment.error)),)),
        Section(title="Amplitude and delay over frequency", blocks=_over_frequency(assessment)),
        Section(title="How it was judged", blocks=(Paragraph(text=_method()),)),
    )
    return Document(
        kind="Assessment of a real-time hybrid simulation",
        title=assessment.recording.name,
        verdict=error_sentence(assessment.error, assessment.verdict.word),
        tone=TONES[assessment.verdict.word],
        facts=_facts(assessment),
        blocks=sections,
        provenance=provenance_of(
            provenance, *([] if assessment.criterion is None else [assessment.criterion.provenance])
        ),
        sources=SOURCES,
        sheet=True,
    )


def _facts(assessment: FrameAssessment) -> dict[str, Prose]:
    recording, partition = assessment.recording, assessment.frame.partition
    facts: dict[str, Prose] = {
        "Test": f"{recording.name}, {recording.duration:.1f} s at {1.0 / recording.time_step:.5g} Hz",
        "Structure": f"{assessment.frame.name}: {partition.frame.size} degrees of freedom",
        "Specimen": _specimen(assessment),
        "Threshold and window": (
            f"{percent(assessment.error.threshold)} of the measured interface displacement, over the test's "
            f"own {recording.duration:.4g} s"
        ),
    }
    placed = assessment.population
    if placed is not None and assessment.criterion is not None:
        index = MISSING if placed.index is None else significant(placed.index)
        population = assessment.criterion.provenance.population
        motions = f"motions like the {population}" if population else "the population's ground motions"
        facts["Index of the criterion"] = (
            f"{index} against 1, for {share_in_words(assessment.promise)} of {motions}"
        )
    return facts


def _specimen(assessment: FrameAssessment) -> str:
    """Say what is known of the specimen."""
    stated, learned = assessment.frame.partition.specimen, assessment.error.specimen
    if learned is not None:
        missed = percent(learned.held_out, decimals=1)
        return f"learned from its force, of which {missed} is missed where it was held out"
    return (
        f"stiffness {stated.stiffness / _KILO:.4g} kN/m, damping {stated.damping:.4g} N s/m, "
        f"mass {stated.mass:.4g} kg"
    )


def _cautions(assessment: FrameAssessment) -> list[Prose]:
    verdict = assessment.verdict
    of_what = (
        "a linear frame with the stated matrices"
        if assessment.error.specimen is None
        else "the frame whose matrices without the specimen are as stated, and whose specimen its force shows"
    )
    return [
        *(verdict.reasons if verdict.word is Word.UNDECIDED else ()),
        *(f"What would decide: {remedy}" for remedy in verdict.would_decide),
        *assessment.warnings,
        *assessment.recording.notes,
        f"The error is that of {of_what}, whatever the actuator did.",
    ]


def _over_frequency(assessment: FrameAssessment) -> tuple[Block, ...]:
    resolved, tracked = assessment.over_frequency, assessment.resolved
    if resolved is None or tracked is None:
        return (_indices(assessment), _modes(assessment))
    tracking = assessment.tracking
    figure = Figure(
        drawing=amplitude_and_delay_over_frequency(
            resolved,
            amplitude=tracking.amplitude,
            delay=tracking.delay,
            modes=[mode.frequency for mode in assessment.modes],
        ),
        caption="Amplitude and delay of the actuator over frequency with their 90 % bands, where command and "
        "measured displacement are coherent. Dashed: the index of the whole test. Dotted: the modes of the "
        "structure.",
        label="fig:frequency",
    )
    text = (
        f"Amplitude and delay over frequency account for an RMSᴿ of {percent(tracked.rms)}; without them "
        f"{percent(tracked.remaining_rms)} would remain, which no gain and delay describes: noise, friction, "
        "saturation, or a force that was fed back late."
    )
    return (_indices(assessment), _modes(assessment), Paragraph(text=text), figure)


def _indices(assessment: FrameAssessment) -> Table:
    tracking, margin = assessment.tracking, assessment.stability_margin
    (low_a, high_a), (low_d, high_d) = tracking.interval(LEVEL)
    late = [f"{MILLI * value:.3f}" for value in (tracking.delay, low_d, high_d)]
    critical = MILLI * assessment.critical_delay
    rows = [
        ("Amplitude A", f"{tracking.amplitude:.5f}", f"{low_a:.5f} to {high_a:.5f}"),
        ("Equivalent delay d [ms]", late[0], f"{late[1]} to {late[2]}"),
        (
            "Delay at which the loop is unstable [ms]",
            f"{critical:.2f}" if np.isfinite(critical) else "none",
            "",
        ),
        ("Share of it that is free [%]", MISSING if margin is None else f"{PERCENT * margin:.1f}", ""),
        ("Noise in the measured displacement [%]", f"{PERCENT * tracking.noise_share:.2f}", ""),
    ]
    return quantities_table(
        rows,
        ("Quantity", "Found", f"{percent(LEVEL, decimals=0)} interval"),
        caption=prose(
            "Indices $A$ and $d$ of the whole test at the interface, and the exact critical delay."
        ),
        label="tab:numbers",
    )


def _modes(assessment: FrameAssessment) -> Table:
    rows = [(str(place), *_of_mode(mode)) for place, mode in enumerate(assessment.modes, start=1)]
    return quantities_table(
        rows,
        ("Mode", "f [Hz]", "ξ [%]", "Specimen's share [%]", "A(f)", "d(f) [ms]"),
        caption="Modes of the structure, the specimen's share of their stiffness, and how the actuator "
        "tracked at their frequencies; empty where the test does not show it.",
        label="tab:modes",
    )


def _of_mode(mode: ModeOfTest) -> tuple[str, ...]:
    return (
        f"{mode.frequency:.3f}",
        f"{PERCENT * mode.damping_ratio:.2f}",
        f"{PERCENT * mode.share:.1f}",
        "" if mode.amplitude is None else f"{mode.amplitude:.4f}",
        "" if mode.delay is None else f"{MILLI * mode.delay:.3f}",
    )


def _method() -> Prose:
    return prose(
        "The error is rebuilt from command and measured displacement: the restoring force of their "
        "difference, filtered by the equation of motion of the whole frame, gives the deviation of the test "
        "from the undisturbed structure. $A(f)$ and $d(f)$ are the ratio of averaged spectra of measured and "
        "command displacement; their part of the error is that of an actuator with this ratio under the "
        "command of the test. $A$ and $d$ of the whole test are the frequency-domain evaluation index "
        "@guo2014."
    )
