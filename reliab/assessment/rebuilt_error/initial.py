"""The channels, checked before an error is rebuilt, and how they begin: the sensor's offset and the error.

A displacement sensor is read from an arbitrary zero. Where a test begins at rest, a constant difference
between the channels is either the sensor's offset or a real distance between piston and command. The command
shows which: a piston that is displaced by b from its command adds a constant restoring force, which shifts
the structure's mean position by −b times the specimen's share of the static stiffness; a ground acceleration
has no mean and causes no such shift. An offset without effect on the loop is subtracted; one with an effect
is kept. Where the command does not show which it is, the offset is subtracted and its whole size is added to
the uncertainty. A command that already has the shifted mean at the first sample shows that the offset acted
before the recording began: the error then begins in equilibrium and not from zero. Where a test begins in
motion the initial error is unknown, and the interval includes it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.rebuilt_error.noise import SensorNoise, are_moving
from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import require_physical
from reliab.structures.partition import Partition

_REST_SHARE = 1e-3  # share of the largest displacement up to which the first motion counts as rest
_STILL = 2e-3  # share up to which the command still counts as standing
_LONGEST_REST = 0.25  # of the record
SIGNIFICANT_OFFSET = 4.0  # standard deviations
FEWEST_AT_REST = 4
SHIFT_OF_COMMAND = (
    0.1  # largest distance of the mean command from the response to the offset, over that response
)
_CONCLUSIVE = 3.0  # logarithm of the ratio of likelihoods from which on the command has told
_NEIGHBOURS = slice(2, 6)  # bins of a tapered spectrum that no constant reaches

FEWEST_SAMPLES = 64
"""Smallest number of samples from which an error is rebuilt."""

_FEWEST_PER_PERIOD = 10.0


@dataclass(frozen=True, kw_only=True)
class Start:
    """How a recording begins."""

    at_rest: bool  # Whether the structure stands still at the first sample
    amplitude: float  # Amplitude of its motion there [m]
    offset: float  # Offset of the sensor that was taken away, measured minus command at rest [m]
    offset_deviation: float  # Standard deviation of the offset that may remain [m]
    # Measured minus command [m] under which the structure was already at rest before the first sample
    standing: float = 0.0


def examine_start(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    frequency: float,
    white: float,
    slow: float = 0.0,
    share: float = 1.0,
) -> Start:
    """Find the sensor's offset and the state of motion at the start of a recording.

    `command`, `measured_displacement` [m]; `time_step` [s]; `frequency` [Hz]; `white`, `slow` [m]; `share`
    [-].

    >>> time = np.arange(0.0, 10.0, 0.01)
    >>> command = np.where(time > 1.0, np.sin(6.0 * (time - 1.0)), 0.0)
    >>> round(examine_start(command, command + 0.02, 0.01, 1.0, 0.0).offset, 6)
    0.02

    The same offset, which the loop felt, moved the command the other way:

    >>> examine_start(command - 0.02, command, 0.01, 1.0, 0.0).offset
    0.0
    """
    peak = float(np.abs(command - command[0]).max())
    is_moving = np.abs(command - command[0]) > _STILL * peak
    still = int(np.argmax(is_moving)) if is_moving.any() else command.size
    still = max(min(still, int(_LONGEST_REST * command.size)), FEWEST_AT_REST)
    offset = float(np.mean(measured_displacement[:still] - command[:still]))
    deviation = float(np.hypot(white / np.sqrt(still), slow))
    stands = _stands(command[:still], offset, deviation, share)
    amplitude = _amplitude(command + share * offset if stands else command, time_step, frequency)
    largest = max(peak, float(np.abs(command).max()))
    if amplitude > (SHIFT_OF_COMMAND * share * abs(offset) if stands else _REST_SHARE * largest):
        mean_deviation = float(np.hypot(white / np.sqrt(command.size), slow))
        return _start_in_motion(command, measured_displacement, time_step, share, amplitude, mean_deviation)
    if stands:
        return Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=deviation, standing=offset)
    motion = float(np.abs(command[:still] - command[0]).max())
    if abs(offset) <= SIGNIFICANT_OFFSET * deviation + motion:
        return Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=deviation)
    phase = 2.0 * np.pi * frequency * still * time_step
    answer = share * abs(offset) * (1.0 - np.cos(min(phase, np.pi)))
    smallest = max(motion, _STILL * peak)
    if answer > SIGNIFICANT_OFFSET * smallest:  # a structure that felt it would not have stood still
        return Start(at_rest=True, amplitude=0.0, offset=offset, offset_deviation=deviation)
    is_felt = _loop_felt(command, measured_displacement, offset, share)
    if is_felt:
        return Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=deviation)
    open_offset = deviation if is_felt is False else float(np.hypot(deviation, offset))
    return Start(at_rest=True, amplitude=0.0, offset=offset, offset_deviation=open_offset)


def _stands(command: Array, offset: float, deviation: float, share: float) -> bool:
    """Whether a command that is still at rest has the shift that an offset in the loop would cause."""
    place = float(np.mean(command)) + share * offset
    is_significant = abs(offset) > SIGNIFICANT_OFFSET * deviation
    return is_significant and abs(place) <= SHIFT_OF_COMMAND * share * abs(offset)


def _start_in_motion(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    share: float,
    amplitude: float,
    mean_deviation: float,
) -> Start:
    """Return the beginning of a test that is moving already; `mean_deviation` of a mean [m]."""
    constant = _constant(command, measured_displacement, time_step)
    is_felt = _loop_felt(command, measured_displacement, constant, share)
    return Start(
        at_rest=False,
        amplitude=amplitude,
        offset=0.0,
        offset_deviation=mean_deviation if is_felt else float(np.hypot(constant, mean_deviation)),
    )


def _amplitude(command: Array, time_step: float, frequency: float) -> float:
    """Amplitude of the motion at the first sample, by the parabola through the first ones [m]."""
    first = command[: 2 * FEWEST_AT_REST]
    place = np.arange(first.size, dtype=np.float64)
    _, slope, begin = np.polyfit(place, first, 2)
    return float(np.hypot(begin, slope / (2.0 * np.pi * frequency * time_step)))


def _constant(command: Array, measured_displacement: Array, time_step: float) -> float:
    """Return measured minus command [m] after a gain and a delay are fitted."""
    rows = np.stack([command, np.gradient(command, time_step), np.ones(command.size)])
    rows = rows / np.abs(rows).max(axis=1, keepdims=True)
    coefficients = np.linalg.lstsq(rows @ rows.T, rows @ (measured_displacement - command), rcond=1e-12)[0]
    return float(coefficients[2])


def _loop_felt(command: Array, measured_displacement: Array, offset: float, share: float) -> bool | None:
    """Whether the loop felt an offset, by the place about which the command moved; None where that is open.

    The tapered mean of x_c + share (x_m − x_c) is zero where the offset acted in the loop, and share times
    the offset where it did not, apart from slow ground motion, whose size is estimated from neighbouring bins
    of the spectrum.
    """
    taper = np.hanning(command.size)
    spectrum = np.fft.rfft(taper * (command + share * (measured_displacement - command))) / taper.sum()
    power = float(np.mean(np.abs(spectrum[_NEIGHBOURS]) ** 2))
    mean = float(spectrum[0].real)
    ratio = 0.5 * ((mean - share * offset) ** 2 - mean**2)
    if abs(ratio) <= _CONCLUSIVE * power:
        return None
    return ratio > 0.0


def check_histories(
    command: Array, measured_displacement: Array, step: float, structure: Partition
) -> tuple[Array, Array]:
    """Check commands and measured displacements [m], shape (n,) or (p, n); returns both as (p, n).

    `step` [s].
    """
    command, measured_displacement = (
        np.ascontiguousarray(np.atleast_2d(values), dtype=np.float64)
        for values in (command, measured_displacement)
    )
    shape = command.shape
    if len(shape[:-1]) != 1 or shape != measured_displacement.shape or shape[-1] < FEWEST_SAMPLES:
        raise InputError(
            f"Command and measured displacement must have the same length, at least {FEWEST_SAMPLES} samples",
            value=f"shapes {shape} and {measured_displacement.shape}",
            remedy="Give the histories of the whole test, of every actuator if there are several",
        )
    if shape[0] != structure.degrees:
        raise InputError(
            "A test must have a command and a measured displacement for each degree of freedom of the "
            "specimen",
            value=f"{shape[0]} of {structure.degrees}",
            remedy="Record all of them, or describe the part that was driven",
        )
    for name, values in (("command", command), ("measured displacement", measured_displacement)):
        if not np.isfinite(values).all():
            raise InputError(f"The {name} must be finite throughout", remedy="Repair the recording")
    if not np.ptp(command, axis=-1).any():
        raise InputError("The command must move", remedy="Check that the column is the right one")
    require_physical("time step", step)
    lowest = float(structure.natural_frequencies[0])
    if lowest * step * _FEWEST_PER_PERIOD > 1.0:
        raise InputError(
            f"A period of the structure must hold at least {_FEWEST_PER_PERIOD:.0f} samples",
            value=significant(1.0 / (lowest * step)),
            remedy="Record at a higher rate: the error between samples is unknown",
        )
    return command, measured_displacement


def examine_starts(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    partition: Partition,
    noises: Sequence[SensorNoise],
    to_interface: Array,
    sensor_offsets: Array | float | None = None,
) -> tuple[Start, ...]:
    """Examine how the channels of p actuators begin; a stated offset of a sensor is used as given.

    `command`, `measured_displacement` [m], shape (p, n); `time_step` [s]; `to_interface`: interface
    displacements per unit of each channel [-], shape (p, p); `sensor_offsets` [m], NaN where none is stated.
    """
    lowest = float(partition.natural_frequencies[0]) or 1.0
    moves, shares = are_moving(command, measured_displacement), partition.shares_at_sensors(to_interface)
    offsets = np.broadcast_to(np.nan if sensor_offsets is None else sensor_offsets, len(command))
    starts = []
    for place, (row, read) in enumerate(zip(command, measured_displacement, strict=True)):
        start = Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=0.0)
        if moves[place]:
            noise, share = noises[place], float(shares[place])
            start = examine_start(row, read, time_step, lowest, noise.white, noise.slow, share)
        if not np.isnan(offsets[place]):
            start = replace(start, offset=float(offsets[place]), offset_deviation=0.0)
        starts.append(start)
    return tuple(starts)
