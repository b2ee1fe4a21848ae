"""Likelihood of levels, against the normal density."""

import numpy as np
import pytest
from scipy.stats import norm

from reliab.assessment.rebuilt_error.difference_draws import level_likelihood

LEVELS = np.array([1e-8, 1e-3, 1.0, 1e3])


@pytest.mark.parametrize("frames_of_noise", [1, 5])
@pytest.mark.parametrize("coefficients", [1, 7, 19])
def test_likelihood_equals_normal_coefficients(frames_of_noise, coefficients):
    rng = np.random.default_rng(coefficients)
    size, band = coefficients + 5, slice(2, 2 + coefficients)
    remainder = rng.normal(size=(5, size))
    power = rng.exponential(size=(5, size)) * 10.0 ** rng.uniform(-6, 6, (5, size))
    noise = rng.exponential(size=(3, frames_of_noise, size)) + 1e-3
    result = level_likelihood(remainder, power, noise, (band.start, band.stop), LEVELS, 0.01)
    remainder, power, noise = remainder[:, band], power[:, band], noise[:, :, band]
    for place, level in enumerate(LEVELS):
        variance = level * np.maximum(power, 0.01 * noise) + noise
        expected = norm.logpdf(remainder, scale=np.sqrt(variance)).sum(axis=(1, 2))
        constant = 0.5 * np.log(2.0 * np.pi) * remainder.size
        np.testing.assert_allclose(result[place], expected + constant, rtol=1e-10)


def test_a_motion_far_above_the_noise_stays_finite():
    shape = (4, 50)
    noise = np.full((1, 1, 50), 1e-20)
    result = level_likelihood(np.ones(shape), np.full(shape, 1.0), noise, (0, 50), LEVELS, 0.01)
    assert np.isfinite(result).all()
