"""Faults of a recording that A and d do not show: zeros, offset, drift, spikes, jumps, standstill, copies.

Each fault is stated with the recording as it would be without it, so that its effect on the error of the test
can be computed. Whether the loop felt an offset shows in the command: a constant error of the restoring force
shifts the structure's mean position.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.error_of_test import ErrorOfTest, Question, error_of_test
from reliab.assessment.tracking_index import TrackingIndex, track
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult
from reliab.core.significant_digits import percent, significant
from reliab.core.vocabulary import MILLI
from reliab.recordings.behaviour import remove_spikes, zero_of
from reliab.recordings.recording import Recording
from reliab.signals.cubic_path import CubicPath

COPY_TOLERANCE: Final = 1e-6
"""Largest difference of a copied channel, over the command's peak [-]; sensors are noisier."""

_FEWEST_BLOCKS, _MOST_BLOCKS = 6, 40
_PERIODS_OF_A_BLOCK = 2.0
_SIGNIFICANT = 4.0  # standard errors
_STANDSTILL_SHARE = 0.05  # of the command's peak
_STANDSTILL_STEP = 1e-9  # of the peak: a smaller step between samples counts as standstill
_LOOP_RANGE, _SENSOR_RANGE = (0.7, 1.3), (-0.3, 0.3)
_LARGEST_HELD_SHARE, _LONGEST_HELD_RUN = 0.2, 4  # share of the samples, and samples in a row
_ROUNDING_FACTOR, _CHANCE_FACTOR = (
    1.5,
    3.0,
)  # of the smallest step; so many more repeats than smallest steps are not chance
_LEAST_SHARE = 0.1  # of the threshold: an offset or drift below which nothing is said
_NEIGHBOUR_STEPS, _ISOLATION_FACTOR = (
    16,
    4.0,
)  # steps on each side of a jump, and how much larger than all of them it is
_LEAST_JUMP = 0.02  # of the command's peak


@dataclass(frozen=True, kw_only=True, eq=False)
class Fault:
    """A fault of a recording."""

    kind: str  # What it is
    finding: str  # What was found, a sentence
    # in_measured, in_command: What it added to the measured displacement and to the command [m], shape (n,);
    # None where it left a channel as it was, or where nothing can be known of it
    in_measured: Array | None = None
    in_command: Array | None = None
    # Whether the loop felt it: False for spikes, which no actuator follows; otherwise decided from the
    # command; None where the command does not show it
    in_loop: bool | None = None
    # size, deviation: Estimate of an offset or drift and its standard error [m]
    size: float = 0.0
    deviation: float = 0.0
    # actuator, place: Number of the actuator whose channels have it, and its place, among several; then
    # `in_measured` and `in_command` have shape (p, n)
    actuator: str = ""
    place: int = 0

    def assign_actuator(self, place: int, recording: Recording) -> "Fault":
        """Give the same fault as one of the channels of several actuators."""

        def among_all(channel_error: Array | None) -> Array | None:
            if channel_error is None:
                return None
            rows = np.zeros_like(recording.command)
            rows[place] = channel_error
            return rows

        return replace(
            self,
            in_measured=among_all(self.in_measured),
            in_command=among_all(self.in_command),
            actuator=recording.actuators[place],
            place=place,
        )

    def name_quantity(self, quantity: str) -> str:
        """Name what an offset or drift leaves unknown of its sensor, such as "open_offset_2"."""
        return f"{quantity}_{self.kind}_{self.place + 1}" if self.actuator else f"{quantity}_{self.kind}"

    @property
    def sentence(self) -> str:
        """What was found, with the actuator if there are several."""
        return f"Actuator {self.actuator}: {self.finding}" if self.actuator else self.finding

    @property
    def repairable(self) -> bool:
        """Whether the recording without it is known."""
        return self.in_measured is not None or self.in_command is not None


def repair_recording(recording: Recording, faults: Iterable[Fault]) -> Recording:
    """Remove faults from a recording."""
    command, measured_displacement = recording.command, recording.measured
    for fault in faults:
        command = command if fault.in_command is None else command - fault.in_command
        measured_displacement = (
            measured_displacement if fault.in_measured is None else measured_displacement - fault.in_measured
        )
    return replace(recording, command=command, measured=measured_displacement)


