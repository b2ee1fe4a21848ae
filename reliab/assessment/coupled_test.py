"""The verdict on a test with several actuators, by the error of each interface displacement."""

from collections.abc import Mapping
from dataclasses import replace
from typing import TypedDict

import numpy as np

from reliab.arrays import Array
from reliab.assessment.budget import (
    Equipment,
    Size,
    Source,
    as_certain_as,
    budget_of_error,
    sizes_of_structure,
    sizes_of_unknown,
    tolerances_of,
)
from reliab.assessment.coupled_assessment import CoupledAssessment, lost_in_noise
from reliab.assessment.coupled_error import (
    CoupledError,
    ShownByGround,
    compare_with_ground,
    rebuild_coupled,
)
from reliab.assessment.doubts import ERROR_NAMES, doubted_by_entries, probability_text
from reliab.assessment.error_of_test import with_learned
from reliab.assessment.exact_response import exact_test_of_several
from reliab.assessment.faults import Fault, find_faults, repaired
from reliab.assessment.frame_responses import errors_of_responses
from reliab.assessment.plausibility import require_length, require_plausible
from reliab.assessment.tracking_index import track
from reliab.assessment.verdict import Verdict, Word, word_of_probability
from reliab.errors import InputError
from reliab.motions import Motion
from reliab.recordings import CoupledRecording, without_spikes
from reliab.significant import percent, significant
from reliab.simulation.frames import FrameUnderTest
from reliab.stated_value import StatedValue
from reliab.structures import Partition, StabilityLimit, Structure, is_part, stability_limit
from reliab.vocabulary import MILLI, Metric

_FEW_DRAWS = 2
_LEAST_SHARE = 1e-6
_SMALL_MOTION = 0.02  # of the largest command: below it, faults of a channel cannot be told from coupling


def assess_coupled(
    recording: CoupledRecording,
    frame: FrameUnderTest,
    *,
    threshold: float = 0.05,
    metric: Metric = Metric.RMS,
    stated: Mapping[str, StatedValue] | None = None,
    equipment: Equipment | None = None,
    motion: Motion | None = None,
) -> CoupledAssessment:
    """Judge a test with several actuators by the errors computed from its displacements.

    `threshold` [-]; `stated`: "feedback_lag" [ms], of all displacement sensors alike the "scale" [-], and the
    deviations of what the recording was corrected for; `equipment`: what is not known where neither
    tolerances nor `stated` have it, nothing by default; `motion`: the ground motion by which errors of floors
    and storeys are stated over their own peaks, by default the recorded one. Raises InputError where the
    recording does not fit the frame or cannot be judged.
    """
    recording = _in_order(recording, frame)
    stated = stated or {}
    scale = stated.get("scale", StatedValue(1.0)).value
    recording = replace(recording, measured=recording.measured / scale)
    recording, faults = _without_faults(recording, frame, threshold)
    sizes = {
        **sizes_of_unknown(stated, _lowest_mode(frame), equipment, recording.time_step),
        **sizes_of_structure(frame),
    }
    error = rebuild_coupled(
        recording.command,
        recording.measured,
        recording.time_step,
        frame.partition,
        to_interface=frame.to_interface,
        feedback_lag=stated.get("feedback_lag", StatedValue(0.0)).value / MILLI,
        tolerances=tolerances_of(sizes),
    )
    shown = _shown_by_ground(error, recording.ground)
    gains = frame.to_interface @ error.parts.gain @ np.linalg.inv(frame.to_interface)
    return CoupledAssessment(
        recording=recording,
        frame=frame,
        error=error,
        metric=metric,
        threshold=threshold,
        faults=faults,
        sizes=with_learned(sizes, error.unknown.own_frequency),
        doubt_of_skew=_doubt_of_skew(equipment, stated, recording.time_step),
        responses=errors_of_responses(exact_test_of_several(error, recording), motion),
        shown_by_ground=shown,
        verdict=_verdict(error, metric, threshold, sizes, faults).doubted(
            *_doubts_of_ground(shown, sizes, frame.partition)
        ),
        **_limit(frame.partition, gains),
    )


def _doubt_of_skew(equipment: Equipment | None, stated: Mapping[str, StatedValue], step: float) -> str:
    return "" if equipment is None or "skew" in stated else equipment.doubt_of_skew(step)


def _shown_by_ground(error: CoupledError, ground: Array | None) -> ShownByGround | None:
    return None if ground is None else compare_with_ground(error.histories, error.structure, ground)


def _doubts_of_ground(
    shown: ShownByGround | None, sizes: Mapping[str, Size], partition: Partition
) -> tuple[list[str], list[str]]:
    """Say where the ground motion contradicts the structure, and what to do."""
    if shown is None:
        return [], []
    if shown.other:
        doubt = (
            f"The recorded ground acceleration leaves {percent(shown.misfit)} of the response unexplained: "
            "it does not belong to this test, or its structure is another one."
        )
        remedy = "Check channel and unit of the ground acceleration, and the description of the structure."
        return [doubt], [remedy]
    if not shown.contradicts(_stated_of_frequency(sizes, partition)):
        return [], []
    lowest = float(partition.natural_frequencies[0])
    scatter = f"{significant(shown.frequency * lowest, 4)} ± {significant(shown.deviation * lowest, 1)} Hz"
    doubt = (
        f"The recorded ground motion shows a lowest natural frequency of {scatter}; "
        f"{significant(lowest, 4)} Hz follows from the structure as stated."
    )
    return [doubt], ["Correct stiffness or mass of the structure, or state their tolerances."]


