"""The noise of the displacement sensor, estimated from the test, and the filter that removes it.

The noise is read at frequencies where the command's motion makes up only a small share of the residual,
mostly above the motion. A smooth spectrum that is fitted there extends it to all other frequencies. The
spectrum is a sum, with coefficients that are not negative, of white noise and of first-order autoregressive
noises with fixed corner frequencies, of highest Whittle likelihood (`reliab.signals`). Narrow lines above the
motion (mains) are not part of it: the filter keeps them out.

The filter of a channel is read from its noise, too. An anti-alias filter passes the noise of a sensor as it
passes the motion: above its corner the noise falls as no slow noise of a sensor does, with the fourth power
of frequency or steeper. The motion came late by the filter's delay, and where the command did not pass the
same filter, that delay looks like one of the actuator. Whether it did, two displacements do not show. Noise
of the converter, which comes after the filter, hides it.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, read_only
from reliab.signals.filters import LowPass, filter_symmetrically, low_pass
from reliab.signals.noise import fit_levels, noise_shapes
from reliab.signals.spectra import average_over_bins, periodogram, upper_level

LOST_IN_NOISE = 0.05
"""Standard deviation of the noise over the largest motion, from which no error is judged [-]."""

CORNERS = (0.3, 1.0, 3.0, 10.0, 30.0)
"""Corner frequencies of the slow parts [Hz]."""

_BINS = 100
_UPDATES = 400
_MOTION_FACTOR = 4.0  # times the noise that the difference must exceed to be motion
_MOTION_LEFT = 0.1  # share of the residual that the actuator's motion may make up where noise is read
_MARGIN = 1.3
_NEGLIGIBLE_SHARE = 1e-5  # of the power of a command, that need not be followed

_ORDERS = (2, 4, 8)
_CORNERS_TRIED = 32  # corners
_ROOM = 0.8  # of the Nyquist frequency: highest corner that is looked for
_INNER = 0.99
_PLATEAU = 3.0  # times the lowest frequency of the noise: lowest corner
_FEWEST = 12  # bins of noise
_CLEAR = 30.0  # logarithm of the likelihood ratio from which a filter is seen
_STANDING = (
    0.02  # share of samples that repeat the one before: of a reading with play, a converter, held ones
)
_UPDATES_OF_FILTER = 200
_STILL = 1e-12  # of a measured displacement, up to which its command stands still
_NEARLY_STILL = 1e-9  # of it, by which a command moves that stands in for one that does not


def is_lost_in_noise(difference: Array, largest: float) -> bool:
    """Tell whether a motion is too small for the noise of its sensor.

    `difference`: command minus measured displacement [m], shape (n,), whose second differences show white
    noise and hardly the motion; `largest`: the largest motion [m].

    >>> noise = 0.02 * np.random.default_rng(1).standard_normal(10_000)
    >>> is_lost_in_noise(noise, 0.39), is_lost_in_noise(noise, 0.41)
    (True, False)
    """
    steps = np.diff(difference, n=2)
    white = float(np.sqrt(np.mean(steps**2) / 6.0)) if steps.size else 0.0
    return white >= LOST_IN_NOISE * largest


@dataclass(frozen=True, kw_only=True, eq=False)
class SensorNoise:
    """Spectrum of the sensor's noise and band of the motion."""

    time_step: float  # Step between samples [s]
    # Level of the white part and of each slow part at zero frequency [m²], shape (1 + corners,); the mean
    # square of white noise is its level
    weights: Array
    # Frequency [Hz] above which neither the command nor its difference from the measured displacement rises
    # above the noise
    band: float

    @property
    def white(self) -> float:
        """Standard deviation of the white part [m]."""
        return float(np.sqrt(self.weights[0]))

    @property
    def slow(self) -> float:
        """Root mean square of the slow parts [m]."""
        frequency: Array = np.linspace(0.0, 0.5 / self.time_step, 8193)
        density = self.weights[1:] @ _shapes(frequency, self.time_step)[1:]
        return float(np.sqrt(np.trapezoid(density, frequency) * 2.0 * self.time_step))

    def density(self, frequency: Array) -> Array:
        """Return the expected periodogram |Σ x e^(−iωt)|²/n at frequencies [Hz], shape of `frequency`."""
        return np.asarray(self.weights @ _shapes(frequency, self.time_step))

    @cached_property
    def filter(self) -> Array:
        """Coefficients of the symmetric low-pass filter that passes the band, shape (odd,)."""
        return low_pass(_MARGIN * self.band, 1.0 / self.time_step)

    def smooth(self, values: Array) -> Array:
        """Return histories, shape (…, n), without what lies above the band, and without delay."""
        return filter_symmetrically(values, self.filter)


