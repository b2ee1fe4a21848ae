"""From the normal variables of the regression back to the physical parameters of a motion.

Dabaghi & Der Kiureghian (2018) fit a marginal distribution to each parameter and regress on ν = Φ⁻¹(F(θ)), so
that θ = F⁻¹(Φ(ν)). For a lognormal parameter ν is its logarithm; the four other distributions are given here.
"""

from math import exp, expm1, log
from typing import Final

import scipy

# Beta distributions: the two shape parameters, the lower and the upper bound.
_OSCILLATIONS: Final = (1.30326, 3.96858, 2.0, 3.2)
_LOG_BANDWIDTH: Final = (5.33552, 3.82954, -4.7, 0.0)

_PHASE_BOUND: Final = 2.0
"""The phase of a pulse is uniform between 0 and this many half turns."""

# Two-sided exponential density c exp(b x) below zero and c exp(-a x) above, between the bounds [Hz/s].
_SLOPE_RATE_ABOVE: Final = 14.29355
_SLOPE_RATE_BELOW: Final = 6.40242
_SLOPE_LOWEST: Final = -3.5
_SLOPE_HIGHEST: Final = 1.5


def _beta_quantile(nu: float, shape: tuple[float, float, float, float]) -> float:
    first, second, lowest, highest = shape
    return lowest + (highest - lowest) * float(
        scipy.special.betaincinv(first, second, scipy.special.ndtr(nu))
    )


def oscillations(nu: float) -> float:
    """Return the number of half cycles γ of a pulse, beta-distributed between 2 and 3.2.

    >>> round(oscillations(0.0), 3)
    2.257
    """
    return _beta_quantile(nu, _OSCILLATIONS)


def phase(nu: float) -> float:
    """Return the phase of a pulse in half turns, uniform between 0 and 2.

    >>> phase(0.0)
    1.0
    """
    return _PHASE_BOUND * float(scipy.special.ndtr(nu))


def bandwidth(nu: float) -> float:
    """Return the damping ratio ζ of the noise filter, whose logarithm is beta-distributed between −4.7 and 0.

    >>> round(bandwidth(0.0), 3)
    0.144
    """
    return exp(_beta_quantile(nu, _LOG_BANDWIDTH))


def slope(nu: float) -> float:
    """Return the rate of change of the filter frequency [Hz/s], with a two-sided exponential distribution.

    Its density is c exp(6.40 x) below zero and c exp(−14.29 x) above, cut at −3.5 and 1.5 Hz/s, c = 4.4218.

    >>> round(slope(0.0), 4)
    -0.0505
    """
    below = -expm1(_SLOPE_RATE_BELOW * _SLOPE_LOWEST) / _SLOPE_RATE_BELOW
    above = -expm1(-_SLOPE_RATE_ABOVE * _SLOPE_HIGHEST) / _SLOPE_RATE_ABOVE
    area = float(scipy.special.ndtr(nu)) * (below + above)
    if area < below:
        return log(exp(_SLOPE_RATE_BELOW * _SLOPE_LOWEST) + _SLOPE_RATE_BELOW * area) / _SLOPE_RATE_BELOW
    remaining = float(scipy.special.ndtr(-nu)) * (below + above)
    tail = exp(-_SLOPE_RATE_ABOVE * _SLOPE_HIGHEST)
    return -log(tail + _SLOPE_RATE_ABOVE * remaining) / _SLOPE_RATE_ABOVE