def _stated_of_frequency(sizes: Mapping[str, Size], partition: Partition) -> float:
    """Relative standard deviation of the lowest natural frequency that follows from what is stated."""
    lowest = float(partition.natural_frequencies[0])
    stated = {name: size.deviation for name, size in sizes.items() if size.source is Source.STATED}
    of_parts = [
        float(partition.with_parts({name: deviation}).natural_frequencies[0]) / lowest - 1.0
        for name, deviation in stated.items()
        if is_part(name)
    ]
    return float(np.linalg.norm([stated.get("frequency", 0.0), *of_parts]))


class _Limit(TypedDict):
    limit: StabilityLimit
    limit_of_gains: bool


def _limit(partition: Partition, gains: Array) -> _Limit:
    """Where the test becomes unstable with the measured gains; with exact ones where it would be at once."""
    try:
        return {"limit": stability_limit(partition, gains), "limit_of_gains": True}
    except InputError:
        return {"limit": stability_limit(partition), "limit_of_gains": False}


def _in_order(recording: CoupledRecording, frame: FrameUnderTest) -> CoupledRecording:
    """Put channels that have the names of the degrees of freedom into their order."""
    names, numbers = frame.partition.names, recording.actuators
    if len(numbers) != len(names):
        raise InputError(
            "A test must have a command and a measured displacement for each actuator",
            value=f"those of {', '.join(numbers)} for {len(names)} actuators",
            remedy="Name the columns command_1, measured_1, command_2, …",
            where=recording.name,
        )
    require_length(recording.of_actuator(_most_moved(recording)), float(_slowest(frame)))
    if frame.channels_at_interface and set(numbers) == set(names) and numbers != names:
        order = [numbers.index(name) for name in names]
        return replace(
            recording, command=recording.command[order], measured=recording.measured[order], actuators=names
        )
    return recording


def _most_moved(recording: CoupledRecording) -> int:
    return int(np.argmax(np.ptp(recording.command, axis=1)))


def _slowest(frame: FrameUnderTest) -> float:
    return float(frame.partition.natural_frequencies[0])


def _without_faults(
    recording: CoupledRecording, frame: FrameUnderTest, threshold: float
) -> tuple[CoupledRecording, tuple[tuple[str, Fault], ...]]:
    """Repair what the loop cannot have felt, and name all faults; channels that hardly move have none."""
    command, measured = recording.command.copy(), recording.measured.copy()
    largest = np.ptp(command, axis=1).max()
    shares = frame.partition.shares_at_sensors(frame.to_interface)
    faults: list[tuple[str, Fault]] = []
    for place, number in enumerate(recording.actuators):
        if not np.ptp(command[place]) > _SMALL_MOTION * largest:
            continue
        one = recording.of_actuator(place)
        require_plausible(one)
        bridged, *_ = without_spikes(one)
        of_channel = find_faults(
            one,
            track(bridged, draws=_FEW_DRAWS),
            threshold=threshold,
            experimental_fraction=float(shares[place]),
        )
        sound = repaired(one, [fault for fault in of_channel if fault.in_loop is False])
        command[place], measured[place] = sound.command, sound.measured
        faults += [(number, fault) for fault in of_channel]
    command, measured = frame.straightened(command), frame.straightened(measured)
    return replace(recording, command=command, measured=measured), tuple(faults)


def _lowest_mode(frame: FrameUnderTest) -> Structure:
    """Lowest mode, whose share of the specimen stands for that of the structure."""
    frequency, ratio, _ = frame.partition.modes
    return Structure(
        frequency=float(frequency[0]),
        damping_ratio=float(ratio[0]),
        experimental_fraction=float(np.clip(frame.partition.stiffness_shares[0], _LEAST_SHARE, 1.0)),
    )


def _verdict(
    error: CoupledError,
    metric: Metric,
    threshold: float,
    sizes: Mapping[str, Size],
    faults: tuple[tuple[str, Fault], ...],
) -> Verdict:
    governing = error.governing(metric)
    if governing is None:
        return Verdict(
            word=Word.UNDECIDED,
            reasons=tuple(lost_in_noise(degree) for degree in error.degrees),
            would_decide=("Record with less noise, or drive the specimen further.",),
        )
    size = governing.estimate(metric)
    probability = as_certain_as(sizes, error.probability(threshold, metric))
    word = word_of_probability(probability)
    reason = (
        f"{ERROR_NAMES[metric]} of {governing.name}, the largest, is {percent(size.value, decimals=2)}, 90 % "
        f"interval {percent(size.low, decimals=2)} to {percent(size.high, decimals=2)}, against a threshold "
        f"of {percent(threshold)}: probability {probability_text(probability)} of staying below it."
    )
    remedy = budget_of_error(error.widenings(metric), sizes)[0].remedy
    verdict = Verdict(word=word, reasons=(reason,), would_decide=(remedy,) if word is Word.UNDECIDED else ())
    largest = np.max([degree.draws.errors(metric) for degree in error.judged], axis=0)
    learned = error.unknown.own_frequency is not None
    verdict = doubted_by_entries(verdict, sizes, largest, threshold, learned=learned)
    doubts = [f"Actuator {number}: {fault.finding}" for number, fault in faults if fault.in_loop is None]
    return verdict.doubted(doubts, ["Repair the channel: the verdict may depend on it."] if doubts else [])
