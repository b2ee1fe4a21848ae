"""Level of an actuator's remaining error in bands of frequencies: its likelihood, and draws of it."""

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.compiled import compiled

_FACTORS_OF_A_LOGARITHM = 8  # each below 1e25, so that their product stays finite


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