def faults_of_channel(
    recording: Recording,
    *,
    threshold: float,
    experimental_fraction: float,
    seed: int = 0,
) -> tuple[tuple[Fault, ...], TrackingIndex]:
    """Look for faults of a recording beside the gain and delay that it shows without spikes.

    Where the command's mean is the answer of the loop to an offset of the sensor, that is its zero.
    `threshold`, `experimental_fraction` [-]. Returns the faults, and how the
    recording tracked but for its spikes.
    """
    look = partial(
        _faults_about,
        threshold=threshold,
        experimental_fraction=experimental_fraction,
        seed=seed,
    )
    faults_as_recorded = look(recording)
    zero_faults = tuple(_other_zero(recording))
    loop_answers = any(fault.kind == "offset" and fault.in_loop for fault in faults_as_recorded[0])
    return (
        faults_as_recorded
        if loop_answers or not zero_faults
        else look(repair_recording(recording, zero_faults), zero_faults)
    )


def _faults_about(
    recording: Recording,
    zero_faults: tuple[Fault, ...] = (),
    *,
    threshold: float,
    experimental_fraction: float,
    seed: int,
) -> tuple[tuple[Fault, ...], TrackingIndex]:
    """Look for faults of a recording from which another zero was taken, if it was moved."""
    clean, *spike_masks = remove_spikes(recording)
    tracking = track(clean, seed=seed)
    prediction = _read_late(clean.command, tracking.amplitude, tracking.delay, clean.time_step)
    faults = (
        *_spikes(recording, clean, *spike_masks),
        *_copy(clean),
        *zero_faults,
        *_jumps(clean),
        *_find_held_samples(clean),
        *_standstill(clean),
        *_slow(clean, prediction, threshold, experimental_fraction, tracking),
    )
    return faults, tracking


def faults_of_force(recording: Recording) -> Iterator[Fault]:
    """Find forces that stand still while the specimen turns back, as of a saturated load cell.

    A specimen that yields or slips unloads as soon as the motion turns; one with a gap or a slack cable has
    no force there, which comes and goes without a jump.
    """
    if recording.force is None:
        return
    rows = zip(*(np.atleast_2d(row) for row in (recording.force, recording.measured)), strict=True)
    for place, (force, displacement) in enumerate(rows):
        peak, moves = float(np.abs(force).max()), float(np.abs(displacement).max())
        runs = _runs(np.abs(np.diff(force)) <= _STANDSTILL_STEP * peak)
        ends, (low, high) = displacement[runs], _extremes(displacement, runs)
        turns = np.maximum(high - ends.max(axis=1), ends.min(axis=1) - low)  # beyond both ends
        around = np.clip(runs + np.array([-1, 1]), 0, force.size - 1)
        levels = np.abs(force[np.hstack([around, runs])]).max(axis=1)
        is_fault = (turns > _STANDSTILL_SHARE * moves) & (levels > _STANDSTILL_SHARE * peak)
        if is_fault.any():
            share = percent(turns[is_fault].max() / moves, decimals=0)
            yield Fault(
                kind="force",
                finding=f"The recorded force {_standing_in_words(runs[is_fault], recording.time_step)}, "
                f"while the displacement turns back by {share} of its peak, as if the load cell were "
                "saturated or disconnected: the force was not used.",
                actuator=recording.actuators[place] if recording.has_several else "",
                place=place,
            )


def plain_faults(recording: Recording) -> tuple[Fault, ...]:
    """Look for faults that show without any model of the rig: spikes, and one channel exported twice."""
    clean, *spike_masks = remove_spikes(recording)
    return *_spikes(recording, clean, *spike_masks), *_copy(clean)


