"""Likelihood of the level of an actuator's remaining error in a band of frequencies."""

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled

_FACTORS_OF_A_LOGARITHM = 8  # each below 1e25, so that their product stays finite


@compiled
def level_likelihood(rest: Array, command_power: Array, noise: Array, levels: Array, least: float) -> Array:
    """Logarithm of the likelihood of each level, for each of several spectra of the noise.

    `rest` [m]; `command_power`, `noise` [m²]; `levels`, `least` [-].
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
            for k in range(rest.shape[1]):
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
