"""Draws of x_c − x_m, against the definitions of their chain and of their noise."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
import scipy

from reliab.assessment.rebuilt_error.difference_draws import (
    _FACTORS,
    _LEVELS,
    _bands,
    _chain,
    _draw,
    _draw_following,
    _filter_forwards,
    _follow,
    _following,
    _least_squares,
    _reading,
    _rounding,
    _steps,
    draw_differences,
    sample_backwards,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.signals.lapped_transform import analyse, synthesise

STEP = 1.0 / 256.0
SIZE = 4000
TIME = STEP * np.arange(SIZE)
COMMAND = (
    0.02 * np.sin(2.0 * np.pi * 1.1 * TIME + 2.0 * np.sin(0.3 * TIME)) * np.sin(np.pi * TIME / 16.0) ** 2
)


def sensor(white=0.0, slow=0.0, band=12.0):
    weights = np.array([white**2, 0.0, 0.0, slow**2, 0.0, 0.0])
    return SensorNoise(time_step=STEP, weights=weights, band=band)


def noise_of(sensor_noise, seed):
    """White noise and first-order autoregressive noise with the sensor's levels."""
    rng = np.random.default_rng(seed)
    rho = np.exp(-2.0 * np.pi * 3.0 * STEP)
    pushes = (1.0 - rho) * np.sqrt(sensor_noise.weights[3]) * rng.standard_normal(SIZE + 2048)
    slow = scipy.signal.lfilter([1.0], [1.0, -rho], pushes)[2048:]
    return sensor_noise.white * rng.standard_normal(SIZE) + slow


@pytest.mark.parametrize("stride", [1, 4])
def test_variances_of_coefficients_are_those_of_filtered_noise(stride):
    noise = sensor(white=1e-4, slow=2e-3)
    reading = _reading(COMMAND, COMMAND, noise, 1.1, stride)
    hop = reading.observed.shape[1]
    stated_values = reading.noise[_FACTORS.tolist().index(1.0), 0]
    powers = [
        np.mean(analyse(noise.smooth(noise_of(noise, seed))[::stride], hop)[1:-2] ** 2, axis=0)
        for seed in range(60)
    ]
    frequency = (np.arange(hop) + 0.5) / (2.0 * hop * STEP * stride)
    read = (frequency > 0.5) & (frequency < 12.0)
    groups = np.array_split(np.flatnonzero(read), 6)
    result = [np.mean(powers, axis=0)[group].mean() for group in groups]
    assert result == pytest.approx([stated_values[group].mean() for group in groups], rel=0.1)
    # without slow noise the first factor remains
    assert reading.noise[0, 0][read] == pytest.approx(np.full(read.sum(), 1e-8 / stride), rel=0.05)


def test_a_hop_is_four_periods_and_a_quarter_of_the_record_at_most():
    noise = sensor(white=1e-4)
    for frequency, stride, hop in ((2.0, 1, 512), (2.0, 4, 128), (0.1, 1, 1000), (0.5, 1, 1000)):
        assert _reading(COMMAND, COMMAND, noise, frequency, stride).observed.shape[1] == hop


def test_bands_are_sixths_of_an_octave():
    bands = _bands(600)
    place = 2.0 * np.arange(600) + 1.0
    for band in np.unique(bands):
        is_inside = place[bands == band]
        assert is_inside[-1] / is_inside[0] < 2.0 ** (1.0 / 6.0)
    assert bands[0] == 0
    assert set(np.diff(bands)) <= {0, 1}
    octave = bands[np.searchsorted(place, 801.0)] - bands[np.searchsorted(place, 401.0)]
    assert octave == 6


def test_steps_are_laplace_with_a_jump_now_and_then():
    places = np.array([0.0, 0.3, 0.9, 4.0])
    steps = _steps(places, 0.5)
    assert steps.sum(axis=1) == pytest.approx(np.ones(4))
    weights = np.exp(-np.abs(places[1] - places) / 0.5)
    assert steps[1] == pytest.approx(0.98 * weights / weights.sum() + 0.02 / 4)


