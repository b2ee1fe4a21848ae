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
_AT_ONCE = 16  # draws whose coefficients are in memory together
_SIZES = np.exp(np.arange(np.log(1e-5), np.log(3.0), 0.5))  # of coefficients, over that of the command
_LEAST_PASSED = 0.01  # of the noise: above the band the filter leaves less than neighbours leak
_ROUNDING = 1e-20  # of the command's largest power
_DITHERED = 0.9  # of Δ²/12: more white noise than that makes rounding white too


@compiled
def level_likelihood(
    rest: Array, command_power: Array, noise: Array, band: tuple[int, int], levels: Array, least: float
) -> Array:
    """Logarithm of the likelihood of each level, for each of several spectra of the noise.

    `rest` [m]; `command_power`, `noise` [m²]; `band`: its first coefficient and the one after its last;
    `levels`, `least` [-].
    Returns sums of −(ln v + r²/v)/2 with v = q P + s over the coefficients, shape (levels, factors).
    """
    factors, frames, _ = noise.shape
    count = levels.size
    likelihood = np.zeros((count, factors))
    product, quadratic, logarithm = np.empty((3, count))
    for factor in range(factors):
        common, held = 0.0, 0
        for level in range(count):
            product[level], quadratic[level], logarithm[level] = 1.0, 0.0, 0.0
        for frame in range(rest.shape[0]):
            for k in range(band[0], band[1]):
                variance = noise[factor, frame if frames > 1 else 0, k]
                ratio = max(command_power[frame, k] / variance, least)
                square = rest[frame, k] ** 2 / variance
                common += np.log(variance)
                for level in range(count):
                    total = 1.0 + levels[level] * ratio
                    product[level] *= total
                    quadratic[level] += square / total
                held += 1
                if held == _FACTORS_OF_A_LOGARITHM:
                    for level in range(count):
                        logarithm[level] += np.log(product[level])
                        product[level] = 1.0
                    held = 0
        for level in range(count):
            logarithm[level] += np.log(product[level])
            likelihood[level, factor] = -0.5 * (common + logarithm[level] + quadratic[level])
    return likelihood