def estimate_noise(
    command: Array, measured_displacement: Array, time_step: float, other_commands: Array | None = None
) -> SensorNoise:
    """Estimate the noise of the displacement sensor.

    `command`, `measured_displacement` [m]; `time_step` [s]; `other_commands`: commands of further actuators,
    which may move this one too, shape (others, n).

    >>> time = np.arange(0.0, 40.0, 0.002)
    >>> command = np.sin(6.0 * time) * np.sin(0.08 * time) ** 2
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    >>> found = estimate_noise(command, 0.99 * command + noise, 0.002)
    >>> round(found.white, 3)
    0.01
    """
    commands = command[np.newaxis] if other_commands is None else np.vstack([command, other_commands])
    powers = [_periodogram(row) for row in commands]
    (centre, mean, count), quiet, floor = _residual(commands, powers, measured_displacement, time_step)
    weights = np.zeros(1 + len(CORNERS))
    if quiet.sum() > len(CORNERS):
        weights = _fit_shapes(_shapes(centre[quiet], time_step), mean[quiet], count[quiet])
    else:
        weights[0] = floor
    moving = (_periodogram(command - measured_displacement), powers[0])
    return SensorNoise(
        time_step=time_step,
        weights=weights,
        band=max(_band(power, weights[0], command.size, time_step) for power in moving),
    )


def estimate_noises(
    commands: Array, measured_displacements: Array, time_step: float
) -> tuple[SensorNoise, ...]:
    """Estimate the noise of the sensors of p actuators, which may move each other; both [m], shape (p, n)."""
    moves, noises = are_moving(commands, measured_displacements), []
    for place, (command, displacement) in enumerate(zip(commands, measured_displacements, strict=True)):
        if moves[place]:
            other_commands = commands[moves & (np.arange(len(moves)) != place)]
            noises.append(estimate_noise(command, displacement, time_step, other_commands))
        else:
            still = np.zeros(displacement.size)
            still[1] = _NEARLY_STILL * max(float(np.ptp(displacement)), np.finfo(float).tiny)
            noises.append(estimate_noise(still, displacement - displacement.mean(), time_step))
    return tuple(noises)


def are_moving(commands: Array, measured_displacements: Array) -> NDArray[np.bool_]:
    """Which actuators are told to move, shape (p,)."""
    return np.asarray(np.ptp(commands, axis=1) > _STILL * np.abs(measured_displacements).max(axis=1))


def level_of_residual(
    command: Array, measured_displacement: Array, time_step: float
) -> tuple[Array, Array, Array]:
    """Frequency [Hz], level [m²] and number of frequencies of bins where the residual is noise.

    `command`, `measured_displacement` [m]; `time_step` [s].
    """
    bins, quiet, _ = _residual(command[np.newaxis], [_periodogram(command)], measured_displacement, time_step)
    first = int(np.argmin(quiet[::-1])) if not quiet.all() else quiet.size  # of those above all motion
    centre, mean, count = (values[values.size - first :] for values in bins)
    return centre, mean, count


