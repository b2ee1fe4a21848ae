"""Report of one measured test: two pages, to be filed with it."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from reliab.report.document import Column, Document, Figure, Paragraph, Points, Section, Table
from reliab.report.figures.measured_test import tracking_over_time, tracking_plane
from reliab.report.kinds.provenance import provenance_of
from reliab.report.kinds.wording import METHODS, PERCENT, error_below, percent, probability
from reliab.report.numbers import Fixed
from reliab.report.prose import Prose, prose
from reliab.report.sources import SOURCES
from reliab.validation.assessment.assess import LEVEL, Assessment

_MILLISECONDS = 1e3
_FAR = 10.0


def assessment_report(
    assessment: Assessment,
    *,
    title: str = "",
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
) -> Document:
    """Report the verdict on a test.

    Parameters
    ----------
    assessment : Assessment
        What was found, from :func:`reliab.validation.assessment.assess`.
    title : str, optional
        Title; the name of the test by default.
    provenance : mapping
        What the report can be made again from, by name: file, checksum, …
    notes : sequence of Prose, optional
        What the reader should know beside the assessment's own warnings.

    Returns
    -------
    Document
        A sheet of two pages.
    """
    sections = [
        Section(title="What was measured", blocks=(_numbers(assessment), _plane(assessment))),
        Section(title="What to improve", blocks=(Paragraph(text=_advice(assessment)),)),
        Section(title="What to know", blocks=(Points(items=(*_cautions(assessment), *notes)),)),
        Section(title="How it was judged", blocks=(Paragraph(text=_method(assessment)),)),
    ]
    if assessment.windows.centre.size:
        sections.insert(3, Section(title="Over the test", blocks=(_over_time(assessment),)))
    return Document(
        kind="Assessment of a real-time hybrid simulation",
        title=title or assessment.recording.name,
        verdict=_verdict(assessment),
        tone="good" if assessment.reliable else "bad",
        facts=_facts(assessment),
        blocks=tuple(sections),
        provenance=provenance_of(provenance, assessment.criterion.provenance),
        sources=SOURCES,
        sheet=True,
    )


def _verdict(found: Assessment) -> Prose:
    word = "reliable" if found.reliable else "not reliable"
    low, high = found.index_interval
    chance = found.probability
    likely = (
        "" if chance is None else f", and the probability that its error stays there is {probability(chance)}"
    )
    return (
        *prose("The test is *{word}*: its index is {index} ", word=word, index=_index(found.index)),
        f"({LEVEL:.0%} interval {_index(low)} to {_index(high)}".replace("%", " %"),
        "; reliable up to 1) for ",
        *error_below(found.criterion.metric, found.criterion.threshold),
        f"{likely}.",
    )


def _facts(found: Assessment) -> dict[str, Prose]:
    structure, recording = found.structure, found.recording
    basis = (
        f"the boundary of its own ground motion, {found.own.motion}"
        if found.own
        else f"{percent(found.criterion.confidence)} of the ground motions behind the criterion"
    )
    return {
        "Test": f"{recording.name}, {recording.duration:.1f} s at {1.0 / recording.time_step:.5g} Hz",
        "Structure": prose(
            "$f = {f:g}$ Hz, $xi = {xi:g}$, share of the stiffness in the laboratory $alpha = {alpha:g}$",
            f=structure.frequency,
            xi=structure.damping_ratio,
            alpha=structure.experimental_fraction,
        ),
        "Judged by": basis,
    }


def _numbers(found: Assessment) -> Table:
    tracking = found.tracking
    (low_a, high_a), (low_d, high_d) = tracking.interval(LEVEL)
    a, b = found.limits
    critical = _MILLISECONDS * found.critical_delay
    rows = [
        ("Amplitude A", f"{tracking.amplitude:.5f}", f"{low_a:.5f} to {high_a:.5f}", f"1 ± {np.sqrt(a):.5f}"),
        ("Equivalent delay d [ms]", *_milliseconds(tracking.delay, low_d, high_d), f"{np.sqrt(b):.3f}"),
        (
            "Index (A − 1)²/a + d²/b",
            _index(found.index),
            " to ".join(map(_index, found.index_interval)),
            "1",
        ),
        *_own(found),
        ("Equivalent frequency [Hz]", f"{tracking.plain.equivalent_frequency:.3f}", "", ""),
        (
            "Delay at which the loop is unstable [ms]",
            f"{critical:.2f}" if np.isfinite(critical) else "none",
            "",
            "",
        ),
        (
            "Share of it that is free [%]",
            Fixed(decimals=1, factor=PERCENT)(found.stability_margin).digits,
            "",
            "0 at least",
        ),
        ("Noise in the measured displacement [%]", f"{PERCENT * tracking.noise_share:.2f}", "", ""),
    ]
    frame = pd.DataFrame(rows, columns=["quantity", "value", "interval", "limit"])
    headings = ("Quantity", "Found", f"{LEVEL:.0%} interval".replace("%", " %"), "Limit")
    return Table(
        frame=frame,
        columns=tuple(
            Column(key=key, heading=heading, wide=key == "quantity")
            for key, heading in zip(frame.columns, headings, strict=True)
        ),
        caption=prose(
            "Indices of the test. The limit of $A$ is that of a test without delay, the limit of $d$ that of"
            " a test without amplitude error."
        ),
        label="tab:numbers",
    )


def _index(value: float) -> str:
    """Three decimals, or none where the index is far from its bound."""
    return Fixed(decimals=3 if value < _FAR else 0)(value).digits


def _milliseconds(value: float, low: float, high: float) -> tuple[str, str]:
    value, low, high = (_MILLISECONDS * each for each in (value, low, high))
    return f"{value:.3f}", f"{low:.3f} to {high:.3f}"


def _own(found: Assessment) -> list[tuple[str, str, str, str]]:
    if found.own is None:
        return []
    low, high = (PERCENT * each for each in found.own.error_interval)
    bound = f"{PERCENT * found.criterion.threshold:g}"
    row = (
        "Error under its own motion [%]",
        f"{PERCENT * found.own.error:.2f}",
        f"{low:.2f} to {high:.2f}",
        bound,
    )
    return [row]


def _plane(found: Assessment) -> Figure:
    boundaries = {
        f"{percent(found.criterion.confidence)} of motions": (found.population.a, found.population.b)
    }
    if found.own is not None:
        boundaries = {f"motion {found.own.motion}": (found.own.a, found.own.b), **boundaries}
    return Figure(
        drawing=tracking_plane(
            amplitude=found.tracking.amplitude,
            delay=found.tracking.delay,
            draws=found.tracking.draws,
            boundaries=boundaries,
        ),
        caption="The test is accepted inside the ellipse; the grey cloud is what noise leaves open.",
        label="fig:plane",
    )


def _over_time(found: Assessment) -> Figure:
    recording, windows = found.recording, found.windows
    return Figure(
        drawing=tracking_over_time(
            times=np.linspace(0.0, recording.duration, recording.command.size),
            command=recording.command,
            measured=recording.measured,
            centres=windows.centre,
            amplitude=windows.amplitude,
            amplitude_sd=windows.amplitude_sd,
            delay=windows.delay,
            delay_sd=windows.delay_sd,
        ),
        caption=prose(
            "Histories, and amplitude error and delay in windows of {length:.3g} s (bars: two standard "
            "deviations). A rig that behaves alike throughout shows no trend.",
            length=windows.length,
        ),
        label="fig:time",
    )


def _advice(found: Assessment) -> Prose:
    advice = found.improvement
    share = advice.share_of_delay if advice.first == "delay" else 1.0 - advice.share_of_delay
    late, off = _MILLISECONDS * advice.tolerable_delay, advice.tolerable_amplitude_error
    return " ".join(
        (
            f"{percent(share, 2)} of the index comes from the {advice.first}.",
            f"At its own amplitude the test is accepted up to a delay of {late:.2f} ms."
            if late > 0.0
            else "At its own amplitude the test is not accepted with any delay.",
            f"At its own delay it is accepted up to an amplitude error of {percent(off, 2)}."
            if off > 0.0
            else "At its own delay it is not accepted with any amplitude.",
        )
    )


def _cautions(found: Assessment) -> list[Prose]:
    own = () if found.own else found.criterion.provenance.warnings
    told: list[Prose] = [*found.warnings, *found.recording.notes, *own]
    return [
        *told,
        prose(
            "The verdict speaks of a linear structure and of errors that a gain and a delay describe; "
            "friction, backlash and saturation are not in $A$ and $d$."
        ),
    ]


def _method(found: Assessment) -> Prose:
    criterion = found.criterion
    meaning = METHODS.get(criterion.method, criterion.method)
    basis = (
        prose(
            "The error of a test with this gain and delay was simulated under its own ground motion and held"
            " against the bound."
        )
        if found.own
        else prose(
            "The limits $a$ and $b$ are those that {share} of ground motions exceed ({meaning}).",
            share=percent(criterion.confidence),
            meaning=meaning,
        )
    )
    return (
        *prose(
            "$A$ and $d$ are the amplitude and delay of the frequency-domain evaluation index @guo2014 "
            "between command and measured displacement, freed of the noise of the command and of the effect "
            "of the record's ends; intervals come from blocks of what they leave unexplained. The index $(A "
            "- 1)^2 \\/ a + d^2 \\/ b$ is that of @guo2017. "
        ),
        *basis,
    )