def _other_zero(recording: Recording) -> Iterator[Fault]:
    """Find that both channels count from another zero than the structure, as strokes of a piston do."""
    zero = zero_of(recording.command)
    if zero:
        span = float(np.ptp(recording.command))
        yield Fault(
            kind="zero",
            finding="The command oscillates about another value than zero, by "
            f"{percent(abs(zero) / span)} of its span: that value was taken as the position of rest, and "
            "subtracted from both channels.",
            in_command=np.full_like(recording.command, zero),
            in_measured=np.full_like(recording.measured, zero),
            in_loop=False,
        )


def _jumps(recording: Recording) -> Iterator[Fault]:
    """Find steps of the command that no computed displacement takes, beside those next to them."""
    command = recording.command
    steps = np.abs(np.diff(command))
    padded_steps = np.pad(steps, _NEIGHBOUR_STEPS)
    windows = np.lib.stride_tricks.sliding_window_view(padded_steps, _NEIGHBOUR_STEPS)
    neighbours = np.maximum(windows[: steps.size].max(axis=1), windows[_NEIGHBOUR_STEPS + 1 :].max(axis=1))
    least = _LEAST_JUMP * float(np.abs(command).max())
    jumps = np.flatnonzero((steps > _ISOLATION_FACTOR * neighbours) & (steps > least))
    if jumps.size:
        place = int(jumps[np.argmax(steps[jumps])]) + 1
        size = float(steps[place - 1]) / float(np.abs(command).max())
        yield Fault(
            kind="jump",
            finding=f"The command jumps by {percent(size)} of its peak at "
            f"{place * recording.time_step:.4g} s, which no computed displacement does: samples were lost "
            "there, or the recording goes on after the end of the test.",
        )


def _read_late(history: Array, gain: float, delay: float, time_step: float) -> Array:
    """Give a history with a gain [-] and a delay, which may be negative [s]."""
    path = CubicPath.interpolate(np.arange(history.size) * time_step, history)
    return gain * path.read_delayed(delay)


def _spikes(
    recording: Recording,
    clean: Recording,
    command_spikes: NDArray[np.bool_],
    measured_spikes: NDArray[np.bool_],
) -> Iterator[Fault]:
    peak = float(np.abs(clean.command).max())
    channels = (
        ("command", command_spikes, recording.command - clean.command),
        ("measured displacement", measured_spikes, recording.measured - clean.measured),
    )
    for name, is_spike, spikes in channels:
        if is_spike.any():
            first = int(np.flatnonzero(is_spike)[0]) * recording.time_step
            lasting = MILLI * int(is_spike.sum()) * recording.time_step
            size = float(np.abs(spikes).max()) / peak
            yield Fault(
                kind="spike",
                finding=(
                    f"The {name} jumps and returns within {significant(lasting)} ms in all, first at "
                    f"{first:.4g} s, "
                    f"by up to {percent(size, decimals=1)} of the command's peak: no actuator moves "
                    "like that."
                ),
                in_command=spikes if name == "command" else None,
                in_measured=None if name == "command" else spikes,
                in_loop=False,
            )


def _copy(recording: Recording) -> Iterator[Fault]:
    peak = float(np.abs(recording.command).max())
    if float(np.abs(recording.measured - recording.command).max()) <= COPY_TOLERANCE * peak:
        yield Fault(
            kind="copy",
            finding=(
                "Command and measured displacement are identical, which sensor readings never "
                "are: was one channel exported twice?"
            ),
        )


def _standstill(recording: Recording) -> Iterator[Fault]:
    peak = float(np.abs(recording.command).max())
    channels = {"command": recording.command, "measured displacement": recording.measured}
    for name, counterpart in zip(channels, reversed(channels.values()), strict=True):
        runs = _runs(np.abs(np.diff(channels[name])) <= _STANDSTILL_STEP * peak)
        low, high = _extremes(counterpart, runs)
        is_fault = high - low > _STANDSTILL_SHARE * peak
        if is_fault.any():
            motion = (high - low)[is_fault].max() / peak
            missing = _missing_motion(recording, channels[name], runs[is_fault])
            yield Fault(
                kind="standstill",
                finding=f"The {name} {_standing_in_words(runs[is_fault], recording.time_step)}, while the "
                f"other channel moves by {percent(motion, decimals=0)} of the command's peak: either the "
                "actuator stood still, or the recording did.",
                in_command=missing if name == "command" else None,
                in_measured=None if name == "command" else missing,
            )