def small_reading(seed=3):
    """A reading of few coefficients in three bands, with two factors of slow noise."""
    noise = sensor(white=1e-4)
    reading = _reading(COMMAND[:400], COMMAND[:400] + noise_of(noise, seed)[:400], noise, 40.0, 10)
    kept_part = np.unique(reading.bands[:3])
    is_inside = np.isin(reading.bands, kept_part)
    variant = {
        "observed": reading.observed[:, is_inside],
        "following": reading.following[:, :, is_inside],
        "command_power": reading.command_power[:, is_inside],
        "noise": np.stack([reading.noise[0][:, is_inside], 5.0 * reading.noise[0][:, is_inside]]),
        "bands": np.unique(reading.bands[is_inside], return_inverse=True)[1],
    }
    return type(reading)(**variant)


def test_probabilities_by_the_bands_so_far_are_sums_over_all_paths():
    """Forward filtering against the sum over every path of levels and factors, in logarithms."""
    reading = small_reading()
    follows = np.zeros(reading.following.shape[0])
    result = _filter_forwards(reading, follows)
    bands, levels, factors = result.shape
    assert factors == 2
    level_steps, factor_steps = _chain(factors)
    density = np.zeros((bands, levels, factors))
    for band, level, factor in product(range(bands), range(levels), range(factors)):
        is_inside = reading.bands == band
        noise = reading.noise[factor][:, is_inside]
        power = np.exp(_LEVELS[level]) * np.maximum(reading.command_power[:, is_inside], 0.01 * noise)
        density[band, level, factor] = scipy.stats.norm.logpdf(
            reading.observed[:, is_inside], scale=np.sqrt(power + noise)
        ).sum()
    joint = np.exp(density[0] - density[0].max())
    for band in range(bands):
        if band:
            displacement = np.einsum("lf,lm,fg->mg", joint, level_steps, factor_steps)
            joint = displacement * np.exp(density[band] - density[band].max())
        assert result[band] == pytest.approx(joint / joint.sum(), abs=1e-9)


def condition_on_next(filter_output, steps):
    """Probabilities of a band given the next one, (levels, factors, levels, factors)."""
    weights = filter_output[:, :, np.newaxis, np.newaxis] * steps
    return weights / weights.sum(axis=(0, 1))


def correlation(joint):
    """Correlation of the levels of two bands by their joint probability."""
    first, second = joint.sum(axis=1), joint.sum(axis=0)
    means = first @ _LEVELS, second @ _LEVELS
    squares = first @ _LEVELS**2 - means[0] ** 2, second @ _LEVELS**2 - means[1] ** 2
    return (_LEVELS @ joint @ _LEVELS - means[0] * means[1]) / np.sqrt(squares[0] * squares[1])


