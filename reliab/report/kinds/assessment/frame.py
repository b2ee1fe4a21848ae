"""Report of one measured test of a partitioned frame, with one actuator or several, to be filed with it."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure as Drawing

from reliab.assessment.error_of_test import ErrorOfTest
from reliab.assessment.frame_assessment import FrameAssessment, ModeOfTest
from reliab.assessment.parts import part_in_words
from reliab.assessment.tracking_index import LEVEL, TrackingIndex
from reliab.assessment.verdict import probability_text
from reliab.core.significant_digits import percent, share_in_words, significant, value_and_interval
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.report.document import Block, Document, Figure, Points, Section, Table, provenance_of, text_table
from reliab.report.kinds.assessment.report import (
    budget_table,
    decimals_of_error,
    document_of_test,
    errors_table,
    histories_figure,
    improve_first,
    remarks,
    responses_table,
    write_interval,
)
from reliab.report.numbers import MISSING
from reliab.report.prose import Prose, prose
from reliab.report.style import BLUE, GREY, PALE, VERMILION, apply_style, legend_below, panels
from reliab.tracking.indices.tracking import TrackingOverFrequency

_KILO = 1e3


def frame_assessment_report(assessment: FrameAssessment, *, provenance: Mapping[str, object]) -> Document:
    """Report the verdict on a test of a frame, with one actuator or with several."""
    has_several, criterion = assessment.error.has_several, assessment.criterion
    if assessment.tracking is None:
        error_blocks, tracking_blocks = _displacement_blocks(assessment)
    else:
        error_blocks, tracking_blocks = _interface_blocks(assessment, assessment.tracking)
    sections = (
        Section(title="The error of this test", blocks=error_blocks),
        Section(title="Floors and storeys", blocks=(responses_table(assessment.responses),)),
        Section(title="What to know", blocks=(Points(items=tuple(_cautions(assessment))),)),
        Section(title="What to improve", blocks=(improve_first(assessment.error),)),
        tracking_blocks,
        Section(title="How it was judged", blocks=(_method(has_several=has_several),)),
    )
    return document_of_test(
        assessment,
        sections,
        facts=_facts(assessment),
        provenance=provenance_of(provenance, *([] if criterion is None else [criterion.provenance])),
    )


def _interface_blocks(
    assessment: FrameAssessment, tracking: TrackingIndex
) -> tuple[tuple[Block, ...], Section]:
    """Error of the one interface displacement, and how its actuator tracked."""
    error, recording = assessment.error, assessment.recording
    error_blocks = (
        errors_table(error, recording),
        budget_table(error.budget, error.would_decide),
        histories_figure(error.displacements[0], error.parts, recording),
    )
    return error_blocks, Section(
        title="Amplitude and delay over frequency", blocks=_frequency_blocks(assessment, tracking)
    )


def _displacement_blocks(assessment: FrameAssessment) -> tuple[tuple[Block, ...], Section]:
    """Errors of several interface displacements, and what each actuator did."""
    error, governing = assessment.error, assessment.error.governing
    figures: tuple[Block, ...] = ()
    if governing is not None:
        figures = (histories_figure(governing, error.parts, assessment.recording, name=governing.name),)
    error_blocks = (
        _errors(assessment),
        budget_table(assessment.error.budget, assessment.error.would_decide),
        *figures,
    )
    blocks = (_parts(error), _tracking(assessment), _modes(assessment))
    return error_blocks, Section(title="Where the error comes from", blocks=blocks)


def _facts(assessment: FrameAssessment) -> dict[str, Prose]:
    recording, partition = assessment.recording, assessment.frame.partition
    facts: dict[str, Prose] = {
        "Structure": f"{assessment.frame.name}: {partition.frame.size} degrees of freedom",
        "Threshold and window": (
            f"{percent(assessment.threshold)} of {assessment.error_of}, over the test's own "
            f"{recording.duration:.4g} s"
        ),
    }
    facts_of = _facts_of_several if assessment.error.has_several else _facts_of_one
    return facts | facts_of(assessment)


def _facts_of_several(assessment: FrameAssessment) -> dict[str, Prose]:
    position = "of the interface" if assessment.frame.channels_at_interface else "of the actuators"
    return {
        "Driven": f"{', '.join(assessment.frame.partition.names)}; channels are displacements {position}",
        "Stability": _stability(assessment),
    }


def _facts_of_one(assessment: FrameAssessment) -> dict[str, Prose]:
    facts: dict[str, Prose] = {"Specimen": _specimen(assessment)}
    placement = assessment.population
    if placement is not None and assessment.criterion is not None:
        index = MISSING if placement.index is None else significant(placement.index)
        population = assessment.criterion.provenance.population
        motions = f"motions like the {population}" if population else "comparable ground motions"
        facts["Index of the criterion"] = (
            f"{index} against 1, for {share_in_words(assessment.promise)} of {motions}"
        )
    return facts


def _specimen(assessment: FrameAssessment) -> str:
    """Say what is known of the specimen."""
    specimen, learned_specimen = assessment.frame.partition.specimen, assessment.error.specimen
    if learned_specimen is not None:
        unexplained_share = percent(learned_specimen.held_out, decimals=1)
        return f"learned from its force, of which {unexplained_share} is not predicted on held-out parts"
    return (
        f"stiffness {specimen.stiffness / _KILO:.4g} kN/m, damping {specimen.damping:.4g} N s/m, "
        f"mass {specimen.mass:.4g} kg"
    )


def _cautions(assessment: FrameAssessment) -> list[Prose]:
    error = assessment.error
    subject = (
        "a linear frame with the stated matrices"
        if error.specimen is None
        else "the frame whose matrices without the specimen are as stated, and whose specimen was learned "
        "from its force"
    )
    return [*remarks(assessment), f"The error is that of {subject}, whatever the actuator did."]


def _frequency_blocks(assessment: FrameAssessment, tracking: TrackingIndex) -> tuple[Block, ...]:
    over_frequency, index = assessment.over_frequency, assessment.resolved
    if over_frequency is None or index is None:
        return (_indices(assessment, tracking), _modes(assessment))
    figure = Figure(
        drawing=amplitude_and_delay_over_frequency(
            over_frequency,
            amplitude=tracking.amplitude,
            delay=tracking.delay,
            modes=[mode.frequency for mode in assessment.modes],
        ),
        caption="Amplitude and delay of the actuator with 90 % bands, at frequencies at which both channels "
        "are coherent. Dashed: the index of the whole test. Dotted: the modes of the structure.",
        label="fig:frequency",
    )
    text = (
        f"Amplitude and delay over frequency account for an RMS error of {percent(index.rms, 2)}; "
        f"without them {percent(index.remaining_rms, 2)} would remain, which no gain and delay "
        "describes: noise, friction, saturation, or a force that was fed back late."
    )
    return (_indices(assessment, tracking), _modes(assessment), text, figure)


def _indices(assessment: FrameAssessment, tracking: TrackingIndex) -> Table:
    margin = assessment.stability_margin
    amplitude, delay = tracking.amplitude, tracking.delay
    (low_a, high_a), (low_d, high_d) = tracking.interval(LEVEL)
    critical = MILLI * assessment.critical_delay
    rows = [
        ("Amplitude A", *value_and_interval(amplitude, low_a, high_a)),
        ("Equivalent delay d [ms]", *value_and_interval(*(MILLI * end for end in (delay, low_d, high_d)))),
        (
            "Delay at which the loop is unstable [ms]",
            f"{critical:.2f}" if np.isfinite(critical) else "none",
            "",
        ),
        ("Free share of this delay [%]", MISSING if margin is None else f"{PERCENT * margin:.1f}", ""),
        ("Noise in the measured displacement [%]", f"{PERCENT * tracking.noise_share:.2f}", ""),
    ]
    return text_table(
        rows,
        ("Quantity", "Found", f"{percent(LEVEL, decimals=0)} interval"),
        caption=prose(
            "Indices $A$ and $d$ of the whole test at the interface, and the exact critical delay."
        ),
        label="tab:numbers",
    )


def _modes(assessment: FrameAssessment) -> Table:
    """Tabulate the modes of the structure, and how the actuator tracked at their frequencies."""
    rows = [(str(place), *_mode_row(mode)) for place, mode in enumerate(assessment.modes, start=1)]
    return text_table(
        rows,
        ("Mode", "f [Hz]", "ξ [%]", "Specimen's share [%]", "A(f)", "d(f) [ms]"),
        caption="Modes of the structure, the specimen's share of their stiffness, and how the actuator "
        "tracked at their frequencies; empty if the test does not show it.",
        label="tab:modes",
    )


def _mode_row(mode: ModeOfTest) -> tuple[str, ...]:
    return (
        f"{mode.frequency:.3f}",
        f"{PERCENT * mode.damping_ratio:.2f}",
        f"{PERCENT * mode.share:.1f}",
        "" if mode.amplitude is None else f"{mode.amplitude:.4f}",
        "" if mode.delay is None else f"{MILLI * mode.delay:.3f}",
    )


def _method(*, has_several: bool) -> Prose:
    rebuilt = (
        "The error is rebuilt from command and measured displacement: the restoring force of their "
        "difference, filtered by the equation of motion of the whole frame, gives the deviation of the test "
        "from the undisturbed structure. "
    )
    if has_several:
        return (
            f"{rebuilt}Noise and error of all sensors are drawn together. Gains, delays and couplings of the "
            "actuators are those of least squares."
        )
    return prose(
        f"{rebuilt}$A(f)$ and $d(f)$ are the ratio of averaged spectra of measured and command displacement; "
        "their part of the error is that of an actuator with this ratio under the command of the test. $A$ "
        "and $d$ of the whole test are the frequency-domain evaluation index @guo2014."
    )


def _stability(assessment: FrameAssessment) -> str:
    limit = assessment.limit
    if not np.isfinite(limit.delay):
        return "no delay that all actuators have in common makes the loop unstable"
    changes = ", ".join(
        f"{name} {significant(value, 2)}"
        for name, value in zip(assessment.frame.partition.names, limit.direction.tolist(), strict=True)
    )
    return (
        f"unstable from a delay of {significant(MILLI * limit.delay)} ms of all actuators, at "
        f"{significant(limit.frequency)} Hz in the motion {changes}; margin "
        f"{significant(assessment.stability_margin or 0.0, 2)}"
    )


def _errors(assessment: FrameAssessment) -> Table:
    rows: list[tuple[str, ...]] = []
    for degree in assessment.error.displacements:
        if not degree.judged:
            rows.append((degree.name, "not judged", "", "", "", ""))
            continue
        probability = probability_text(assessment.error.probability_of(degree))
        rows.append((degree.name, *write_interval(degree.rms), *write_interval(degree.mte), probability))
    return text_table(
        rows,
        ("Displacement", "RMS error [%]", "90 % interval", "Largest error [%]", "90 % interval", "Below"),
        caption="Root mean square and largest value of measured minus exact displacement, over the peak of "
        f"the exact one. The last column is the probability of an error below "
        f"{percent(assessment.threshold)}.",
        label="tab:errors",
    )


def _parts(error: ErrorOfTest) -> Table:
    shares = {
        degree.name: (decimals_of_error(degree.rms), error.parts_of(degree).by_name)
        for degree in error.displacements
        if degree.judged
    }
    rows = [
        (
            part_in_words(cause),
            *(
                text
                for decimals, parts in shares.values()
                for text in (
                    f"{PERCENT * parts[cause].rms:.{decimals}f}",
                    f"{PERCENT * parts[cause].remaining_rms:.{decimals}f}",
                )
            ),
        )
        for cause in error.parts.by_name
    ]
    return text_table(
        rows,
        (
            "Part",
            *(text for name in shares for text in (f"RMS error of {name} [%]", "Without it [%]")),
        ),
        caption="RMS error that each part alone causes, and what would remain without it.",
        label="tab:parts",
    )


def _tracking(assessment: FrameAssessment) -> Table:
    gain, delay = assessment.error.rebuilt.readings.tracking
    rows = [
        (
            f"Actuator {number}",
            ", ".join(f"{value:.4f}" for value in gain[place]),
            ", ".join(f"{MILLI * value:.3f}" for value in delay[place]),
        )
        for place, number in enumerate(assessment.recording.actuators)
    ]
    return text_table(
        rows,
        ("", "Gain for each command", "Delay for each command [ms]"),
        caption="Response of each actuator to the commands of all actuators, by least squares over the "
        "whole test.",
        label="tab:tracking",
    )


_NINETY = 1.645  # standard deviations
_MARGIN = 0.25  # of the range of the values


@apply_style
def amplitude_and_delay_over_frequency(
    tracking: TrackingOverFrequency,
    *,
    amplitude: float,
    delay: float,
    modes: Sequence[float],
) -> Drawing:
    """Draw A(f) − 1 and d(f) with their 90 % bands, the index of the whole test, and the modes.

    `modes` [Hz].
    """
    figure, axes = panels(1, 2, height=58.0)
    rows = (
        (
            PERCENT * (tracking.amplitude - 1.0),
            PERCENT * tracking.amplitude_deviation,
            PERCENT * (amplitude - 1.0),
        ),
        (MILLI * tracking.delay, MILLI * tracking.delay_deviation, MILLI * delay),
    )
    names = "$A - 1$ [%]", "$d$ [ms]"
    for place, (values, deviations, test_value), name in zip(axes[0], rows, names, strict=True):
        ends = values - _NINETY * deviations, values + _NINETY * deviations
        place.fill_between(tracking.frequency, *ends, color=PALE, linewidth=0.0, label="90 % band")
        place.plot(tracking.frequency, values, color=BLUE, linewidth=0.9, label="over frequency")
        place.axhline(test_value, color=VERMILION, linewidth=0.9, linestyle="--", label="index of the test")
        for frequency in filter(tracking.covers, modes):
            place.axvline(frequency, color=GREY, linewidth=0.7, linestyle=":")
        heights = np.append(values, test_value)
        reach = _MARGIN * max(float(np.ptp(heights)), 0.02 * float(np.abs(heights).max()), 1e-3)
        place.set_ylim(float(heights.min()) - reach, float(heights.max()) + reach)
        place.set(xlabel="Frequency $f$ [Hz]", ylabel=name)
        place.margins(x=0.0)
    legend_below(figure, axes[0, 0], columns=3)
    return figure
