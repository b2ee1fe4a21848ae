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
_FIRST = 0.01  # of the power, with which what is more than noise begins at least
_FAR = 4.0  # standard deviations of the mean power of a block of noise
_LEAST = 1e-14  # of the mean power


def smooth_over_frequency(power: Array) -> Array:
    """Average powers over neighbouring frequencies, shape (…, k), about half an octave to each side."""
    place = np.log2(np.arange(power.shape[-1]) + 1.5)
    weight = np.exp(-0.5 * ((place[:, np.newaxis] - place) / _OCTAVE) ** 2)
    return np.asarray(power @ (weight / weight.sum(axis=1, keepdims=True)).T)


def smooth_over_time(power: Array) -> Array:
    """Average powers over neighbouring blocks, shape (J,)."""
    reach = int(4.0 * _BLOCKS)
    weight = np.exp(-0.5 * (np.arange(-reach, reach + 1) / _BLOCKS) ** 2)
    total = np.convolve(power, weight)[reach : reach + power.size]
    return np.asarray(total / np.convolve(np.ones(power.size), weight)[reach : reach + power.size])


def fit_variances(power: Array) -> tuple[Array, Array]:
    """Divide powers of cells into a stationary and a modulated variance, each shape (J, k)."""
    mean = float(power.mean())
    least = _LEAST * mean
    if mean == 0.0:
        return np.full(power.shape, np.finfo(float).tiny), np.zeros(power.shape)
    surrounding_power = smooth_over_frequency(
        np.quantile(power, _QUIET, axis=0) / _quantile_of_square(_QUIET)
    )
    still = np.tile(0.5 * surrounding_power, (power.shape[0], 1)) + least
    strength = power.mean(axis=1) / mean + 1e-3
    shape = smooth_over_frequency(power.mean(axis=0))
    for _ in range(_ITERATIONS):
        motion_power = strength[:, np.newaxis] * shape
        total = still + motion_power + least
        share = motion_power / total
        mean_power = share**2 * power + share * still
        noise_share = still / total
        still = np.tile(
            smooth_over_frequency((noise_share**2 * power + noise_share * motion_power).mean(axis=0)),
            (power.shape[0], 1),
        )
        shape = smooth_over_frequency((mean_power / strength[:, np.newaxis]).mean(axis=0)) + least
        strength = smooth_over_time((mean_power / shape).mean(axis=1)) + _LEAST
    return still + least, strength[:, np.newaxis] * shape


def fit_excess(power: Array, noise: Array, motion: Array, least: float) -> Array:
    """Variances of cells, shape (J, k), of which noise is known, and some follows the motion.

    To the variance of the noise come a stationary part a(f), and a share s(f) of the power of the motion,
    not below the least share. A block with a far larger power, as where a record begins or ends, has a
    variance that is larger by the same factor.
    """
    mean = power.mean(axis=0)
    still = smooth_over_frequency(np.maximum(mean - noise.mean(axis=0), _FIRST * mean)) / 2.0
    motion_power = smooth_over_frequency(motion.mean(axis=0))
    share, factor = still / motion_power + least, np.ones((power.shape[0], 1))
    far = 1.0 + _FAR * np.sqrt(2.0 / power.shape[1])
    for _ in range(_ITERATIONS):
        follows = share * motion
        total = noise + still + follows
        left = (power / total).mean(axis=1, keepdims=True)
        factor = np.where(left > far, left, 1.0)
        ratio = power / (factor * total) - 1.0
        still = smooth_over_frequency((still + still**2 / total * ratio).mean(axis=0))
        follows_power = smooth_over_frequency((follows + follows**2 / total * ratio).mean(axis=0))
        share = np.maximum(follows_power / motion_power, least)
    return np.asarray(factor * (noise + still + share * motion))


def _quantile_of_square(share: float) -> float:
    """Quantile of the square of a standard normal variable."""
    from scipy.special import ndtri

    return float(ndtri(0.5 + 0.5 * share) ** 2)
