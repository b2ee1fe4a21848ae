"""What leaves the verdict on a test undecided: one check for each kind of doubt.

A check looks at a test that was judged by its error and yields doubts, each with its reason and its remedy.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.conflicts import FAR
from reliab.assessment.error_of_test import ErrorOfTest, error_of_test
from reliab.assessment.inference.posterior import favours_frequency
from reliab.assessment.judged_test import JudgedTest
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.tracking_index import TrackingIndex, is_noisier, power_of
from reliab.assessment.verdict import (
    Contradiction,
    Doubt,
    Verdict,
    Word,
    error_in_words,
    word_of_probability,
)
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import ERROR_NAMES, MILLI, Metric
from reliab.recordings.recording import Recording
from reliab.structures.parts_of_structure import is_of_entries

_NONLINEAR = (
    "State `specimen` as measured, with the `mass`: its behaviour is then learned from its recorded "
    "force; or give a model of it that `reliab diagnose` calibrated."
)
_NONLINEAR_OF_SEVERAL = (
    "State the stiffness that the specimen had in this test, with its deviation. A specimen that several "
    "actuators drive is not learned from its forces."
)
_NOISY = "Record with less noise, or drive the specimen further."
_ENTRIES = "State the natural frequencies as they were measured, in place of entries of a matrix."
_REMEDIES: Final = {
    "copy": "Export the test again, each channel from its own sensor.",
    "jump": "Export the test again, whole and alone: from its first motion to its end, without lost samples.",
    "force": "Find out which force the computer received, and export that one.",
}
"""What to do about faults without which the recording is not known."""
_CUT = "Cut the recording to the test, from its first motion to its end: the verdict depends on it."
_FIND_OUT = "Correct the recording, or find out whether the loop felt the fault, and assess the test again."
_STILL = 1e-3  # of the command's peak: what the command of a structure at rest stays below
_MOSTLY_MOVING = 0.7  # share of a recording in which the structure moves, above which it is no longer asked

_OFF_RESONANCE = (0.5, 1.7)
_PEAK = 8.0
"""Power at a natural frequency over that beside it, from which on a command shows its resonance: under real
records it was 5 to 350 for structures of 0.5 to 8 Hz, and 0.1 to 10 at frequencies that were not theirs."""

_RESONANCE_RATIOS, _LOWER_RATIOS, _UPPER_RATIOS = (
    (0.9, 1.1),
    (0.55, 0.8),
    (1.25, 1.8),
)  # of the natural frequency
_LEAD = 1e-5  # s
_RANGE_EXCESS = 0.1  # of the measured range, by which the exact response may leave it
_LATE = 5e-4  # s, by which a force may seem late


def verdict_of_error(error: ErrorOfTest) -> Verdict:
    """Judge a test by its own error alone; undecided where noise leaves nothing to be judged."""
    size = error.estimate(error.metric)
    if math.isnan(size.value):
        return Verdict(word=Word.UNDECIDED, reasons=error.not_judged, would_decide=(_NOISY,))
    word = word_of_probability(error.probability)
    name = ERROR_NAMES[error.metric]
    largest = f"{error.displacement_suffix}, the largest," if error.displacement_suffix else ""
    description = error_in_words(
        f"{name}{largest}", size, error.threshold, error.probability, show_interval=True
    )
    return Verdict(
        word=word,
        reasons=(f"{description}.",),
        would_decide=error.would_decide if word is Word.UNDECIDED else (),
    )


def check_frequency(test: JudgedTest) -> Iterator[Doubt]:
    """Compare the frequency of the motion with those of the structure.

    A command that moves mainly elsewhere and shows no resonance at a natural frequency belongs to another
    structure, unless the channels are no likelier with one that resonates there.
    """
    recording, tracking, question = test.sound, test.tracking, test.question
    if tracking is None or not question.linear:
        return
    frequencies = question.full_structure.modes[0].tolist()
    moves = tracking.plain.equivalent_frequency
    if moves_at_resonance(recording, tracking, frequencies):
        return
    inferred = test.error.inferred
    if inferred is not None and not favours_frequency(
        inferred.posterior, moves / question.structure.frequency
    ):
        return
    natural = " and ".join(f"{frequency:.4g}" for frequency in sorted({min(frequencies), max(frequencies)}))
    yield Contradiction(
        finding=f"The command moves mainly at {significant(moves)} Hz, the structure is stated at {natural} "
        "Hz, where the command shows no resonance: check the frequency and the unit of time.",
        remedy="State the natural frequency of the structure that was tested, or the file's unit of time.",
    )


def moves_at_resonance(recording: Recording, tracking: TrackingIndex, frequencies: list[float]) -> bool:
    """Whether the command moves near the natural frequencies [Hz], or shows their resonance."""
    low, high = _OFF_RESONANCE
    if low * min(frequencies) <= tracking.plain.equivalent_frequency <= high * max(frequencies):
        return True
    return any(_resonance(recording, frequency) >= _PEAK for frequency in frequencies)


def _resonance(recording: Recording, frequency: float) -> float:
    """Power of the command at a frequency over that below and above it."""
    power = power_of(recording.command)
    ratio = (np.arange(power.size) + 1.0) / (recording.command.size * recording.time_step * frequency)
    peak, lower, upper = (
        _mean(power[(low <= ratio) & (ratio <= high)])
        for low, high in (_RESONANCE_RATIOS, _LOWER_RATIOS, _UPPER_RATIOS)
    )
    surroundings = float(np.sqrt(lower * upper))
    return peak / surroundings if surroundings > 0.0 else 0.0


def _mean(values: NDArray[np.float64]) -> float:
    return float(values.mean()) if values.size else 0.0


def check_stability(test: JudgedTest) -> Iterator[Doubt]:
    """Compare the delay with the critical one."""
    if test.stability_margin is None or test.stability_margin <= 0.0:
        yield Contradiction(
            finding="The delay exceeds the critical one: the loop is unstable.",
            remedy="Reduce the delay, or find out why the loop was stable: the structure may not be as "
            "stated.",
        )


def check_motion(test: JudgedTest) -> Iterator[Doubt]:
    """Look for the test in the record of its stated ground motion."""
    placement = test.placement
    if placement is not None and not placement.alignment.matched:
        yield Contradiction(
            finding=f"The test was not found in the record of {placement.motion} (best similarity "
            f"{placement.alignment.match:.2f} of 1): the test may have had another motion, or another "
            "structure. Its beginning in the record is unknown; the index is that of the part, as long as "
            "the test, in which the structure moves most.",
            remedy="Give the ground motion of this test, or none if the structure is surely as stated.",
        )


def check_stated_values(test: JudgedTest) -> Iterator[Doubt]:
    """Compare what is stated of the structure and of the channels with what the channels show."""
    yield from test.equation.doubts


def check_specimen(test: JudgedTest) -> Iterator[Doubt]:
    """See how well a recorded force shows what the specimen does."""
    specimen = test.error.specimen
    if specimen is None:
        return
    if not specimen.learned:
        yield Contradiction(
            finding="None of the specimen models predicts its force: "
            f"{percent(specimen.held_out, decimals=0)} of it is not predicted on held-out parts of the "
            "test.",
            remedy="Repeat the test with less actuator error, record the force with less lag, or calibrate a "
            "model of the specimen with `reliab diagnose`.",
        )
    late = specimen.test.apparent_lag
    channels = test.error.rebuilt.inferred.sizes
    possible = math.hypot(late.deviation, channels.get("force_lag", 0.0), channels.get("time_shift", 0.0))
    if late.value > max(_LATE, FAR * possible):
        yield Contradiction(
            finding=f"The recorded force seems {significant(MILLI * late.value, 2)} ms later than the "
            "displacement: no specimen that stores and dissipates energy gives such a force.",
            remedy="Measure the lag of the force against the displacement, and state it: `force_channel` "
            "lag_ms.",
        )
    if specimen.beyond > _RANGE_EXCESS:
        yield Contradiction(
            finding=f"The exact response goes {percent(specimen.beyond, decimals=0)} beyond "
            f"the range in which the specimen was moved: its force was not measured there.",
            remedy="Repeat the test with less actuator error: the specimen is then driven over the range "
            "that matters.",
        )


def check_columns(test: JudgedTest) -> Iterator[Doubt]:
    """See whether the verdict would be another one if columns that may be swapped are."""
    sound, error = test.sound, test.error
    if not test.column_doubts:
        return
    swapped_test = replace(sound, command=sound.measured, measured=sound.command)
    probability = error_of_test(swapped_test, test.question).probability
    if word_of_probability(probability) is not word_of_probability(error.probability):
        yield from test.column_doubts


def doubts_of_columns(recording: Recording, tracking: TrackingIndex) -> Iterator[Contradiction]:
    """Say where command and measured displacement may be swapped.

    A command is computed, the other column is measured: where that one is far noisier, no lead means a swap.
    """
    remedy = "Find out which column is the command: the verdict depends on it."
    _, (_, latest) = tracking.interval(0.99)
    leads = tracking.delay < -_LEAD and latest < 0.0
    if leads and not is_noisier(recording.measured, recording.command):
        lead = -MILLI * tracking.delay
        yield Contradiction(
            finding=f"The measured displacement leads the command by {significant(lead)} ms: the columns "
            "may be swapped, or a compensator overcorrects.",
            remedy=remedy,
        )
    if is_noisier(recording.command, recording.measured):
        yield Contradiction(
            finding="The command is noisier than the measured displacement, though a command is computed "
            "and the other is measured: the columns may be swapped.",
            remedy=remedy,
        )


def check_linearity(test: JudgedTest) -> Iterator[Doubt]:
    """See whether an unrecorded force may be that of a specimen that yielded or hardened."""
    yield from test.turning.doubts(test.judgement, test.error.probability)


def check_rest(test: JudgedTest) -> Iterator[Doubt]:
    """See whether a test is reliable only because its recording is long before or after the motion.

    RMS^R is the mean over the whole recording, which says little where the structure rests in most of it.
    """
    error, recording = test.error, test.sound
    if error.metric is not Metric.RMS or test.judgement.word is not Word.RELIABLE:
        return
    commands = np.abs(np.atleast_2d(recording.command))
    moving = np.flatnonzero((commands > _STILL * commands.max(axis=1, keepdims=True)).any(axis=0))
    samples = int(moving[-1] - moving[0] + 1)
    share = samples / commands.shape[1]
    factor = 1.0 / math.sqrt(share)
    probability = error.rebuilt.draws.probability_below(error.threshold / factor, Metric.RMS)
    if share > _MOSTLY_MOVING or word_of_probability(probability) is Word.RELIABLE:
        return
    size = error.estimate(Metric.RMS)
    while_moving = Estimate(value=factor * size.value, low=factor * size.low, high=factor * size.high)
    reason = (
        f"The structure moves in {significant(samples * recording.time_step)} of "
        f"{significant(recording.duration)} s only. Over these seconds: "
        f"{error_in_words(ERROR_NAMES[Metric.RMS], while_moving, error.threshold, probability)}."
    )
    yield Doubt(finding=reason, remedy=_CUT)


def check_matrix_entries(test: JudgedTest) -> Iterator[Doubt]:
    """See whether the error is too large with one of the structures that uncertain entries allow.

    The error is largest with the natural frequency that a test near resonance really had. Entries leave it
    open, so that a 90 % interval holds too rarely where the test is too short to show it.
    """
    error = test.error
    is_learned = error.inferred is not None and bool(error.inferred.posterior.evidence)
    if (
        is_learned
        or test.judgement.word is not Word.RELIABLE
        or not any(map(is_of_entries, error.rebuilt.inferred.sizes))
    ):
        return
    largest = error.largest_drawn
    if largest <= error.threshold:
        return
    reason = (
        "Single entries of a matrix are uncertain, and for one of the structures within their tolerances "
        f"the error is {percent(largest, 2)}. Near resonance the error is largest at the "
        "structure's true frequency, which a test as short as this does not show."
    )
    yield Doubt(finding=reason, remedy=_ENTRIES)


def check_faults(test: JudgedTest) -> Iterator[Doubt]:
    """See whether the verdict depends on a fault of the recording."""
    word = test.judgement.word
    for effect in test.faults:
        fault = effect.fault
        if effect.otherwise is None:
            if word is Word.RELIABLE:
                yield Doubt(finding=fault.sentence, remedy=_REMEDIES[fault.kind])
        elif fault.in_loop is None and word_of_probability(effect.otherwise.probability) is not word:
            yield Doubt(
                finding=f"{fault.sentence} The verdict depends on it, and whether the structure felt it is "
                "not known.",
                remedy=_FIND_OUT,
                of_structure=True,
            )


def check_force(test: JudgedTest) -> Iterator[Doubt]:
    """See whether the recorded force is that of a linear specimen."""
    if test.equation.nonlinear:
        remedy = _NONLINEAR_OF_SEVERAL if test.recording.has_several else _NONLINEAR
        yield Doubt(finding=test.equation.nonlinear, remedy=remedy, of_structure=True)


CHECKS: Final[tuple[Callable[[JudgedTest], Iterator[Doubt]], ...]] = (
    check_frequency,
    check_stability,
    check_motion,
    check_stated_values,
    check_specimen,
    check_columns,
    check_linearity,
    check_rest,
    check_matrix_entries,
    check_faults,
    check_force,
)
"""All checks, in the order in which their reasons are told."""