def _residual(
    commands: Array, powers: list[Array], measured_displacement: Array, time_step: float
) -> tuple[tuple[Array, Array, Array], NDArray[np.bool_], float]:
    """Bins of what the commands do not explain, which of them are noise, and the white floor [m²].

    `powers`: periodograms of the commands.
    """
    frequency: Array = np.fft.rfftfreq(measured_displacement.size, time_step)[1:].astype(np.float64)
    power = _periodogram(
        measured_displacement - follow_commands(commands, measured_displacement, time_step, powers)
    )
    motion_power, floor = _sum_powers(powers), upper_level(power)
    power = np.minimum(power, _surrounding_level(power))
    bins = average_over_bins(frequency, power, _BINS)
    motion = average_over_bins(frequency, motion_power, _BINS)[1]
    ratio = float(bins[1][np.argmax(motion)] / motion.max())
    return bins, ratio * motion < _MOTION_LEFT * np.maximum(bins[1], floor), floor


def white_floor(values: Array) -> float:
    """Level of the periodogram above half of the Nyquist frequency [m²]: of white noise its mean square."""
    return upper_level(_periodogram(values))


def _sum_powers(powers: list[Array]) -> Array:
    """Power of several commands, each over its largest value, in place of that of one."""
    if len(powers) == 1:
        return powers[0]
    largest = (max(float(power.max()), np.finfo(float).tiny) for power in powers)
    return np.asarray(np.sum([power / peak for power, peak in zip(powers, largest, strict=True)], axis=0))


def follow_commands(
    commands: Array, measured_displacement: Array, step: float, powers: list[Array] | None = None
) -> Array:
    """Commands as an actuator of slowly changing gains and delays follows them, by least squares.

    The first command may lag, too. `commands` [m], shape (p, n); `measured_displacement` [m], shape (n,) or
    (rows, n); `step` [s]; `powers`: periodograms of the commands, where they are known. Commands of several
    actuators may answer the noise that the loop feels, which they must not explain: what counts is the
    motion.
    """
    size = commands.shape[1]
    place = np.linspace(-1.0, 1.0, size)
    velocity = np.gradient(commands, step, axis=1)
    basis = np.concatenate([commands, velocity])
    lag = np.gradient(velocity[0], step)[np.newaxis]
    rows = np.concatenate([basis, lag, basis * place, np.ones((1, size))])
    rows /= np.maximum(np.abs(rows).max(axis=1, keepdims=True), np.finfo(float).tiny)
    smooth_rows, smooth_measured = rows, measured_displacement
    if len(commands) > 1:
        powers = powers or [_periodogram(command) for command in commands]
        filter_ = low_pass(_MARGIN * _highest(powers, commands.shape[1] * step), 1.0 / step)
        smooth_rows, smooth_measured = (
            filter_symmetrically(history, filter_) for history in (rows, measured_displacement)
        )
    coefficients = np.linalg.lstsq(smooth_rows @ smooth_rows.T, smooth_rows @ smooth_measured.T, rcond=1e-12)[
        0
    ]
    return np.asarray(coefficients.T @ smooth_rows)


def _highest(powers: list[Array], duration: float) -> float:
    """Frequency [Hz] below which nearly all of each command's power lies; `duration` [s]."""
    cumulative = np.cumsum(powers, axis=1)
    places = (cumulative < (1.0 - _NEGLIGIBLE_SHARE) * cumulative[:, -1:]).sum(axis=1)
    return float((places.max() + 1) / duration)


def _periodogram(values: Array) -> Array:
    return periodogram(values, _taper(values.size))


@lru_cache(maxsize=4)
def _taper(size: int) -> Array:
    return read_only(np.hanning(size))


