"""The steps of a converter in a channel, and the error that they make where a model says what was converted.

A converter's error is no noise: where the signal rests within one step it is the signal itself, which looks
like slack. Given a model's prediction the error is known but for what else is added to the signal before the
conversion.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_MOST_LEVELS = 0.25  # of the samples; more levels are not worth correcting
_FEWEST_LEVELS = 3
_ON_THE_GRID = 0.02  # of a step
_LARGEST_SPREAD = 0.45  # of a step; more noise than this makes the error independent of the signal
_EXACT_BELOW = 0.05
_HARMONICS = 12


def converter_step(values: Array) -> float:
    """Step between the levels of a channel, zero where there are none.

    >>> converter_step(np.round(np.sin(np.linspace(0.0, 9.0, 500)), 1))
    0.1
    """
    levels = np.unique(values)
    if not _FEWEST_LEVELS <= levels.size < _MOST_LEVELS * values.size:
        return 0.0
    step = float(np.diff(levels).min())
    places = (levels - levels[0]) / step
    return round(step, 15) if np.abs(places - np.round(places)).max() < _ON_THE_GRID else 0.0


def expected_error(signal: Array, step: float, spread: float, level: float) -> Array | None:
    """Mean of what the converter adds to a signal with some noise on it.

    Returns converted minus predicted signal, shape (n,); None where so much noise is added that nothing is
    left.
    """
    share = spread / step
    if share > _LARGEST_SPREAD:
        return None
    turns = (signal - level) / step
    if share < _EXACT_BELOW:
        return np.asarray(step * (np.round(turns) - turns))
    added = np.zeros_like(signal)
    for k in range(1, _HARMONICS + 1):
        weight = (-1.0) ** k / (np.pi * k) * np.exp(-2.0 * (np.pi * k * share) ** 2)
        added += step * weight * np.sin(2.0 * np.pi * k * turns)
    return added