@compiled
def sample_backwards(filtered: Array, of_level: Array, of_factor: Array, uniform: Array) -> NDArray[np.int64]:
    """Draw the levels and factors of all bands, from the last one to the first.

    `filtered`: probabilities by the bands so far, shape (bands, levels, factors); `of_level`, `of_factor`:
    steps to the next band; `uniform`: numbers between 0 and 1, shape (bands, draws).
    Returns places in the flattened levels and factors, shape (draws, bands).
    """
    bands, levels, factors = filtered.shape
    drawn = np.empty((uniform.shape[1], bands), dtype=np.int64)
    sums, part = np.empty(levels), np.empty(factors)
    for draw in range(drawn.shape[0]):
        for back in range(bands):
            band = bands - 1 - back
            after = drawn[draw, band + 1] if back > 0 else 0
            whole = 0.0
            for factor in range(factors):
                part[factor] = of_factor[factor, after % factors] if back > 0 else 1.0
            for level in range(levels):
                one = 0.0
                for factor in range(factors):
                    one += filtered[band, level, factor] * part[factor]
                whole += one * of_level[level, after // factors] if back > 0 else one
                sums[level] = whole
            sought = uniform[back, draw] * whole
            level = 0
            while level < levels - 1 and sums[level] < sought:
                level += 1
            reached = sums[level - 1] if level > 0 else 0.0
            factor = -1
            step = of_level[level, after // factors] if back > 0 else 1.0
            while factor < factors - 1 and (factor < 0 or reached < sought):
                factor += 1
                reached += filtered[band, level, factor] * part[factor] * step
            drawn[draw, band] = level * factors + factor
    return drawn


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
    beyond: Array = field(default_factory=lambda: np.zeros((1, 0)))  # Observed above what is drawn [m]


def draw_differences(
    command: Array,
    measured: Array,
    noise: SensorNoise,
    frequency: float,
    every: int,
    draws: int,
    seed: int,
    others: Array | None = None,
    *,
    highest: float = np.inf,
) -> Array:
    """Draw histories of x_c − x_m.

    `command`, `measured` [m]; `frequency` [Hz]; `others`: commands of further actuators that move this one
    too, shape (others, n); `highest`: frequency [Hz] above which the reading holds nothing to draw.
    Returns x_c − x_m [m] at each `every`-th sample, shape (draws, ceil(n/every)); rows 0, 2, … assume that
    there is no slow noise.
    """
    generator = np.random.default_rng(seed)
    thin = replace(noise, band=min(noise.band, 0.27 / (every * noise.time_step)))
    reading = _reading(command, measured, thin, frequency, every)
    if others is not None and len(others):
        reading = _beside_others(reading, thin.smooth(others), noise.time_step, every)
    reading = _below(reading, highest * every * noise.time_step)
    actuators = replace(reading, noise=reading.noise[:1])
    histories = np.empty((draws, -(-command.size // every)))
    with one_thread():
        _draw_twice(actuators, histories[::2], generator)
        _draw_twice(reading, histories[1::2], generator)
    return histories


def _draw_twice(reading: Reading, histories: Array, generator: np.random.Generator) -> None:
    """Draw histories; levels of the remainder follow from draws of the part that follows the command."""
    level = _FIRST_LEVEL if reading.largest is None else 0.0  # many coefficients: first as if they said all
    variance = np.broadcast_to(reading.noise[-1] + level * reading.command_power, reading.observed.shape)
    first = _least_squares(reading, variance[np.newaxis])[0][0]
    follows = _draw_following(reading, _filtered(reading, first), generator)
    _draw(reading, _filtered(reading, follows.mean(axis=0)), histories, generator)


def _reading(command: Array, measured: Array, noise: SensorNoise, frequency: float, every: int) -> Reading:
    step = every * noise.time_step
    told = noise.smooth(command)  # as the difference is, which would else follow what was taken from it
    smooth = told - noise.smooth(measured)
    size = -(-command.size // every)
    periods = max(frequency * step * size, 1.0)  # of the structure in the test
    half = min(round(_PERIODS_OF_HOP * size / (2.0 * periods)), size // (2 * _FEWEST_FRAMES))
    hop = 2 * max(half, 1)
    observed = analyse(smooth[::every], hop)
    power = _local_power(told, every, hop)
    places: Array = (np.arange(hop, dtype=np.float64) + 0.5) / (2.0 * hop * step)
    rounding, rest = _rounding(command, measured, noise, every, hop)
    white = replace(rest, weights=rest.weights * (np.arange(rest.weights.size) == 0)).passed(places) / every
    slow = rest.passed(places) / every - white
    factors = _FACTORS if slow.any() else np.ones(1)
    quick = rounding + white
    least = max(_ROUNDING * float(power.max()), _LEAST_PASSED * float(quick.max()))
    variances = np.maximum(quick, least) + factors[:, np.newaxis, np.newaxis] * np.maximum(slow, 0.0)
    return Reading(
        observed=observed,
        following=_following(told, noise.time_step, every, hop),
        command_power=power,
        noise=variances,
        bands=_bands(hop),
    )


def _beside_others(reading: Reading, others: Array, step: float, every: int) -> Reading:
    """Let x_c − x_m follow the commands of other actuators too, and be about proportional to all."""
    hop = reading.bands.size
    powers = [reading.command_power, *(_local_power(other, every, hop) for other in others)]
    scaled = [power / max(float(power.mean()), np.finfo(float).tiny) for power in powers]
    size = float(reading.command_power.mean() + np.mean(reading.observed**2))
    of_others = [_following(other, step, every, hop)[1:] for other in others]  # without accelerations
    return replace(
        reading,
        command_power=size * np.mean(scaled, axis=0),
        following=np.concatenate([reading.following, *of_others])[_by_importance(len(others))],
        largest=float(np.sqrt(size)),
    )


def _by_importance(others: int) -> NDArray[np.int64]:
    """Order of the rows: gains and delays, lag, then what changes in time."""
    powers = _DEGREE + 1
    rows = np.arange(1 + 2 * powers * (1 + others))
    constant = (rows > 0) & ((rows - 1) % powers == 0)
    return np.asarray(np.concatenate([rows[constant], rows[:1], rows[~constant][1:]]))


def _below(reading: Reading, highest: float) -> Reading:
    """Leave undrawn what lies above a frequency, in cycles per step."""
    hop = reading.bands.size
    drawn = int(np.clip(np.ceil(2.0 * hop * highest), 1, hop)) if np.isfinite(highest) else hop
    return replace(
        reading,
        observed=np.ascontiguousarray(reading.observed[:, :drawn]),
        beyond=reading.observed[:, drawn:],
        following=np.ascontiguousarray(reading.following[..., :drawn]),
        command_power=np.ascontiguousarray(reading.command_power[:, :drawn]),
        noise=np.ascontiguousarray(reading.noise[..., :drawn]),
        bands=reading.bands[:drawn],
    )


def _local_power(history: Array, every: int, hop: int) -> Array:
    """Power of a history about each coefficient [m²], shape (frames, hop)."""
    power = analyse(history[::every], hop) ** 2
    return _with_neighbours(power)


def _following(command: Array, step: float, every: int, hop: int) -> Array:
    velocity = np.gradient(command, step)
    powers = np.polynomial.legendre.legvander(np.linspace(-1.0, 1.0, command.size), _DEGREE).T
    rows = [np.gradient(velocity, step), *(powers * command), *(powers * velocity)]
    following = np.stack([analyse(row[::every], hop) for row in rows])
    following /= np.sqrt(np.mean(following**2, axis=(1, 2), keepdims=True))
    return np.asarray(following)


def _rounding(
    motion: Array, measured: Array, noise: SensorNoise, every: int, hop: int
) -> tuple[Array, SensorNoise]:
    """Variance of the rounding noise in each coefficient [m²], and the noise that is not rounding."""
    step = coarse_step(measured, noise)
    if step == 0.0:
        return np.zeros((1, hop)), noise
    powers, floors = [], []
    for rounded in vary_rounding(motion, step):
        powers.append(analyse(noise.smooth(rounded)[::every], hop) ** 2)
        floors.append(white_floor(rounded))
    power = _with_neighbours(np.mean(powers, axis=0))
    weights = np.zeros_like(noise.weights)
    weights[0] = max(noise.weights[0] - float(np.mean(floors)), 0.0)
    return power, replace(noise, weights=weights)


def _with_neighbours(power: Array) -> Array:
    """Average the power of each coefficient in both axes with those beside it, which count by half."""
    for _ in power.shape:
        beside = np.concatenate([power[:1], power, power[-1:]])
        power = np.asarray(power * 0.5 + (beside[:-2] + beside[2:]) * 0.25).T
    return power


def coarse_step(measured: Array, noise: SensorNoise) -> float:
    """Step of the converter [m] whose rounding is no white noise; zero where there is none, or it is."""
    step = converter_step(measured) if noise.resolution is None else noise.resolution
    return 0.0 if noise.weights[0] >= _DITHERED * step**2 / 12.0 else step


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
    scattered = normal[:, rows:].reshape(variance.shape)
    if reading.largest is None:
        mean, roots = _least_squares(reading, variance)
        return mean + np.einsum("dij,dj->di", roots, normal[:, :rows]), scattered
    equations = _normal_equations(reading, variance)
    follows = [
        _limited(matrix, right, reading.largest, *numbers)
        for matrix, right, *numbers in zip(*equations, uniform, normal[:, :rows], strict=True)
    ]
    return np.array(follows), scattered


def _limited(normal: Array, right: Array, largest: float, uniform: Array, scatter: Array) -> Array:
    """Draw coefficients of unknown sizes from the normal equations of their least squares."""
    rows = right.size
    normal[np.diag_indices(rows)] *= 1.0 + _SINGULAR
    root = np.linalg.cholesky(normal)
    # of rows made orthogonal one after the other, each with the noise's deviation of one
    found = scipy.linalg.solve_triangular(root, right, lower=True)
    spread = (np.diag(root) * largest)[:, np.newaxis] * _SIZES
    likelihood = -0.5 * (np.log(1.0 + spread**2) + found[:, np.newaxis] ** 2 / (1.0 + spread**2))
    sums = np.cumsum(np.exp(likelihood - likelihood.max(axis=1, keepdims=True)), axis=1)
    drawn = uniform[:, np.newaxis] * sums[:, -1:]
    chosen = np.minimum((sums < drawn).sum(axis=1), _SIZES.size - 1)
    square = spread[np.arange(rows), chosen] ** 2
    share = square / (1.0 + square)
    drawn = share * found + np.sqrt(share) * scatter
    return np.asarray(scipy.linalg.solve_triangular(root, drawn, lower=True, trans="T"))


def _filtered(reading: Reading, follows: Array) -> Array:
    """Probabilities of levels and factors by the bands so far, shape (bands, levels, factors)."""
    rest = reading.observed - np.tensordot(follows, reading.following, axes=1)
    power, noise = np.ascontiguousarray(reading.command_power), np.ascontiguousarray(reading.noise)
    factors = noise.shape[0]
    of_level, of_factor = _chain(factors)
    before = np.full((_LEVELS.size, factors), 1.0 / (_LEVELS.size * factors))
    filtered = []
    edges = np.searchsorted(reading.bands, np.arange(int(reading.bands[-1]) + 2))
    for band in pairwise(edges.tolist()):
        likelihood = level_likelihood(rest, power, noise, band, np.exp(_LEVELS), _LEAST_COMMAND)
        joint = before * np.exp(likelihood - likelihood.max())
        filtered.append(joint / joint.sum())
        before = of_level.T @ filtered[-1] @ of_factor
    return np.array(filtered)


def _draw(reading: Reading, filtered: Array, histories: Array, generator: np.random.Generator) -> None:
    """Draw levels and factors, then what follows the command, then the rest."""
    draws, size = histories.shape
    for some, power, variance in _powers(reading, filtered, draws, generator):
        total = power + variance
        share = power / total
        follows, coefficients = _follow(reading, total, generator)
        followed = np.tensordot(follows, reading.following, axes=1)
        coefficients *= np.sqrt(share * variance)
        coefficients += followed
        share *= reading.observed - followed
        coefficients += share
        histories[some] = synthesise(_with_beyond(reading, coefficients), size)


def _draw_following(reading: Reading, filtered: Array, generator: np.random.Generator) -> Array:
    """Draw coefficients of what follows the command alone, shape (draws, rows)."""
    powers = _powers(reading, filtered, _DRAWS_OF_FOLLOWING, generator)
    return np.concatenate([_follow(reading, power + variance, generator)[0] for _, power, variance in powers])


def _powers(
    reading: Reading, filtered: Array, draws: int, generator: np.random.Generator
) -> Iterator[tuple[slice, Array, Array]]:
    """Places of some draws with their powers of what remains and variances of their noise [m²]."""
    bands, _, factors = filtered.shape
    levels, places = np.divmod(
        sample_backwards(filtered, *_chain(factors), generator.uniform(size=(bands, draws))), factors
    )
    within = _GRID * (generator.uniform(size=levels.shape) - 0.5)
    level = np.exp(_LEVELS[levels] + within)[:, reading.bands]
    for first in range(0, draws, _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        variance = _variance(reading, places[some])
        least = _LEAST_COMMAND * variance
        yield some, level[some, np.newaxis] * np.maximum(reading.command_power, least), variance


def _with_beyond(reading: Reading, coefficients: Array) -> Array:
    """Put drawn coefficients and those that are not drawn side by side, shape (draws, frames, hop)."""
    if not reading.beyond.size:
        return coefficients
    beyond = np.broadcast_to(reading.beyond, (len(coefficients), *reading.beyond.shape))
    return np.concatenate([coefficients, beyond], axis=-1)


def _variance(reading: Reading, places: NDArray[np.int64]) -> Array:
    """Variances of the noise with factors drawn for each band, shape (draws, frames or 1, hop)."""
    factors = np.moveaxis(reading.noise, 1, 2)[places[:, reading.bands], np.arange(reading.bands.size)]
    return np.ascontiguousarray(np.moveaxis(factors, 1, 2))
