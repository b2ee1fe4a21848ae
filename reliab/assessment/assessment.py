"""What is found about a test: in numbers, as a table and as a plot, and what to read before relying on it."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from reliab.assessment.faults import FaultEffect
from reliab.assessment.findings import Findings
from reliab.assessment.plausibility import warn_of_signal
from reliab.assessment.recorded_force import doubts_of_force, remark_on_force
from reliab.assessment.verdict import Word
from reliab.core.significant_digits import percent, share_in_words, significant
from reliab.core.vocabulary import ERROR_NAMES, MILLI, Metric
from reliab.criterion.experimental_share import whole_is_worst

_SHAPE_CRITERION = "shape of the response"
_FAR_FROM_ONE = 0.2
_VARYING = 0.1  # share of a limit
_UNEXPLAINED_SHARE = 0.3  # share of the amplitude limit


def cautions(findings: Findings) -> tuple[str, ...]:
    """List what limits a verdict."""
    sentences = (
        sentence
        for group in (
            _warn_of_faults,
            _warn_of_error,
            _warn_of_assumptions,
            _warn_of_columns,
            _warn_of_force,
            _warn_of_signal,
            _warn_of_constancy,
            _warn_of_validity,
            _warn_of_scope,
            _warn_of_motion,
            _warn_of_contradictions,
        )
        for sentence in group(findings)
    )
    return tuple(dict.fromkeys([*findings.assumed, *sentences]))


def _warn_of_scope(findings: Findings) -> Iterator[str]:
    if findings.placement is None:
        yield from findings.scope.sentences
    if findings.speaks_for_none:
        yield (
            "The criterion promises nothing for such a test. The error of the test "
            "itself does not depend on it."
        )


def _warn_of_faults(findings: Findings) -> Iterator[str]:
    for effect in findings.faults:
        yield " ".join([effect.fault.finding, *_consequence(effect, findings)])


def _consequence(effect: FaultEffect, findings: Findings) -> Iterator[str]:
    if effect.otherwise is None:
        return
    metric = Metric(findings.criterion.metric)
    error, error_otherwise = findings.error.estimate(metric).value, effect.otherwise.estimate(metric).value
    name, fault = ERROR_NAMES[metric], effect.fault
    sizes = [percent(size, 2) for size in (error, error_otherwise)]
    if fault.in_loop is True:
        yield (
            f"The command responds to it, so that the structure felt it: the {name} is {sizes[0]} with it "
            f"and would be {sizes[1]} without."
        )
    elif fault.kind == "zero":
        yield (
            f"The {name} is {sizes[0]} from there; from the recorded zero it would be {sizes[1]}. State "
            "zeros in channels.toml if the structure rests elsewhere."
        )
    elif fault.in_loop is False:
        reason = (
            ""
            if fault.kind in ("spike", "held")
            else "The command does not respond to it, so that only the sensor reading is wrong. "
        )
        yield f"{reason}The {name} is {sizes[0]} without it; had the structure felt it, {sizes[1]}."
    else:
        yield f"The {name} is {sizes[0]} as recorded and {sizes[1]} without it."


def _warn_of_error(findings: Findings) -> Iterator[str]:
    yield from findings.equation.contradictions
    yield from findings.equation.notes
    error_verdict, index_word = findings.verdict, findings.verdict_by_index.word
    if Word.UNDECIDED in (error_verdict, index_word) or error_verdict is index_word or findings.index is None:
        return
    size = findings.error.estimate(Metric(findings.criterion.metric)).value
    basis = (
        f"{share_in_words(findings.promise, decimals=0)} of comparable ground motions"
        if findings.placement is None
        else "a gain and a delay alone"
    )
    reason = (
        f"{percent(findings.tracking.unexplained_share, 2)} of the rig's motion is neither gain nor delay"
        if findings.tracking.unexplained_share > _UNEXPLAINED_SHARE * float(np.sqrt(findings.limits[0]))
        else "this ground motion and length are more or less demanding than those"
    )
    yield (
        f"The error of this test ({percent(size, 2)}) and the index "
        f"({significant(findings.index)}, limit 1) "
        f"disagree: the index is for {basis}, and {reason}. The verdict follows the error."
    )


def _warn_of_assumptions(findings: Findings) -> Iterator[str]:
    yield from findings.turning.warnings(findings.judgement)


def _warn_of_columns(findings: Findings) -> Iterator[str]:
    tracking = findings.tracking
    yield from (doubt.finding for doubt in findings.column_doubts)
    if abs(tracking.amplitude - 1.0) > _FAR_FROM_ONE:
        yield (
            f"A = {tracking.amplitude:.4g} is far from 1. Check the units of command and measured "
            "displacement."
        )


def _warn_of_force(findings: Findings) -> Iterator[str]:
    yield from doubts_of_force(findings.recording)
    unknown = findings.error.specimen_known != "stated" or "alpha" in findings.equation.wrong
    if "mass" not in findings.stated or not unknown:
        sentence = remark_on_force(findings.recording, findings.structure, findings.stated)
        yield from (sentence,) if sentence else ()


def _warn_of_signal(findings: Findings) -> Iterator[str]:
    tracking = findings.tracking
    yield from warn_of_signal(findings.recording, tracking, findings.structure.frequency)
    limit = float(np.sqrt(findings.limits[0]))
    if tracking.unexplained_share > _UNEXPLAINED_SHARE * limit:
        yield (
            f"{percent(tracking.unexplained_share, 2)} of the measured motion is neither gain nor "
            f"delay, more than the tolerable amplitude error of {percent(limit, 2)}. Look for "
            "friction, backlash, saturation or slow noise; limits based on A and d may be off by 25 %."
        )


def _warn_of_constancy(findings: Findings) -> Iterator[str]:
    a, b = findings.limits
    windows = findings.windows
    late = MILLI * windows.delay_range
    if late > _VARYING * np.sqrt(b):
        first, last = (MILLI * delay for delay in (windows.delay.min(), windows.delay.max()))
        yield (
            f"The delay varies over the test, from {significant(first)} to {significant(last)} ms; A and d "
            "are averages. Check the compensator."
        )
    if windows.amplitude_range > _VARYING * np.sqrt(a):
        yield (
            f"The amplitude varies over the test, from A = {windows.amplitude.min():.4f} to "
            f"{windows.amplitude.max():.4f}; A is an average. Check the compensator."
        )


def _warn_of_validity(findings: Findings) -> Iterator[str]:
    structure, source_structure = findings.structure, findings.population.carried_from
    if source_structure is not None and findings.placement is None:
        yield (
            f"The criterion does not cover the structure ({structure.frequency:g} Hz, "
            f"ξ = {structure.damping_ratio:g}); its limits are scaled from those at "
            f"{source_structure[0]:g} Hz, "
            f"ξ = {source_structure[1]:g}. Give the `motion` of the test for exact ones."
        )
    if structure.experimental_fraction < 1.0 and findings.placement is None:
        whole_structure_is_worst = whole_is_worst(structure.frequency, structure.damping_ratio)
        judgement = (
            "it is conservative"
            if whole_structure_is_worst
            else "it may not be conservative outside of 0.5 to 3 Hz and 1 to 10 % damping"
        )
        yield (
            "The criterion is for a specimen with all of the stiffness (α = 1); for "
            f"α = {structure.experimental_fraction:g} {judgement}."
        )


def _warn_of_motion(findings: Findings) -> Iterator[str]:
    placement = findings.placement
    if placement is not None and placement.alignment.matched and placement.alignment.by == _SHAPE_CRITERION:
        yield (
            f"The response has the shape, but not the size of that under {placement.motion}. "
            "Check the scale of the record and the unit of the displacements."
        )


def _warn_of_contradictions(findings: Findings) -> Iterator[str]:
    yield from (contradiction.finding for contradiction in findings.contradictions)


class Assessment(Findings):
    """What is found about a test; see :class:`reliab.assessment.findings.Findings`."""

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings to read before relying on the verdict, in sentences."""
        return cautions(self)