def test_levels_and_factors_are_drawn_by_their_joint_probability():
    """Backward sampling: each band given the next one, from probabilities so wide that steps matter."""
    filter_output = np.random.default_rng(2).uniform(size=(3, _LEVELS.size, 2))
    level_steps, factor_steps = _chain(2)
    steps = np.einsum("lm,fg->lfmg", level_steps, factor_steps)
    joint = [filter_output[-1] / filter_output[-1].sum()]
    for band in (1, 0):
        joint.append(np.einsum("lfmg,mg->lf", condition_on_next(filter_output[band], steps), joint[-1]))

    uniform = np.random.default_rng(5).uniform(size=(3, 4000))
    selection = sample_backwards(filter_output, level_steps, factor_steps, uniform).T[::-1]
    for places, expected in zip(selection, joint, strict=True):  # from the last band to the first
        count = np.bincount(places, minlength=expected.size)
        assert scipy.stats.chisquare(count, 4000.0 * expected.ravel()).pvalue > 1e-3
    combined_result = np.corrcoef(_LEVELS[selection[0] // 2], _LEVELS[selection[1] // 2])[0, 1]
    level = np.einsum("lfmg,mg->lm", condition_on_next(filter_output[1], steps), joint[0])
    assert combined_result == pytest.approx(correlation(level), abs=4.0 / np.sqrt(4000.0))


def test_a_draw_without_chance_is_the_mean_given_the_median_level():
    """In one band: what follows the command, and of the rest the share q P/(q P + s)."""

    class Middle:
        """A generator whose numbers are all the median."""

        uniform = staticmethod(lambda size: np.full(size, 0.5))
        standard_normal = staticmethod(np.zeros)

    has_several = small_reading()
    reading = replace(has_several, noise=has_several.noise[:1], bands=np.zeros_like(has_several.bands))
    filter_output = _filter_forwards(reading, np.zeros(reading.following.shape[0]))
    histories = np.empty((1, 40))
    _draw(reading, filter_output, histories, Middle())
    follows = _draw_following(reading, filter_output, Middle())[0]
    level = np.exp(_LEVELS[np.searchsorted(np.cumsum(filter_output[0, :, 0]), 0.5)])
    noise = np.broadcast_to(reading.noise[0], reading.observed.shape)
    power = level * np.maximum(reading.command_power, 0.01 * noise)
    expected = _least_squares(reading, (power + noise)[np.newaxis])[0][0]
    assert follows == pytest.approx(expected)
    following_part = np.tensordot(expected, reading.following, axes=1)
    full_test = following_part + power / (power + noise) * (reading.observed - following_part)
    assert histories == pytest.approx(synthesise(full_test[np.newaxis], 40))


def test_a_place_is_drawn_by_its_weight():
    weights = np.array([[[0.1, 0.0], [2.0, 0.9]]])
    uniform = np.random.default_rng(6).uniform(size=(1, 30_000))
    selection = sample_backwards(weights, np.ones((2, 2)), np.ones((2, 2)), uniform)
    shares = np.bincount(selection[:, 0], minlength=4) / 30_000
    assert shares == pytest.approx(np.array([0.1, 0.0, 2.0, 0.9]) / 3.0, abs=0.01)
    assert shares[1] == 0.0


def test_least_squares_have_their_closed_form():
    reading = _reading(COMMAND, 0.98 * COMMAND + noise_of(sensor(white=1e-4), 7), sensor(white=1e-4), 1.1, 2)
    variance = reading.noise[-1] + 1e-3 * reading.command_power
    (mean,), (root,) = _least_squares(reading, variance[np.newaxis])
    rows = reading.following.reshape(reading.following.shape[0], -1)
    weight = 1.0 / np.broadcast_to(variance, reading.observed.shape).ravel()
    covariance = np.linalg.inv((rows * weight) @ rows.T)
    assert root @ root.T == pytest.approx(covariance, rel=1e-5, abs=1e-7 * np.abs(covariance).max())
    assert mean == pytest.approx(covariance @ (rows * weight) @ reading.observed.ravel(), rel=1e-5, abs=1e-12)


def test_following_rows_are_acceleration_displacement_and_velocity_times_polynomials():
    following = _following(COMMAND, STEP, 2, 64)
    assert np.mean(following**2, axis=(1, 2)) == pytest.approx(np.ones(7))
    rate = np.gradient(COMMAND, STEP)
    place = np.linspace(-1.0, 1.0, SIZE)
    second = 0.5 * (3.0 * place**2 - 1.0)
    for row, history in zip(
        following,
        [np.gradient(rate, STEP), *(p * h for h in (COMMAND, rate) for p in (1.0, place, second))],
        strict=True,
    ):
        expected = analyse(history[::2], 64)
        assert row == pytest.approx(expected / np.sqrt(np.mean(expected**2)))


def test_draws_average_to_the_truth_within_their_spread():
    """A known actuator in white noise: draws deviate from the truth by what they deviate from each other."""
    noise = sensor(white=2e-4)
    remainder = 2e-4 * np.sin(2.0 * np.pi * 2.3 * TIME) * np.sin(np.pi * TIME / 16.0) ** 2
    true = 0.02 * COMMAND + 0.004 * np.gradient(COMMAND, STEP) + remainder
    z = []
    for seed in range(6):
        read = COMMAND - true + noise_of(noise, 10 + seed)
        draws = draw_differences(COMMAND, read, noise, 1.1, 2, 48, seed)
        z.append((draws.mean(axis=0) - true[::2])[100:-100] / draws.std(axis=0)[100:-100])
    assert np.sqrt(np.mean(np.square(z))) == pytest.approx(1.0, abs=0.4)


@pytest.mark.parametrize("second", [False, True])
def test_a_gain_is_found_below_the_noise(second):
    """Filtered difference and unfiltered command would have nothing in common above the band."""
    noise = sensor(white=0.03 * COMMAND.std())
    measured_displacement = 0.99 * COMMAND + noise_of(noise, 5)
    rivals = 0.02 * np.sin(2.0 * np.pi * 1.7 * TIME)[np.newaxis] if second else None
    draws = draw_differences(COMMAND, measured_displacement, noise, 1.1, 4, 16, 0, rivals)
    truth = 0.01 * COMMAND[::4]
    assert np.mean((draws - truth) ** 2) < 0.12 * np.mean(truth**2)


def test_without_noise_the_reading_itself_is_drawn():
    quiet = sensor(white=1e-12)
    measured_displacement = np.interp(TIME - 0.004, TIME, COMMAND)
    draws = draw_differences(COMMAND, measured_displacement, quiet, 1.1, 3, 4, 1)
    smooth = quiet.smooth(COMMAND - measured_displacement)[::3]
    assert draws == pytest.approx(np.tile(smooth, (4, 1)), abs=1e-3 * np.abs(smooth).max())


@pytest.mark.parametrize(("swing", "white_left"), [(0.0, 0.5), (4e3, 0.0)])
def test_rounding_is_no_white_noise(swing, white_left):
    """Where a motion stands still rounding adds nothing; a fast one makes it white, step²/12."""
    step, variance = 0.01, 0.01**2 / 12.0
    motion = 0.3 + step * swing * np.random.default_rng(2).standard_normal(SIZE)
    levels = step * np.round(20.0 * np.sin(TIME))  # where the steps of the reading are seen
    noise = replace(sensor(slow=1.0, band=1e9), weights=np.array([0.5 * variance, 0.0, 0.0, 1.0, 0.0, 0.0]))
    power, remainder = _rounding(motion, levels, noise, 1, 32)
    assert remainder.weights == pytest.approx(
        [white_left * variance, 0.0, 0.0, 0.0, 0.0, 0.0], abs=0.02 * variance
    )
    if swing:
        assert power.mean() == pytest.approx(variance, rel=0.05)


def test_without_steps_or_with_enough_white_noise_rounding_is_left_out():
    smooth, stepped_response = COMMAND, 0.01 * np.round(COMMAND / 0.01)
    for measured_displacement, white in ((smooth, 1e-6), (stepped_response, 0.96 * 0.01 / np.sqrt(12.0))):
        power, remainder = _rounding(COMMAND, measured_displacement, sensor(white), 1, 32)
        assert not power.any()
        assert (remainder.weights == sensor(white).weights).all()


@pytest.mark.parametrize(("largest", "rel"), [(1e9, 1e-5), (1e-12, None)])
def test_coefficients_of_any_size_are_those_of_least_squares_and_of_no_size_zero(largest, rel):
    """Without chance; the noise differs from coefficient to coefficient."""

    class Middle:
        uniform = staticmethod(lambda size: np.full(size, 0.5))
        standard_normal = staticmethod(np.zeros)

    white = sensor(white=1e-4)
    reading = _reading(COMMAND, 0.98 * COMMAND + noise_of(white, 7), white, 1.1, 2)
    variance = reading.noise[-1] + 1e-3 * reading.command_power
    (result,), _ = _follow(replace(reading, largest=largest), variance[np.newaxis], Middle())
    expected = _least_squares(reading, variance[np.newaxis])[0][0]
    if rel is None:
        assert np.abs(result).max() < 1e-3 * np.abs(expected).max()
    else:
        assert result == pytest.approx(expected, rel=rel, abs=rel * np.abs(expected).max())