def _surrounding_level(power: Array) -> Array:
    """Level of the surroundings of each bin, so that a narrow line does not count as noise of the band."""
    width = max(power.size // 400, 8)
    blocks = power[: power.size // width * width].reshape(-1, width)
    level = np.repeat(np.median(blocks, axis=1), width)
    level = np.concatenate([level, np.full(power.size - level.size, level[-1])])
    high = np.arange(power.size) > power.size // 50
    return np.asarray(np.where(high, 8.0 * level, np.inf))


def _shapes(frequency: Array, step: float) -> Array:
    return noise_shapes(frequency, 1.0 / step, CORNERS)


def _fit_shapes(shapes: Array, mean: Array, count: Array) -> Array:
    tiny = 1e-12 * float(mean.max()) + np.finfo(float).tiny
    start = float(np.average(mean, weights=count)) / shapes.shape[0] + tiny
    (levels,) = fit_levels(shapes[np.newaxis], mean, count, start=start, floor=tiny, updates=_UPDATES)
    return np.asarray(levels)


def _band(power: Array, white: float, samples: int, step: float) -> float:
    """Highest frequency [Hz] at which a periodogram rises above the white noise."""
    frequency: Array = np.fft.rfftfreq(samples, step)[1:].astype(np.float64)
    centre, mean, count = average_over_bins(frequency, power, _BINS)
    limit = (1.0 + _MOTION_FACTOR * np.maximum(1.0 / np.sqrt(count), 0.25)) * white
    # a single bin above the noise is a line, not motion
    is_above = mean > limit
    motion = is_above & (np.roll(is_above, 1) | np.roll(is_above, -1))
    centres = centre[motion & (np.arange(centre.size) < centre.size - 1)]
    return float(centres.max()) if centres.size else float(centre[0])


def filter_of_noise(command: Array, measured_displacement: Array, time_step: float) -> LowPass | None:
    """Find the filter through which the measured displacement was read; None where its noise shows none.

    `command`, `measured_displacement` [m]; `time_step` [s].

    >>> time = np.arange(0.0, 40.0, 0.001)
    >>> command = np.sin(6.0 * time) * np.sin(0.08 * time) ** 2
    >>> noise = 0.01 * np.random.default_rng(1).normal(size=time.size)
    >>> filter_of_noise(command, 0.99 * command + noise, 0.001) is None
    True
    >>> import scipy
    >>> coefficients = scipy.signal.butter(2, 80.0, fs=1000.0)
    >>> read = scipy.signal.lfilter(*coefficients, 0.99 * command + noise)
    >>> 60.0 < filter_of_noise(command, read, 0.001).corner < 100.0
    True
    """
    if np.mean(np.diff(measured_displacement) == 0.0) > _STANDING:
        return None
    frequency, level, count = level_of_residual(command, measured_displacement, time_step)
    highest = _ROOM * 0.5 / time_step
    is_inside = frequency < highest / _ROOM
    frequency, level, count = frequency[is_inside], level[is_inside], count[is_inside]
    if frequency.size < _FEWEST or not level.max() > 0.0 or not _PLATEAU * frequency[0] < highest:
        return None
    shapes = noise_shapes(frequency, 1.0 / time_step, CORNERS)

    def likelihood(parts: Array) -> Array:
        start = float(np.average(level, weights=count)) / parts.shape[1]
        floor = 1e-9 * float(level.min()) + np.finfo(float).tiny
        weights = fit_levels(parts, level, count, start=start, floor=floor, updates=_UPDATES_OF_FILTER)
        mean_level = (weights[:, np.newaxis] @ parts)[:, 0] + floor
        return np.asarray(-0.5 * np.sum(count * (np.log(mean_level) + level / mean_level), axis=1))

    def warp(f: Array) -> Array:  # by the bilinear transform, as a digital filter is
        return np.asarray(np.tan(np.pi * f * time_step) / (np.pi * time_step))

    filters, powers = [], []
    for order in _ORDERS:
        for corner in np.geomspace(_PLATEAU * frequency[0], highest, _CORNERS_TRIED).tolist():
            digital = LowPass(corner=float(warp(np.asarray(corner))), order=order)
            filters.append(LowPass(corner=corner, order=order))
            powers += [filters[-1].power(frequency), digital.power(warp(frequency))]
    *filter_likelihoods, plain = likelihood(
        shapes * np.array([*powers, np.ones_like(frequency)])[:, np.newaxis]
    )
    best = int(np.argmax(filter_likelihoods))
    inner = filters[best // 2].corner < _INNER * highest  # noise that falls at the highest only: none
    return filters[best // 2] if inner and filter_likelihoods[best] - plain > _CLEAR else None
