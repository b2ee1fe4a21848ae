"""Report of one measured test: two pages, to be filed with it."""

from collections.abc import Mapping, Sequence

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.tracking_index import LEVEL
from reliab.core.significant_digits import percent, share_in_words, significant, value_and_interval
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.report.document import Document, Figure, Paragraph, Points, Section, Table, text_table
from reliab.report.figures.measured_test import tracking_overview
from reliab.report.kinds.assessment.error import (
    advice,
    budget_table,
    document_of_test,
    errors_table,
    histories_figure,
    remarks,
)
from reliab.report.numbers import MISSING, Fixed, Significant, WrittenNumber, write_in_line
from reliab.report.prose import Prose, prose
from reliab.report.sources import provenance_of
from reliab.report.wording import meaning_of_confidence, spell_out


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
        Section(title="What to improve", blocks=(Paragraph(text=advice(assessment)),)),
        Section(title="Amplitude and delay", blocks=(_numbers(assessment), _plane(assessment))),
        Section(title="How it was judged", blocks=(Paragraph(text=_method(assessment)),)),
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


def _cautions(assessment: Assessment) -> list[Prose]:
    warnings = () if assessment.placement else assessment.criterion.provenance.warnings
    return [
        *remarks(assessment, *warnings),
        prose(
            "The error is that of a linear structure with the stated properties, whatever the actuator did; "
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
