"""Report of one measured test with several actuators, to be filed with it."""

from collections.abc import Mapping

import numpy as np

from reliab.arrays import Array
from reliab.assessment import CoupledAssessment, Word, cause_in_words, probability_text
from reliab.assessment.coupled_error import DegreeError
from reliab.assessment.rebuilt_error import HALF_WIDTH
from reliab.report.document import Document, Figure, Paragraph, Points, Section, Table
from reliab.report.figures.measured_test import error_over_time
from reliab.report.kinds.assessment.error import TONES, budget_table, quantities_table, responses_table
from reliab.report.prose import Prose
from reliab.report.provenance import provenance_of
from reliab.report.wording import spelled_out
from reliab.significant import percent, significant
from reliab.vocabulary import MILLI, PERCENT

_STRETCHES = 40
_PARTS_DRAWN = 3


def coupled_assessment_report(assessment: CoupledAssessment, *, provenance: Mapping[str, object]) -> Document:
    """Report the verdict on a test with several actuators."""
    governing = assessment.governing
    drawn = () if governing is None else (_histories(assessment, governing),)
    advice = () if governing is None else (_improve_first(assessment, governing),)
    return Document(
        kind="Assessment of a real-time hybrid simulation",
        title=assessment.recording.name,
        verdict=_verdict(assessment),
        tone=TONES[assessment.verdict.word],
        facts=_facts(assessment),
        blocks=(
            Section(title="The error of each displacement", blocks=(_errors(assessment), *drawn)),
            Section(title="What to know", blocks=(Points(items=tuple(_cautions(assessment))),)),
            Section(
                title="Where the error comes from",
                blocks=(*advice, _parts(assessment), _tracking(assessment)),
            ),
            Section(title="What is not known", blocks=(budget_table(assessment.budget),)),
            Section(title="Floors and storeys", blocks=(responses_table(assessment.responses),)),
            Section(title="How it was judged", blocks=(Paragraph(text=_METHOD),)),
        ),
        provenance=provenance_of(provenance),
        sheet=True,
    )


_METHOD = (
    "The error is rebuilt from commands and measured displacements: the restoring forces of their "
    "differences, filtered by the equation of motion of the whole frame, give the deviation of the test from "
    "the undisturbed structure. Noise and error of all sensors are drawn together. Gains, delays and "
    "couplings of the actuators are those of least squares."
)


def _verdict(assessment: CoupledAssessment) -> Prose:
    reason = assessment.verdict.reasons[-1].replace("^R", "ᴿ")
    return f"The test is {spelled_out(assessment.verdict.word)}. {reason}"


def _facts(assessment: CoupledAssessment) -> dict[str, Prose]:
    recording, partition = assessment.recording, assessment.frame.partition
    at = "of the interface" if assessment.frame.channels_at_interface else "of the actuators"
    return {
        "Test": f"{recording.name}, {recording.duration:.1f} s at {1.0 / recording.time_step:.5g} Hz; "
        f"channels are displacements {at}",
        "Structure": f"{assessment.frame.name}: {partition.size} degrees of freedom, of which "
        f"{', '.join(partition.names)} are driven",
        "Threshold": f"{percent(assessment.threshold)} of every measured interface displacement",
        "Stability": _stability(assessment),
    }


def _stability(assessment: CoupledAssessment) -> str:
    limit = assessment.limit
    if not np.isfinite(limit.delay):
        return "no delay that all actuators have in common makes the loop unstable"
    moved = ", ".join(
        f"{name} {significant(value, 2)}"
        for name, value in zip(assessment.frame.partition.names, limit.direction.tolist(), strict=True)
    )
    return (
        f"unstable from a delay of {significant(MILLI * limit.delay)} ms of all actuators, at "
        f"{significant(limit.frequency)} Hz in the motion {moved}; margin "
        f"{significant(assessment.stability_margin, 2)}"
    )


def _errors(assessment: CoupledAssessment) -> Table:
    rows: list[tuple[str, ...]] = []
    for degree in assessment.error.degrees:
        if not degree.judged:
            rows.append((degree.name, "not judged", "", "", "", ""))
            continue
        sizes = [
            text
            for size in (degree.rms, degree.mte)
            for text in (
                f"{PERCENT * size.value:.2f}",
                f"{PERCENT * size.low:.2f} to {PERCENT * size.high:.2f}",
            )
        ]
        below = probability_text(degree.probability(assessment.threshold, assessment.metric))
        rows.append((degree.name, *sizes, below))
    return quantities_table(
        rows,
        ("Displacement", "RMSᴿ [%]", "90 % interval", "MTEᴿ [%]", "90 % interval", "Below"),
        caption="Root mean square and largest value of measured minus exact displacement, over the peak of "
        f"the exact one. The last column is the probability of an error below "
        f"{percent(assessment.threshold)}.",
        label="tab:errors",
    )