def _standing_in_words(runs: NDArray[np.int64], time_step: float) -> str:
    """Say for how long a channel stands still, and from when on."""
    lasting, first = np.diff(runs).sum() * time_step, runs[0, 0] * time_step
    return f"stands still for {significant(lasting)} s, first at {first:.4g} s"


def _extremes(history: Array, runs: NDArray[np.int64]) -> tuple[Array, Array]:
    """Smallest and largest value of a channel in each stretch, shape (k,) each."""
    padded, edges = np.append(history, 0.0), (runs + np.array([0, 1])).ravel()
    return np.minimum.reduceat(padded, edges)[::2], np.maximum.reduceat(padded, edges)[::2]


def _missing_motion(recording: Recording, history: Array, still: NDArray[np.int64]) -> Array:
    """Give a channel less its motion by the other one where it stands still, and zero elsewhere [m].

    Gain and delay are those of the rest of the test.
    """
    step, is_still = recording.time_step, np.isin(history, history[still[:, 0]])
    motion = np.stack([recording.command, np.gradient(recording.command, step)], axis=1)
    gain, slope = np.linalg.lstsq(motion[~is_still], recording.measured[~is_still])[0].tolist()
    expected = (
        _read_late(recording.measured, 1.0 / gain, slope / gain, step)
        if history is recording.command
        else _read_late(recording.command, gain, -slope / gain, step)
    )
    return np.where(is_still, history - expected, 0.0)


def _find_held_samples(recording: Recording) -> Iterator[Fault]:
    """Find samples that repeat the one before in a channel whose noise lets no two be equal."""
    measured_displacement = recording.measured
    is_held = np.concatenate([[False], np.diff(measured_displacement) == 0.0])
    share = float(is_held.mean())
    steps = np.abs(np.diff(measured_displacement))
    smallest = float(steps[steps > 0.0].min(initial=np.inf))
    chance_count = int(np.sum((steps > 0.0) & (steps < _ROUNDING_FACTOR * smallest)))
    if not _CHANCE_FACTOR * max(chance_count, 1) < is_held.sum() < _LARGEST_HELD_SHARE * is_held.size:
        return
    if (np.diff(_runs(is_held)) >= _LONGEST_HELD_RUN).any():
        return  # a standstill
    places = np.arange(measured_displacement.size)
    interpolated = np.interp(places, places[~is_held], measured_displacement[~is_held])
    yield Fault(
        kind="held",
        finding=f"The measured displacement repeats the previous sample in {percent(share, decimals=2)} of "
        "its samples: these were replaced by interpolation between their neighbours.",
        in_measured=measured_displacement - interpolated,
        in_loop=False,
    )


