"""Histories of x_c − x_m that are compatible with the noisy sensor reading.

The sensor shows y = d + n, with d = x_c − x_m and its noise n. The actuator's error has a part that follows
the command and a remainder r: d = a x_c + b x_c' + c x_c'' + r, where a and b may change slowly over the
test. In a lapped transform the coefficients of r and n are nearly independent: n has a known variance s, and
r the variance q(f) P(t, f), where P is the local power of the command, since an actuator's error is about
proportional to its command (where other actuators move it too, to all commands, which d then follows as
well; so many coefficients would follow the noise, too, and each has an unknown size of its own, flat in its
logarithm). The level q of each band of frequencies is not known. Its logarithm follows a
Markov chain from band to band, with steps of the Laplace distribution and now and then a jump. Levels are
drawn by forward filtering and backward sampling (Carter and Kohn 1994, Biometrika 81, 3), then a, b and c by
generalised least squares, and then r, which is normal about q P (y − a x_c − …)/(q P + s). Differences that
noise can explain are thus not counted as error.

Slow noise cannot be distinguished from some actuator errors, such as play. Every second draw therefore
assumes that there is no slow noise; the others multiply the slow noise of each band by a factor that is drawn
together with the level.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.assessment.rebuilt_error.noise import SensorNoise, white_floor
from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.threads import one_thread
from reliab.signals.lapped_transform import analyse, synthesise
from reliab.signals.noise import converter_step, vary_rounding

_FACTORS_OF_A_LOGARITHM = 8  # each below 1e25, so that their product stays finite

_PERIODS_OF_HOP = 4.0  # of the structure, from one frame to the next
_FEWEST_FRAMES = 4
_BANDS_IN_OCTAVE = 6.0
_FIRST_LEVEL = 1e-3  # q with which what follows the command is first taken away
_DRAWS_OF_FOLLOWING = 16  # after which what follows the command is taken away a second time
_DEGREE = 2  # of the polynomials of time
_GRID = 0.3  # of the logarithm of q
_LEVELS = np.arange(np.log(1e-8), np.log(1e3), _GRID)
_STEP = 0.5  # of log q from band to band
_JUMP = 0.02  # probability of any other level
_FACTORS = np.array([0.0, 0.1, 0.2, 0.35, 0.6, 1.0, 1.7, 2.8, 5.0])  # of the slow noise
_FACTOR_STEP = 0.5  # places in the list from band to band
_LEAST_COMMAND = 0.01  # of the noise: power of a command that has died away
_SINGULAR = 1e-13
_DRAWS_IN_MEMORY = 16  # draws whose coefficients are in memory together
_SIZES = np.exp(np.arange(np.log(1e-5), np.log(3.0), 0.5))  # of coefficients, over that of the command
_LEAST_PASSED = 0.01  # of the noise: above the band the filter leaves less than neighbours leak
_ROUNDING = 1e-20  # of the command's largest power
_DITHER_SHARE = 0.9  # of Δ²/12: more white noise than that makes rounding white too


@compiled
def level_likelihood(
    residual: Array, command_power: Array, noise: Array, band: tuple[int, int], levels: Array, least: float
) -> Array:
    """Logarithm of the likelihood of each level, for each of several spectra of the noise.

    `residual` [m]; `command_power`, `noise` [m²]; `band`: its first coefficient and the one after its last;
    `levels`, `least` [-].
    Returns sums of −(ln v + r²/v)/2 with v = q P + s over the coefficients, shape (levels, factors).
    """
    factors, frames, _ = noise.shape
    count = levels.size
    likelihood = np.zeros((count, factors))
    product, quadratic, logarithm = np.empty((3, count))
    for factor in range(factors):
        common, factor_count = 0.0, 0
        for level in range(count):
            product[level], quadratic[level], logarithm[level] = 1.0, 0.0, 0.0
        for frame in range(residual.shape[0]):
            for k in range(band[0], band[1]):
                variance = noise[factor, frame if frames > 1 else 0, k]
                ratio = max(command_power[frame, k] / variance, least)
                square = residual[frame, k] ** 2 / variance
                common += np.log(variance)
                for level in range(count):
                    total = 1.0 + levels[level] * ratio
                    product[level] *= total
                    quadratic[level] += square / total
                factor_count += 1
                if factor_count == _FACTORS_OF_A_LOGARITHM:
                    for level in range(count):
                        logarithm[level] += np.log(product[level])
                        product[level] = 1.0
                    factor_count = 0
        for level in range(count):
            logarithm[level] += np.log(product[level])
            likelihood[level, factor] = -0.5 * (common + logarithm[level] + quadratic[level])
    return likelihood


@compiled
def sample_backwards(
    forward_probabilities: Array, level_steps: Array, factor_steps: Array, uniform: Array
) -> NDArray[np.int64]:
    """Draw the levels and factors of all bands, from the last one to the first.

    `forward_probabilities`: probabilities by the bands so far, shape (bands, levels, factors); `level_steps`,
    `factor_steps`: steps to the next band; `uniform`: numbers between 0 and 1, shape (bands, draws).
    Returns places in the flattened levels and factors, shape (draws, bands).
    """
    bands, levels, factors = forward_probabilities.shape
    states = np.empty((uniform.shape[1], bands), dtype=np.int64)
    sums, part = np.empty(levels), np.empty(factors)
    for draw in range(states.shape[0]):
        for back in range(bands):
            band = bands - 1 - back
            next_state = states[draw, band + 1] if back > 0 else 0
            total = 0.0
            for factor in range(factors):
                part[factor] = factor_steps[factor, next_state % factors] if back > 0 else 1.0
            for level in range(levels):
                probability = 0.0
                for factor in range(factors):
                    probability += forward_probabilities[band, level, factor] * part[factor]
                total += probability * level_steps[level, next_state // factors] if back > 0 else probability
                sums[level] = total
            threshold = uniform[back, draw] * total
            level = 0
            while level < levels - 1 and sums[level] < threshold:
                level += 1
            cumulative = sums[level - 1] if level > 0 else 0.0
            factor = -1
            step = level_steps[level, next_state // factors] if back > 0 else 1.0
            while factor < factors - 1 and (factor < 0 or cumulative < threshold):
                factor += 1
                cumulative += forward_probabilities[band, level, factor] * part[factor] * step
            states[draw, band] = level * factors + factor
    return states


@dataclass(frozen=True, kw_only=True, eq=False)
class Reading:
    """What a sensor shows, in coefficients over time and frequency."""

    observed: Array  # Coefficients of x_c − x_m as read [m], shape (frames, hop)
    # Coefficients of the histories that follow the command, each of mean square one: acceleration, command
    # and velocity, and the last two times polynomials of time, shape (rows, frames, hop)
    following: Array
    command_power: Array  # Power of the command about each of them [m²], shape (frames, hop)
    # Variances of the noise [m²] for each factor of its slow part, shape (factors, frames or 1, hop)
    noise: Array
    bands: NDArray[np.int64]  # Number of the band of frequencies of each coefficient, shape (hop,)
    # Largest size [m] of the part that follows a command; None where it is not limited
    largest: float | None = None
    undrawn: Array = field(default_factory=lambda: np.zeros((1, 0)))  # Observed above what is drawn [m]


def draw_differences(
    command: Array,
    measured_displacement: Array,
    noise: SensorNoise,
    frequency: float,
    stride: int,
    draws: int,
    seed: int,
    other_commands: Array | None = None,
    *,
    highest: float = np.inf,
) -> Array:
    """Draw histories of x_c − x_m.

    `command`, `measured_displacement` [m]; `frequency` [Hz]; `other_commands`: commands of further actuators
    that move this one too, shape (others, n); `highest`: frequency [Hz] above which the reading holds nothing
    to draw.
    Returns x_c − x_m [m] at each `stride`-th sample, shape (draws, ceil(n/every)); rows 0, 2, … assume that
    there is no slow noise.
    """
    generator = np.random.default_rng(seed)
    thin = replace(noise, band=min(noise.band, 0.27 / (stride * noise.time_step)))
    reading = _reading(command, measured_displacement, thin, frequency, stride)
    if other_commands is not None and len(other_commands):
        reading = _follow_other_commands(reading, thin.smooth(other_commands), noise.time_step, stride)
    reading = _limit_frequency(reading, highest * stride * noise.time_step)
    actuators = replace(reading, noise=reading.noise[:1])
    histories = np.empty((draws, -(-command.size // stride)))
    with one_thread():
        _draw_twice(actuators, histories[::2], generator)
        _draw_twice(reading, histories[1::2], generator)
    return histories


def _draw_twice(reading: Reading, histories: Array, generator: np.random.Generator) -> None:
    """Draw histories; levels of the remainder follow from draws of the part that follows the command."""
    level = _FIRST_LEVEL if reading.largest is None else 0.0  # many coefficients: first as if they said all
    variance = np.broadcast_to(reading.noise[-1] + level * reading.command_power, reading.observed.shape)
    first = _least_squares(reading, variance[np.newaxis])[0][0]
    follows = _draw_following(reading, _filter_forwards(reading, first), generator)
    _draw(reading, _filter_forwards(reading, follows.mean(axis=0)), histories, generator)


def _reading(
    command: Array, measured_displacement: Array, noise: SensorNoise, frequency: float, stride: int
) -> Reading:
    step = stride * noise.time_step
    smooth_command = noise.smooth(
        command
    )  # as the difference is, which would else follow what was taken from it
    smooth = smooth_command - noise.smooth(measured_displacement)
    size = -(-command.size // stride)
    periods = max(frequency * step * size, 1.0)  # of the structure in the test
    half = min(round(_PERIODS_OF_HOP * size / (2.0 * periods)), size // (2 * _FEWEST_FRAMES))
    hop = 2 * max(half, 1)
    coefficients = analyse(smooth[::stride], hop)
    power = _local_power(smooth_command, stride, hop)
    places: Array = (np.arange(hop, dtype=np.float64) + 0.5) / (2.0 * hop * step)
    rounding, other_noise = _rounding(command, measured_displacement, noise, stride, hop)
    white = (
        replace(
            other_noise, weights=other_noise.weights * (np.arange(other_noise.weights.size) == 0)
        ).filtered_density(places)
        / stride
    )
    slow = other_noise.filtered_density(places) / stride - white
    factors = _FACTORS if slow.any() else np.ones(1)
    quick = rounding + white
    least = max(_ROUNDING * float(power.max()), _LEAST_PASSED * float(quick.max()))
    variances = np.maximum(quick, least) + factors[:, np.newaxis, np.newaxis] * np.maximum(slow, 0.0)
    return Reading(
        observed=coefficients,
        following=_following(smooth_command, noise.time_step, stride, hop),
        command_power=power,
        noise=variances,
        bands=_bands(hop),
    )


def _follow_other_commands(reading: Reading, other_commands: Array, step: float, stride: int) -> Reading:
    """Let x_c − x_m follow the commands of other actuators too, and be about proportional to all."""
    hop = reading.bands.size
    powers = [
        reading.command_power,
        *(_local_power(other_command, stride, hop) for other_command in other_commands),
    ]
    normalized_powers = [power / max(float(power.mean()), np.finfo(float).tiny) for power in powers]
    size = float(reading.command_power.mean() + np.mean(reading.observed**2))
    other_rows = [
        _following(other_command, step, stride, hop)[1:] for other_command in other_commands
    ]  # without accelerations
    return replace(
        reading,
        command_power=size * np.mean(normalized_powers, axis=0),
        following=np.concatenate([reading.following, *other_rows])[_order_of_rows(len(other_commands))],
        largest=float(np.sqrt(size)),
    )


def _order_of_rows(other_count: int) -> NDArray[np.int64]:
    """Order of the rows: gains and delays, lag, then what changes in time."""
    powers = _DEGREE + 1
    rows = np.arange(1 + 2 * powers * (1 + other_count))
    constant = (rows > 0) & ((rows - 1) % powers == 0)
    return np.asarray(np.concatenate([rows[constant], rows[:1], rows[~constant][1:]]))


def _limit_frequency(reading: Reading, highest: float) -> Reading:
    """Leave undrawn what lies above a frequency, in cycles per step."""
    hop = reading.bands.size
    count = int(np.clip(np.ceil(2.0 * hop * highest), 1, hop)) if np.isfinite(highest) else hop
    return replace(
        reading,
        observed=np.ascontiguousarray(reading.observed[:, :count]),
        undrawn=reading.observed[:, count:],
        following=np.ascontiguousarray(reading.following[..., :count]),
        command_power=np.ascontiguousarray(reading.command_power[:, :count]),
        noise=np.ascontiguousarray(reading.noise[..., :count]),
        bands=reading.bands[:count],
    )


def _local_power(history: Array, stride: int, hop: int) -> Array:
    """Power of a history about each coefficient [m²], shape (frames, hop)."""
    power = analyse(history[::stride], hop) ** 2
    return _average_neighbours(power)


def _following(command: Array, step: float, stride: int, hop: int) -> Array:
    velocity = np.gradient(command, step)
    powers = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, command.size), _DEGREE).T
    rows = [np.gradient(velocity, step), *(powers * command), *(powers * velocity)]
    following = np.stack([analyse(row[::stride], hop) for row in rows])
    following /= np.sqrt(np.mean(following**2, axis=(1, 2), keepdims=True))
    return np.asarray(following)


def _rounding(
    motion: Array, measured_displacement: Array, noise: SensorNoise, stride: int, hop: int
) -> tuple[Array, SensorNoise]:
    """Variance of the rounding noise in each coefficient [m²], and the noise that is not rounding."""
    step = coarse_step(measured_displacement, noise)
    if step == 0.0:
        return np.zeros((1, hop)), noise
    powers, floors = [], []
    for variant in vary_rounding(motion, step):
        powers.append(analyse(noise.smooth(variant)[::stride], hop) ** 2)
        floors.append(white_floor(variant))
    power = _average_neighbours(np.mean(powers, axis=0))
    weights = np.zeros_like(noise.weights)
    weights[0] = max(noise.weights[0] - float(np.mean(floors)), 0.0)
    return power, replace(noise, weights=weights)


def _average_neighbours(power: Array) -> Array:
    """Average the power of each coefficient in both axes with those beside it, which count by half."""
    for _ in power.shape:
        extended = np.concatenate([power[:1], power, power[-1:]])
        power = np.asarray(power * 0.5 + (extended[:-2] + extended[2:]) * 0.25).T
    return power


def coarse_step(measured_displacement: Array, noise: SensorNoise) -> float:
    """Step of the converter [m] whose rounding is no white noise; zero where there is none, or it is."""
    step = converter_step(measured_displacement) if noise.resolution is None else noise.resolution
    return 0.0 if noise.weights[0] >= _DITHER_SHARE * step**2 / 12.0 else step


def _bands(hop: int) -> NDArray[np.int64]:
    """Return the band of each coefficient; bands are equally wide on a logarithmic axis."""
    octaves = np.log2(2.0 * np.arange(hop) + 1.0)
    return np.asarray(np.unique(np.floor(_BANDS_IN_OCTAVE * octaves), return_inverse=True)[1])


def _steps(places: Array, scale: float) -> Array:
    """Probability of a state after another one, shape (states, states)."""
    laplace = np.exp(-np.abs(places[:, np.newaxis] - places) / scale)
    return np.asarray((1.0 - _JUMP) * laplace / laplace.sum(axis=1, keepdims=True) + _JUMP / places.size)


def _chain(factors: int) -> tuple[Array, Array]:
    """Return the steps from band to band of the level, and of the factor of the slow noise."""
    return _steps(_LEVELS, _STEP), _steps(np.arange(factors, dtype=np.float64), _FACTOR_STEP)


def _normal_equations(reading: Reading, variance: Array) -> tuple[Array, Array]:
    """Matrix and right side of the least squares for each variance, (draws, rows, rows) and (draws, rows)."""
    rows = reading.following.shape[0]
    following = reading.following.reshape(rows, -1)
    columns = np.concatenate([following, reading.observed.reshape(1, -1)]).T
    tables = np.empty((len(variance), rows, rows + 1))
    for table, weights in zip(tables, 1.0 / variance.reshape(len(variance), -1), strict=True):
        table[:] = (following * weights) @ columns
    return tables[:, :, :rows], tables[:, :, rows]


def _least_squares(reading: Reading, variance: Array) -> tuple[Array, Array]:
    """Coefficients of what follows the command for each variance, and roots of their covariances."""
    normal, right = _normal_equations(reading, variance)
    values, vectors = np.linalg.eigh(normal)
    inverse = np.divide(1.0, values, out=np.zeros_like(values), where=values > _SINGULAR * values[:, -1:])
    roots = vectors * np.sqrt(inverse)[:, np.newaxis]
    return np.einsum("dij,dkj,dk->di", roots, roots, right), roots


def _follow(reading: Reading, variance: Array, generator: np.random.Generator) -> tuple[Array, Array]:
    """Draw coefficients of what follows the command, with standard normal numbers for all else."""
    rows = reading.following.shape[0]
    uniform, normal = np.empty((len(variance), rows)), np.empty((len(variance), rows + variance[0].size))
    for places, numbers in zip(uniform, normal, strict=True):
        if reading.largest is not None:
            places[:] = generator.uniform(size=rows)
        numbers[:] = generator.standard_normal(numbers.size)
    scatter = normal[:, rows:].reshape(variance.shape)
    if reading.largest is None:
        mean, roots = _least_squares(reading, variance)
        return mean + np.einsum("dij,dj->di", roots, normal[:, :rows]), scatter
    equations = _normal_equations(reading, variance)
    follows = [
        _draw_limited_coefficients(matrix, right, reading.largest, *numbers)
        for matrix, right, *numbers in zip(*equations, uniform, normal[:, :rows], strict=True)
    ]
    return np.array(follows), scatter


def _draw_limited_coefficients(
    normal: Array, right: Array, largest: float, uniform: Array, scatter: Array
) -> Array:
    """Draw coefficients of unknown sizes from the normal equations of their least squares."""
    rows = right.size
    normal[np.diag_indices(rows)] *= 1.0 + _SINGULAR
    root = np.linalg.cholesky(normal)
    # of rows made orthogonal one after the other, each with the noise's deviation of one
    orthogonal_coefficients = scipy.linalg.solve_triangular(root, right, lower=True)
    spread = (np.diag(root) * largest)[:, np.newaxis] * _SIZES
    likelihood = -0.5 * (
        np.log(1.0 + spread**2) + orthogonal_coefficients[:, np.newaxis] ** 2 / (1.0 + spread**2)
    )
    sums = np.cumsum(np.exp(likelihood - likelihood.max(axis=1, keepdims=True)), axis=1)
    coefficients = uniform[:, np.newaxis] * sums[:, -1:]
    size_places = np.minimum((sums < coefficients).sum(axis=1), _SIZES.size - 1)
    square = spread[np.arange(rows), size_places] ** 2
    share = square / (1.0 + square)
    coefficients = share * orthogonal_coefficients + np.sqrt(share) * scatter
    return np.asarray(scipy.linalg.solve_triangular(root, coefficients, lower=True, trans="T"))


def _filter_forwards(reading: Reading, follows: Array) -> Array:
    """Probabilities of levels and factors by the bands so far, shape (bands, levels, factors)."""
    residual = reading.observed - np.tensordot(follows, reading.following, axes=1)
    power, noise = np.ascontiguousarray(reading.command_power), np.ascontiguousarray(reading.noise)
    factors = noise.shape[0]
    level_steps, factor_steps = _chain(factors)
    prior = np.full((_LEVELS.size, factors), 1.0 / (_LEVELS.size * factors))
    probabilities = []
    edges = np.searchsorted(reading.bands, np.arange(int(reading.bands[-1]) + 2))
    for band in pairwise(edges.tolist()):
        likelihood = level_likelihood(residual, power, noise, band, np.exp(_LEVELS), _LEAST_COMMAND)
        joint = prior * np.exp(likelihood - likelihood.max())
        probabilities.append(joint / joint.sum())
        prior = level_steps.T @ probabilities[-1] @ factor_steps
    return np.array(probabilities)


def _draw(
    reading: Reading, forward_probabilities: Array, histories: Array, generator: np.random.Generator
) -> None:
    """Draw levels and factors, then what follows the command, then the rest."""
    draws, size = histories.shape
    for some, power, variance in _powers(reading, forward_probabilities, draws, generator):
        total = power + variance
        share = power / total
        follows, coefficients = _follow(reading, total, generator)
        following_part = np.tensordot(follows, reading.following, axes=1)
        coefficients *= np.sqrt(share * variance)
        coefficients += following_part
        share *= reading.observed - following_part
        coefficients += share
        histories[some] = synthesise(_append_undrawn(reading, coefficients), size)


def _draw_following(reading: Reading, forward_probabilities: Array, generator: np.random.Generator) -> Array:
    """Draw coefficients of what follows the command alone, shape (draws, rows)."""
    powers = _powers(reading, forward_probabilities, _DRAWS_OF_FOLLOWING, generator)
    return np.concatenate([_follow(reading, power + variance, generator)[0] for _, power, variance in powers])


def _powers(
    reading: Reading, forward_probabilities: Array, draws: int, generator: np.random.Generator
) -> Iterator[tuple[slice, Array, Array]]:
    """Places of some draws with their powers of what remains and variances of their noise [m²]."""
    bands, _, factors = forward_probabilities.shape
    levels, places = np.divmod(
        sample_backwards(forward_probabilities, *_chain(factors), generator.uniform(size=(bands, draws))),
        factors,
    )
    jitter = _GRID * (generator.uniform(size=levels.shape) - 0.5)
    level = np.exp(_LEVELS[levels] + jitter)[:, reading.bands]
    for first in range(0, draws, _DRAWS_IN_MEMORY):
        some = slice(first, first + _DRAWS_IN_MEMORY)
        variance = _variance(reading, places[some])
        least = _LEAST_COMMAND * variance
        yield some, level[some, np.newaxis] * np.maximum(reading.command_power, least), variance


def _append_undrawn(reading: Reading, coefficients: Array) -> Array:
    """Put drawn coefficients and those that are not drawn side by side, shape (draws, frames, hop)."""
    if not reading.undrawn.size:
        return coefficients
    undrawn = np.broadcast_to(reading.undrawn, (len(coefficients), *reading.undrawn.shape))
    return np.concatenate([coefficients, undrawn], axis=-1)


def _variance(reading: Reading, places: NDArray[np.int64]) -> Array:
    """Variances of the noise with factors drawn for each band, shape (draws, frames or 1, hop)."""
    factors = np.moveaxis(reading.noise, 1, 2)[places[:, reading.bands], np.arange(reading.bands.size)]
    return np.ascontiguousarray(np.moveaxis(factors, 1, 2))