def _histories(assessment: CoupledAssessment, degree: DegreeError) -> Figure:
    step, size = assessment.error.time_step, degree.reference.size
    places = np.linspace(0.0, degree.draws.mean.size - 1.0, size)
    mean, deviation = (
        np.interp(places, np.arange(history.size), history)
        for history in (degree.draws.mean, degree.draws.deviation)
    )
    return Figure(
        drawing=error_over_time(
            times=np.linspace(0.0, step * (size - 1), size),
            reference=degree.reference,
            measured=degree.reference + mean,
            error=mean,
            band=(mean - HALF_WIDTH * deviation, mean + HALF_WIDTH * deviation),
            parts=_largest_parts(assessment, degree),
        ),
        caption=f"Exact and measured {degree.name}, its error with a 90 % band, and its largest parts, "
        "each with the number of its actuator.",
        label="fig:error",
    )


def _largest_parts(assessment: CoupledAssessment, degree: DegreeError) -> dict[str, Array]:
    """RMS over stretches of the test of the largest parts of an error [m], by name."""
    place = assessment.frame.partition.names.index(degree.name)
    parts = assessment.error.parts.of_degree(place)
    largest = sorted(parts.by_name, key=lambda name: -parts.by_name[name].rms)[:_PARTS_DRAWN]
    over_time = parts.over_time(assessment.error.time_step, assessment.recording.duration / _STRETCHES)
    return {name.removeprefix("actuator_").replace("_", " "): over_time[name] for name in largest}


def _cautions(assessment: CoupledAssessment) -> list[Prose]:
    verdict = assessment.verdict
    return [
        *(verdict.reasons[:-1] if verdict.word is Word.UNDECIDED else ()),
        *(f"What would decide: {remedy}" for remedy in verdict.would_decide),
        *assessment.warnings,
        *assessment.recording.notes,
        "The error is that of a linear frame with the stated matrices, known as exactly as stated.",
    ]


def _parts(assessment: CoupledAssessment) -> Table:
    names = assessment.frame.partition.names
    judged = [degree.name for degree in assessment.error.judged]
    by_degree = {name: assessment.error.parts.of_degree(names.index(name)).by_name for name in judged}
    causes = list(next(iter(by_degree.values()), {}))
    rows = [
        (
            cause_in_words(cause),
            *(
                text
                for name in judged
                for text in (
                    f"{PERCENT * by_degree[name][cause].rms:.2f}",
                    f"{PERCENT * by_degree[name][cause].remaining_rms:.2f}",
                )
            ),
        )
        for cause in causes
    ]
    return quantities_table(
        rows,
        (
            "Part",
            *(text for name in judged for text in (f"RMSᴿ of {name} [%]", "Without it [%]")),
        ),
        caption="RMSᴿ that each part alone makes, and what would remain without it.",
        label="tab:parts",
    )


def _tracking(assessment: CoupledAssessment) -> Table:
    parts = assessment.error.parts
    rows = [
        (
            f"Actuator {number}",
            ", ".join(f"{value:.4f}" for value in parts.gain[place]),
            ", ".join(f"{MILLI * value:.3f}" for value in parts.delay[place]),
        )
        for place, number in enumerate(assessment.recording.actuators)
    ]
    return quantities_table(
        rows,
        ("", "Gain for each command", "Delay for each command [ms]"),
        caption="What each actuator did with the commands of all, by least squares over the whole test.",
        label="tab:tracking",
    )


def _improve_first(assessment: CoupledAssessment, degree: DegreeError) -> Paragraph:
    """Say which part of an error to improve first."""
    place = assessment.frame.partition.names.index(degree.name)
    parts = assessment.error.parts.of_degree(place)
    remaining = parts.by_name[parts.first].remaining_rms
    return Paragraph(
        text=f"Improve first: {cause_in_words(parts.first)}. Without it RMSᴿ of {degree.name} would be "
        f"{percent(remaining)}."
    )
