"""The verdict by the error of the test, and what makes it undecided."""

import math
from collections.abc import Iterator

import numpy as np

from reliab.assessment.error_with_threshold import ErrorWithThreshold
from reliab.assessment.fault_effects import FaultEffect
from reliab.assessment.own_equation import OwnEquation
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.tracking_index import TrackingIndex
from reliab.assessment.verdict import (
    Verdict,
    Word,
    error_in_words,
    word_of_probability,
)
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import ERROR_NAMES, Metric
from reliab.recordings.coupled_recording import CoupledRecording
from reliab.recordings.recording import Recording
from reliab.structures.parts_of_structure import is_of_entries

_NONLINEAR = (
    "State `specimen` as measured, with the `mass`: its behaviour is then learned from its recorded "
    "force; or give a model of it that `reliab diagnose` calibrated."
)
_NOISY = "Record with less noise, or drive the specimen further."
_ENTRIES = "State the natural frequencies as they were measured, in place of entries of a matrix."
_COPY_REMEDY = "Export the test again, each channel from its own sensor."
_JUMP_REMEDY = (
    "Export the test again, whole and alone: from its first motion to its end, without lost samples."
)
_CUT = "Cut the recording to the test, from its first motion to its end: the verdict depends on it."
_STILL = 1e-3  # of the command's peak: what the command of a structure at rest stays below
_FEW_PERIODS = 10.0
_FEW_SAMPLES = 20.0  # of a period
_LARGEST_NOISE = 0.05  # of the measured displacement
_MOSTLY_MOVING = 0.7  # share of a recording in which the structure moves, above which it is no longer asked


def verdict_of_error(
    error: ErrorWithThreshold,
    effects: tuple[FaultEffect, ...],
    equation: OwnEquation | None = None,
) -> Verdict:
    """Judge a test by its own error.

    Returns undecided where the interval contains the threshold, where a fault of the recording would change
    the verdict, and where noise leaves nothing to be judged.
    """
    equation = equation or OwnEquation()
    size = error.estimate(error.metric)
    if math.isnan(size.value):
        return Verdict(word=Word.UNDECIDED, reasons=error.not_judged, would_decide=(_NOISY,))
    word = word_of_probability(error.probability)
    name = ERROR_NAMES[error.metric]
    largest = f"{error.displacement_suffix}, the largest," if error.displacement_suffix else ""
    description = error_in_words(
        f"{name}{largest}", size, error.threshold, error.probability, show_interval=True
    )
    reason = f"{description}."
    verdict = Verdict(
        word=word,
        reasons=(reason,),
        would_decide=error.would_decide if word is Word.UNDECIDED else (),
    )
    reasons, remedies = _doubts(effects, word)
    if equation.nonlinear:
        reasons.append(equation.nonlinear)
        remedies.append(_NONLINEAR)
    return verdict.add_doubts(reasons, remedies)


def doubts_of_signal(recording: Recording, tracking: TrackingIndex, frequency: float) -> Iterator[str]:
    """Say where a recording is too short, coarse or noisy for its structure; `frequency` [Hz]."""
    periods = recording.duration * frequency
    if periods < _FEW_PERIODS:
        yield (
            f"The test is short: {significant(periods, 2)} periods of the structure. "
            "Give the whole recording."
        )
    samples = 1.0 / (recording.time_step * tracking.plain.equivalent_frequency)
    if samples < _FEW_SAMPLES:
        yield (
            f"The test is sampled coarsely: {significant(samples)} samples in a period. "
            "Record at a higher rate."
        )
    noise = float(np.sqrt(max(tracking.noise_share**2 - tracking.unexplained_share**2, 0.0)))
    if noise > _LARGEST_NOISE:
        yield (
            f"The test is noisy: {percent(noise, decimals=1)} of the measured displacement is unrelated "
            "to the command. Use a sensor with less noise, or drive the specimen further."
        )


def doubt_rest(
    verdict: Verdict, error: ErrorWithThreshold, recording: Recording | CoupledRecording
) -> Verdict:
    """Call no test reliable that is so only because its recording is long before or after the motion.

    RMS^R is the mean over the whole recording, which says little where the structure rests in most of it.
    """
    if error.metric is not Metric.RMS or verdict.word is not Word.RELIABLE:
        return verdict
    commands = np.abs(np.atleast_2d(recording.command))
    moving = np.flatnonzero((commands > _STILL * commands.max(axis=1, keepdims=True)).any(axis=0))
    samples = int(moving[-1] - moving[0] + 1)
    share = samples / commands.shape[1]
    factor = 1.0 / math.sqrt(share)
    probability = float(np.mean(error.rebuilt.errors(Metric.RMS) * factor <= error.threshold))
    if share > _MOSTLY_MOVING or word_of_probability(probability) is Word.RELIABLE:
        return verdict
    size = error.estimate(Metric.RMS)
    while_moving = Estimate(value=factor * size.value, low=factor * size.low, high=factor * size.high)
    reason = (
        f"The structure moves in {significant(samples * recording.time_step)} of "
        f"{significant(recording.duration)} s only. Over these seconds: "
        f"{error_in_words(ERROR_NAMES[Metric.RMS], while_moving, error.threshold, probability)}."
    )
    return verdict.add_doubts([reason], [_CUT])


def doubt_entries(verdict: Verdict, error: ErrorWithThreshold) -> Verdict:
    """Call no test reliable of which a structure that stated entries allow has too large an error.

    The error is largest with the natural frequency that a test near resonance really had. Entries leave it
    open, so that a 90 % interval holds too rarely where the test is too short to show it.
    """
    is_learned = error.inferred is not None and bool(error.inferred.posterior.evidence)
    if (
        is_learned
        or verdict.word is not Word.RELIABLE
        or not any(map(is_of_entries, error.rebuilt.inferred.sizes))
    ):
        return verdict
    largest = error.largest_drawn
    if largest <= error.threshold:
        return verdict
    reason = (
        "Single entries of a matrix are uncertain, and for one of the structures within their tolerances "
        f"the error is {percent(largest, 2)}. Near resonance the error is largest at the "
        "structure's true frequency, which a test as short as this does not show."
    )
    return verdict.add_doubts([reason], [_ENTRIES])


def _doubts(effects: tuple[FaultEffect, ...], word: Word) -> tuple[list[str], list[str]]:
    reasons, remedies = [], []
    for effect in effects:
        if effect.otherwise is None:
            if word is Word.RELIABLE:
                reasons.append(effect.fault.sentence)
                remedies.append(_JUMP_REMEDY if effect.fault.kind == "jump" else _COPY_REMEDY)
            continue
        if effect.fault.in_loop is None and word_of_probability(effect.otherwise.probability) is not word:
            reasons.append(
                f"{effect.fault.sentence} The verdict depends on it, and whether the structure felt it is "
                "not known."
            )
            remedies.append(
                "Correct the recording, or find out whether the loop felt the fault, and assess the test "
                "again."
            )
    return reasons, remedies
