"""Where a recording contradicts what is stated of the test: its verdict is then undecided at best."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.tracking_index import TrackingIndex, is_noisier, power_of
from reliab.assessment.verdict import Contradiction
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording

if TYPE_CHECKING:
    from reliab.assessment.measured_specimen.rebuild import MeasuredSpecimen
    from reliab.assessment.own_motion import OwnPlacement

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


def contradict_frequency(
    recording: Recording, tracking: TrackingIndex, frequencies: Sequence[float]
) -> Iterator[Contradiction]:
    """Say where the command neither moves near the natural frequencies [Hz] nor shows their resonance."""
    moves = tracking.plain.equivalent_frequency
    low, high = _OFF_RESONANCE
    if low * min(frequencies) <= moves <= high * max(frequencies):
        return
    if any(_resonance(recording, frequency) >= _PEAK for frequency in frequencies):
        return
    natural = " and ".join(f"{frequency:.4g}" for frequency in sorted({min(frequencies), max(frequencies)}))
    yield Contradiction(
        finding=f"The command moves mainly at {significant(moves)} Hz, the structure is stated at {natural} "
        "Hz, where the command shows no resonance: check the frequency and the unit of time.",
        remedy="State the natural frequency of the structure that was tested, or the file's unit of time.",
    )


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


def contradict_specimen(specimen: "MeasuredSpecimen | None") -> Iterator[Contradiction]:
    """Say where the recorded force did not show well enough what the specimen does."""
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
    if specimen.late > _LATE:
        yield Contradiction(
            finding=f"The recorded force seems {significant(MILLI * specimen.late, 2)} ms later than the "
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


def contradict_stability(stability_margin: float | None) -> Iterator[Contradiction]:
    """Say where the loop would be unstable with the measured delay."""
    if stability_margin is None or stability_margin <= 0.0:
        yield Contradiction(
            finding="The delay exceeds the critical one: the loop is unstable.",
            remedy="Reduce the delay, or find out why the loop was stable: the structure may not be as "
            "stated.",
        )


def contradict_motion(placement: "OwnPlacement | None") -> Iterator[Contradiction]:
    """Say where the stated ground motion and structure do not give this test."""
    if placement is not None and not placement.alignment.matched:
        yield Contradiction(
            finding=f"The test was not found in the record of {placement.motion} (best similarity "
            f"{placement.alignment.match:.2f} of 1): the test may have had another motion, or another "
            "structure. Its beginning in the record is unknown; the index is that of the part, as long as "
            "the test, in which the structure moves most.",
            remedy="Give the ground motion of this test, or none if the structure is surely as stated.",
        )


def contradict_columns(recording: Recording, tracking: TrackingIndex) -> Iterator[Contradiction]:
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
