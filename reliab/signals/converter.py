"""A channel that reads in steps: how large they are, and what they add to a motion.

A converter's error is neither white nor stationary: it depends on the motion, and where that rests within a
step it is the motion itself, which looks like slack. It is therefore computed from a motion, on grids of
steps that are shifted against each other, or from a model's prediction, where only the noise before the
conversion remains unknown.
"""

from collections.abc import Iterator

import numpy as np

from reliab.arrays import Array

_MOST_LEVELS = 0.25  # of the samples; the error of more levels is as good as white
_FEWEST_LEVELS = 3  # any two lie on a grid
_ON_THE_GRID = 0.02  # of a step; a text rounds the levels once more
_SAME = 1e-9  # of the range: two values so near are one level
_REFINEMENTS = 3
_GRIDS = 8
_LARGEST_SPREAD = 0.45  # of a step; more noise than this makes the error independent of the signal
_EXACT_BELOW = 0.05
_HARMONICS = 12


def converter_step(values: Array) -> float:
    """Step between the levels of a channel, zero where there are none.

    `values`: samples of a channel, shape (n,). Returns step in the unit of the channel, of which all levels
    are whole multiples apart.

    >>> motion = np.sin(np.linspace(0.0, 9.0, 500))
    >>> round(converter_step(np.round(motion, 1)), 9), converter_step(motion)
    (0.1, 0.0)
    """
    levels = np.unique(values)
    distances = np.diff(levels)
    distances = distances[distances > _SAME * np.ptp(values)]
    if not _FEWEST_LEVELS <= distances.size + 1 < _MOST_LEVELS * values.size:
        return 0.0
    levels = np.concatenate([[0.0], np.cumsum(distances)])
    step = float(distances.min())
    for _ in range(_REFINEMENTS):  # the smallest distance is a step but for what the file rounds
        places = np.concatenate([[0.0], np.cumsum(np.round(distances / step))])
        step = float(np.polyfit(places, levels, 1)[0])
    return step if np.abs(levels / step - places).max() < _ON_THE_GRID else 0.0


def vary_rounding(motion: Array, step: float) -> Iterator[Array]:
    """Round a motion on grids of steps that are shifted against each other.

    `motion`: a motion, shape (n,); `step`: step of the converter, in the unit of the motion. Yields what
    rounding on a grid adds, shape (n,).
    """
    for shift in (np.arange(_GRIDS) + 0.5) / _GRIDS:
        shifted = motion / step + shift
        yield step * (np.round(shifted) - shifted)


def expected_error(signal: Array, step: float, spread: float, level: float) -> Array | None:
    """Mean of what the converter adds to a signal with some noise on it.

    `signal`: predicted signal, shape (n,); `spread`: standard deviation of what is not predicted; `level`:
    one level of the converter. Returns converted minus predicted signal, shape (n,); None where so much noise
    is added that nothing is left.
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
