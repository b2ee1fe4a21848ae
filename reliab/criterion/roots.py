"""Roots of increasing functions, many at a time.

Chandrupatla, T. R. (1997). A new hybrid quadratic/bisection algorithm for finding the zero of a nonlinear
function without using derivatives. *Advances in Engineering Software* 28, 145-149.
"""

from collections.abc import Callable

import numpy as np

from reliab.arrays import Array

_MOST_STEPS = 200
_RESOLUTION = 4.0 * float(np.finfo(np.float64).eps)


def roots_of_increasing(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """Find the root of each of several increasing functions to rounding; NaN where there is none.

    `function` takes and returns one value for each of them, shape (functions,); `low` and `high`: interval in
    which to begin, which is widened where it holds no root, shape (functions,).

    >>> cubes = np.array([8.0, 27.0])
    >>> roots_of_increasing(lambda x: x**3 - cubes, np.zeros(2), np.ones(2)).round(12).tolist()
    [2.0, 3.0]
    """
    low, high = _bracket(function, low, high)
    newest, other, last = low.copy(), high.copy(), high.copy()
    at_newest, at_other = function(newest), function(other)
    at_last, share = at_other.copy(), np.full(low.shape, 0.5)
    for _ in range(_MOST_STEPS):
        tried = newest + share * (other - newest)
        at_tried = function(tried)
        same = np.sign(at_tried) == np.sign(at_newest)
        last, at_last = np.where(same, newest, other), np.where(same, at_newest, at_other)
        other, at_other = np.where(same, other, newest), np.where(same, at_other, at_newest)
        newest, at_newest = tried, at_tried
        best = np.where(np.abs(at_newest) < np.abs(at_other), newest, other)
        width = np.abs(other - newest)
        least = 0.5 * _RESOLUTION * np.abs(best) / np.where(width > 0.0, width, 1.0)
        found = (width <= _RESOLUTION * np.abs(best)) | (at_newest == 0.0) | (at_other == 0.0)
        if (found | ~np.isfinite(width)).all():
            break
        share = np.clip(_interpolated(newest, other, last, at_newest, at_other, at_last), least, 1.0 - least)
    return np.where(np.isfinite(width), best, np.nan)


def _bracket(function: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """Widen intervals, each step twice as far as the one before, until their ends have opposite signs."""
    low, high, reach = low.astype(np.float64), high.astype(np.float64), high - low
    for _ in range(_MOST_STEPS):
        above, below = function(low) > 0.0, function(high) < 0.0
        if not (above | below).any():
            return low, high
        low, high, reach = np.where(above, low - reach, low), np.where(below, high + reach, high), 2.0 * reach
    return np.where(above | below, np.nan, low), high


def _interpolated(a: Array, b: Array, c: Array, at_a: Array, at_b: Array, at_c: Array) -> Array:
    """Share of the way from a to b of the root by inverse quadratic interpolation; a half where unsafe."""
    with np.errstate(divide="ignore", invalid="ignore"):
        place, height = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
        safe = (1.0 - np.sqrt(1.0 - place) < height) & (height < np.sqrt(place))
        quadratic = at_a / (at_b - at_a) * at_c / (at_b - at_c)
        quadratic += (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
    return np.where(safe & np.isfinite(quadratic), quadratic, 0.5)
