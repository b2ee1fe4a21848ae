"""Residuals as coefficients over time and frequency, and the variances with which they are weighted.

A residual is transformed by an orthonormal lapped transform, so that noise that is stationary over a few
periods gives independent coefficients ("cells"). Their variance is a sum of a stationary part a(f) and a part
g(t) s(f) that follows the strength of the motion, both smooth in frequency, fitted by
expectation-maximisation.
"""

import numpy as np

from reliab.core.arrays import Array

_ITERATIONS = 20
_OCTAVE = 0.5  # octaves over which variances are smoothed
_BLOCKS = 1.0  # blocks of time over which the strength of the motion is smoothed
_QUIET = 0.3  # share of the blocks whose power counts as stationary at first
_LEAST = 1e-14  # of the mean power


def smooth_over_frequency(power: Array, width: float = _OCTAVE) -> Array:
    """Average powers over neighbouring frequencies, shape (…, k), about half an octave to each side."""
    place = np.log2(np.arange(power.shape[-1]) + 1.5)
    weight = np.exp(-0.5 * ((place[:, np.newaxis] - place) / width) ** 2)
    return np.asarray(power @ (weight / weight.sum(axis=1, keepdims=True)).T)


def smooth_over_time(power: Array, width: float = _BLOCKS) -> Array:
    """Average powers over neighbouring blocks, shape (J,)."""
    reach = int(4.0 * width)
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) / width) ** 2)
    total = np.convolve(power, weight)[reach : reach + power.size]
    return np.asarray(total / np.convolve(np.ones(power.size), weight)[reach : reach + power.size])


def fit_variances(power: Array, floor: float | None = None) -> tuple[Array, Array]:
    """Divide powers of cells, shape (J, k), into a stationary and a modulated variance, each of that shape.

    `floor`: the stationary variance, if it is known.
    """
    mean = float(power.mean())
    least = _LEAST * mean
    if mean == 0.0:
        return np.full(power.shape, np.finfo(float).tiny), np.zeros(power.shape)
    surrounding_power = smooth_over_frequency(
        np.quantile(power, _QUIET, axis=0) / _quantile_of_square(_QUIET)
    )
    still = (
        np.full(power.shape, floor)
        if floor is not None
        else np.tile(0.5 * surrounding_power, (power.shape[0], 1)) + least
    )
    strength = power.mean(axis=1) / mean + 1e-3
    shape = smooth_over_frequency(power.mean(axis=0))
    for _ in range(_ITERATIONS):
        motion_power = strength[:, np.newaxis] * shape
        total = still + motion_power + least
        share = motion_power / total
        mean_power = share**2 * power + share * still
        if floor is None:
            noise_share = still / total
            still = np.tile(
                smooth_over_frequency((noise_share**2 * power + noise_share * motion_power).mean(axis=0)),
                (power.shape[0], 1),
            )
        shape = smooth_over_frequency((mean_power / strength[:, np.newaxis]).mean(axis=0)) + least
        strength = smooth_over_time((mean_power / shape).mean(axis=1)) + _LEAST
    return still + least, strength[:, np.newaxis] * shape


def _quantile_of_square(share: float) -> float:
    """Quantile of the square of a standard normal variable."""
    from scipy.special import ndtri

    return float(ndtri(0.5 + 0.5 * share) ** 2)