def _runs(mask: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Find the first and the last sample of each stretch of marked steps, shape (k, 2)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges.reshape(-1, 2)


def _slow(
    recording: Recording,
    prediction: Array,
    threshold: float,
    experimental_fraction: float,
    tracking: TrackingIndex,
) -> Iterator[Fault]:
    peak = float(np.abs(recording.command).max())
    period = 1.0 / tracking.plain.equivalent_frequency
    blocks = int(recording.duration / (_PERIODS_OF_A_BLOCK * period))
    if blocks < _FEWEST_BLOCKS:
        return
    blocks = min(blocks, _MOST_BLOCKS)
    sizes, errors = _fit_line(recording.measured - prediction, blocks)
    answers, deviations = _fit_line(recording.command, blocks)
    shapes = np.ones(recording.command.size), np.linspace(-0.5, 0.5, recording.command.size)
    least = _LEAST_SHARE * threshold * peak
    terms = zip(
        ("offset", "drift"), sizes.tolist(), errors.tolist(), shapes, answers, deviations, strict=True
    )
    for kind, size, error, shape, answer, deviation in terms:
        if abs(size) < least or abs(size) < _SIGNIFICANT * error:
            continue
        share = f"{percent(abs(size) / peak, decimals=2)} of the command's peak"
        force_offset = experimental_fraction * size
        loop_answers = _loop_answers(-answer / force_offset, deviation / abs(force_offset))
        yield Fault(
            kind=kind,
            finding=f"The measured displacement has an offset of {share}."
            if kind == "offset"
            else f"The measured displacement drifts by {share} from beginning to end.",
            in_measured=size * shape,
            in_loop=loop_answers,
            size=size,
            deviation=error,
        )


def _fit_line(values: Array, blocks: int) -> tuple[Array, Array]:
    """Mean and rise of a history over its length, and their standard errors, shape (2,) each."""
    means = np.array([float(part.mean()) for part in np.array_split(values, blocks)])
    places = (np.arange(blocks) + 0.5) / blocks - 0.5
    design = np.stack([np.ones(blocks), places], axis=1)
    coefficients, *_ = np.linalg.lstsq(design, means, rcond=None)
    scatter = float(np.sum((means - design @ coefficients) ** 2)) / (blocks - 2)
    return coefficients, np.sqrt(scatter * np.diag(np.linalg.inv(design.T @ design)))


def _loop_answers(answer: float, deviation: float) -> bool | None:
    """Whether the command's mean, over what an offset causes in the loop, shows that the loop felt it."""
    spread = _SIGNIFICANT / 2.0 * deviation
    if spread < _LOOP_RANGE[1] - 1.0 and _LOOP_RANGE[0] <= answer <= _LOOP_RANGE[1]:
        return True
    if spread < _SENSOR_RANGE[1] and _SENSOR_RANGE[0] <= answer <= _SENSOR_RANGE[1]:
        return False
    return None


@dataclass(frozen=True, kw_only=True, eq=False)
class FaultEffect(PlainResult):
    """A fault of the recording with what it does to the error."""

    keys: ClassVar[Keys] = {
        "actuator?": "fault.actuator",
        **{name: f"fault.{name}" for name in ("kind", "finding", "in_loop")},
        "error": "error.judged_estimate.value",
        "error_otherwise": "otherwise.judged_estimate.value",
    }

    fault: Fault  # The fault
    error: ErrorOfTest  # Error of the test
    # Error of the test without the fault; where the verdict already excludes the fault because the loop did
    # not feel it, the error with the fault; None where that is not known
    otherwise: ErrorOfTest | None


def error_with_faults(
    recording: Recording, faults: Sequence[Fault], question: Question
) -> tuple[ErrorOfTest, tuple[FaultEffect, ...]]:
    """Error of the test without the faults that the loop did not feel, and the effect of each fault on it.

    Returns `effects`: for each fault the error without it, or with it where `error` already excludes it.
    """
    unfelt = [fault for fault in faults if fault.in_loop is False]
    known_offsets = {fault.place for fault in faults if fault.size}

    def error_without(some: Sequence[Fault], open_sizes: Mapping[str, float]) -> ErrorOfTest:
        return error_of_test(
            repair_recording(recording, some),
            question,
            known_offsets=known_offsets,
            left_by_repairs={**_sizes_left(some), **open_sizes},
        )

    def others(fault: Fault) -> Sequence[Fault]:
        return [other for other in unfelt if other is not fault] if fault.in_loop is False else [fault]

    error = error_without(unfelt, _sizes_open(faults))
    return error, tuple(
        FaultEffect(
            fault=fault,
            error=error,
            otherwise=error_without(others(fault), {}) if fault.repairable else None,
        )
        for fault in faults
    )


def _sizes_open(faults: Sequence[Fault]) -> dict[str, float]:
    """Offsets and drifts of which the command does not show whether the loop felt them."""
    return {
        fault.name_quantity("open"): fault.size for fault in faults if fault.size and fault.in_loop is None
    }


def _sizes_left(faults: Sequence[Fault]) -> dict[str, float]:
    """Sizes of what the repair of faults leaves unknown, by the names of the tolerances."""
    return {fault.name_quantity("sensor"): fault.deviation for fault in faults if fault.deviation}
