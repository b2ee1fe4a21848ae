"""The error of a test with several actuators, rebuilt from its commands and measured displacements.

The equation is that of one actuator with vectors in place of numbers (see `rebuilt_error/rebuild.py`); it
needs neither the ground motion nor a reference. Sensors stand at the actuators: noise, offsets and scales are
drawn there, and a matrix carries them to the interface.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.coupled_error.coupled_error import (
    CoupledError,
    errors_of_displacements,
)
from reliab.assessment.coupled_error.joint_draws import draw_jointly
from reliab.assessment.rebuilt_error.initial import Start, check_histories, examine_start
from reliab.assessment.rebuilt_error.interval import (
    Histories,
    StandardDeviations,
    samples_in_step,
    sweep,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.assessment.rebuilt_error.size import require_fitting
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.structures.partition import Partition

DRAWS = 256
"""Number of draws of the uncertain quantities, a power of two."""

_EXACT_ACCURACY = 0.001  # accuracy of an error whose structure is exact
_SAMPLES_PER_PERIOD = 16.0  # samples of the fastest mode that takes part; what lies between is corrected
_TAKES_PART = 0.01  # of the answer at rest: a mode with less does not set the step
_NEAR_BAND = 1.5  # times the band of the motion: modes above follow inputs that are linear between samples
_STATIC_MODE_FACTOR = 4.0  # times the band of the motion: modes above follow by statics
_PAST_MODE = 1.05  # times its frequency, that the band holds of a mode that may ring
_HIGHEST = 0.2  # of the rate: above, noise is read, and a mode is seen only where it rises above it
_RIPPLE = 80.0  # dB: deviations of the filter would be those of errors that noise hardly leaves open
_STILL = 1e-12
_NO_NOISE = 1e-9  # of the span of a channel


@dataclass(frozen=True, kw_only=True, eq=False)
class Channels:
    """Histories at the sensors, without offsets, and what is known of each."""

    command: Array  # command, measured: x_c and x_m as read [m], shape (p, n)
    measured: Array
    noises: tuple[SensorNoise, ...]
    starts: tuple[Start, ...]


def rebuild_coupled(
    command: Array,
    displacements: Array,
    time_step: float,
    partition: Partition,
    *,
    to_interface: Array | None = None,
    feedback_lag: float = 0.0,
    tolerances: Tolerances | None = None,
    recursion: Recursion | None = None,
    sensor_offsets: Array | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> CoupledError:
    """Rebuild the error of every interface displacement of a test.

    `command`, `displacements` [m], shape (p, n); `time_step`, `feedback_lag` [s]; `to_interface`:
    interface displacements of unit displacements of the actuators [-], shape (p, p), the identity by default;
    `recursion`: of the ideal test as the computer steps it at the sampling rate, exact by default;
    `sensor_offsets`: of the displacement sensors [m], NaN where they are not known, shape (p,).

    Two actuators of which one moves 1 % too little:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> partition = Partition(mass=np.eye(2), damping=0.5 * np.eye(2), stiffness=40.0 * np.eye(2),
    ...                              interface=np.eye(2), specimen_stiffness=40.0 * np.eye(2))
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(np.sqrt(40.0) * time) * np.ones((2, 1))
    >>> error = rebuild_coupled(command, command * [[0.99], [1.0]], 1.0 / 256.0, partition)
    >>> round(error.displacements[0].rms.value, 2), error.displacements[1].rms.value < 1e-6
    (0.07, True)
    """
    command, displacements = check_histories(command, displacements, time_step, partition, has_actuators=True)
    carry = np.eye(partition.degrees) if to_interface is None else np.asarray(to_interface, dtype=float)
    channels = _examine_channels(command, displacements, time_step, partition, carry, sensor_offsets)
    band, frequencies = channels.noises[0].band, partition.natural_frequencies
    modes = int(np.count_nonzero(frequencies <= _STATIC_MODE_FACTOR * max(band, float(frequencies[0]))))
    structure = partition.reduce_to_modes(modes)
    governing = _governing_modes(structure, _NEAR_BAND * band)
    fastest = float(governing.max()) if governing.size else float(frequencies[0])
    structure_stride = max(int(1.0 / (_SAMPLES_PER_PERIOD * fastest * time_step)), 1)
    stride = samples_in_step(structure_stride, channels.noises[0], command.shape[1])
    histories = _smooth_channels(channels, carry, feedback_lag)
    differences = _draw(channels, histories, structure, stride, draws, seed)
    recursion = recursion or histories.recursion(structure)
    offset, start_error = _start_deviations(channels, structure, histories)
    unknown = StandardDeviations(
        tolerances=tolerances or Tolerances(), offset=offset, error_at_start=start_error
    )
    run = partial(sweep, histories, partition, stride=stride, seed=seed, modes=modes, numerical=recursion)
    zero_deviations = np.zeros(partition.degrees)
    noisy = StandardDeviations(
        tolerances=Tolerances(), offset=zero_deviations, error_at_start=zero_deviations
    )
    nominal = run(noisy, differences[::2], draws=len(differences[::2]))
    swept = run(unknown, differences, draws=draws, accuracy=_EXACT_ACCURACY)
    loose = _looseness(channels, differences, carry)
    return CoupledError(
        time_step=time_step,
        displacements=errors_of_displacements(
            histories, recursion, channels.measured, partition.names, nominal, swept, loose
        ),
        structure=partition,
        starts=channels.starts,
        histories=histories,
        recursion=recursion,
        every=stride,
    )


def _smooth_channels(channels: Channels, carry: Array, feedback_lag: float) -> Histories:
    """Histories without what lies above the band of the motion."""
    step = channels.noises[0].time_step
    rows = zip(channels.noises, channels.command, channels.measured, strict=True)
    measured_displacement = np.stack(
        [command - noise.smooth(command - read) for noise, command, read in rows]
    )
    delayed_displacements = np.stack(
        [delay_history(row, feedback_lag, step) for row in measured_displacement]
    )
    return Histories(
        command=channels.command,
        measured=measured_displacement,
        fed_back=carry @ (channels.command - delayed_displacements),
        time_step=step,
        standing=carry @ np.array([-start.standing for start in channels.starts]),
        carry=carry,
        smooth=True,
    )


def _examine_channels(
    command: Array,
    measured_displacement: Array,
    step: float,
    partition: Partition,
    carry: Array,
    offsets: Array | None,
) -> Channels:
    """Estimate noise and offset of each sensor, but for stated `offsets` [m]; they are taken away."""
    shares = partition.shares_at_sensors(carry)
    lowest = float(partition.natural_frequencies[0])
    moves = _moves(command, measured_displacement)
    noises, starts, read = [], [], []
    for place, (c, m) in enumerate(zip(command, measured_displacement, strict=True)):
        if not moves[place]:
            noises.append(_noise_at_rest(m, step))
            starts.append(Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=0.0))
        else:
            other_commands = command[moves & (np.arange(len(moves)) != place)]
            noises.append(estimate_noise(c, m, step, other_commands))
            own_share = float(shares[place])
            starts.append(examine_start(c, m, step, lowest, noises[-1].white, noises[-1].slow, own_share))
        if offsets is not None and not np.isnan(offsets[place]):
            starts[-1] = replace(starts[-1], offset=float(offsets[place]), offset_deviation=0.0)
        read.append(m - starts[-1].offset)
    band = _band(noises, measured_displacement, partition)
    return Channels(
        command=command,
        measured=np.stack(read),
        noises=tuple(replace(noise, band=band, ripple=_RIPPLE) for noise in noises),
        starts=tuple(starts),
    )


def _band(noises: Sequence[SensorNoise], measured_displacement: Array, partition: Partition) -> float:
    """Band of the motion [Hz], one for all channels, with the modes that may ring below the noise.

    A channel without noise shows any band, and tells only where none has noise.
    """
    least = _NO_NOISE * np.ptp(measured_displacement, axis=1)
    noisy = [noise.band for noise, small in zip(noises, least, strict=True) if noise.white > small]
    modes = _governing_modes(partition, _HIGHEST / noises[0].time_step)
    return float(max(*(noisy or [noise.band for noise in noises]), *(_PAST_MODE * modes)))


def _moves(command: Array, measured_displacement: Array) -> NDArray[np.bool_]:
    """Which actuators are told to move, shape (p,)."""
    return np.asarray(np.ptp(command, axis=1) > _STILL * np.abs(measured_displacement).max(axis=1))


def _noise_at_rest(measured_displacement: Array, step: float) -> SensorNoise:
    """Noise of a sensor whose actuator is not told to move."""
    still = np.zeros(measured_displacement.size)
    still[1] = 1e-9 * max(float(np.ptp(measured_displacement)), np.finfo(float).tiny)
    return estimate_noise(still, measured_displacement - measured_displacement.mean(), step)


def _start_deviations(channels: Channels, structure: Partition, histories: Histories) -> Array:
    """Deviations of offsets at the sensors and of the errors at the first sample at the interface [m]."""
    offsets = np.array([start.offset_deviation for start in channels.starts])
    if all(start.at_rest for start in channels.starts):
        return np.stack([offsets, np.zeros_like(offsets)])
    difference = histories.carry_to_interface(channels.command - channels.measured)
    response = respond(histories.recursion(structure), difference)
    command = histories.carry_to_interface(channels.command)
    amplitudes = histories.carry_to_interface(np.array([start.amplitude for start in channels.starts]))
    spread = np.sqrt(np.mean(response**2, axis=1) / np.maximum(np.mean(command**2, axis=1), 1e-300))
    return np.stack([offsets, spread * np.abs(amplitudes)])


def _draw(
    channels: Channels, histories: Histories, structure: Partition, stride: int, draws: int, seed: int
) -> Array:
    """Draw histories of x_c − x_m at the sensors that the noise leaves open [m], shape (draws, p, m)."""
    actuators, samples = channels.command.shape
    require_fitting(actuators * samples, stride, channels.noises[0].time_step / actuators)
    moves = _moves(channels.command, channels.measured)
    smooth = histories.command - histories.measured
    differences = np.tile(smooth[:, ::stride], (draws, 1, 1))
    differences[:, moves] = draw_jointly(
        channels.command[moves],
        channels.measured[moves],
        [noise for noise, moving in zip(channels.noises, moves, strict=True) if moving],
        float(structure.natural_frequencies[0]),
        stride,
        draws,
        seed,
    )
    return differences


def _looseness(channels: Channels, differences: Array, carry: Array) -> Array:
    """Return the standard deviation of τ that the noise leaves open at the interface [m], shape (p,).

    Of an actuator that is not told to move, all that its sensor shows is open.
    """
    spread = np.einsum("ij,djt->dit", carry, differences - differences.mean(axis=0))
    still = ~_moves(channels.command, channels.measured)
    mean_squares = np.where(still, np.mean((channels.command - channels.measured) ** 2, axis=1), 0.0)
    return np.asarray(np.sqrt(np.mean(spread**2, axis=(0, 2)) + carry**2 @ mean_squares))


def _governing_modes(partition: Partition, highest: float) -> Array:
    """Natural frequencies [Hz] up to the highest of those with a share in the answer at rest."""
    frequency, _, shapes = partition.modes
    share = np.diag(partition.specimen_stiffness) @ (shapes**2) / (2.0 * np.pi * frequency) ** 2
    return np.asarray(frequency[(share > _TAKES_PART * share.sum()) & (frequency <= highest)])
