"""A sensor that reads in steps: how large they are, and what noise they make.

Rounding noise is neither white nor stationary: it depends on the motion, and becomes a constant where nothing
moves. It is therefore computed from the motion itself, which is rounded on grids of steps that are shifted
against each other.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LEVELS = 0.125  # share of the samples that the levels of a rounded reading may be in number
_TOLERANCE = 1e-3  # of a step
_TINY = 1e-9  # of the range: two values so near are the same level
_LAYINGS = 8


def rounding_step(measured: Array) -> float:
    """Return the step [m] in which a sensor reads; zero where no steps are seen.

    `measured` [m].

    >>> motion = np.sin(np.arange(0.0, 20.0, 0.01))
    >>> round(rounding_step(0.05 * np.round(motion / 0.05)), 6)
    0.05
    >>> rounding_step(motion)
    0.0
    """
    levels = np.unique(measured)
    distances = np.diff(levels)
    distances = distances[distances > _TINY * np.ptp(measured)]
    if not 0 < distances.size <= _LEVELS * measured.size:
        return 0.0
    least = float(distances.min())
    count = round(float(levels[-1] - levels[0]) / least)
    step = float(levels[-1] - levels[0]) / max(count, 1)
    places = (levels - levels[0]) / step
    whole = np.abs(places - np.round(places)) < _TOLERANCE * max(1.0, count * _TINY)
    return step if whole.all() else 0.0


def rounded_differently(motion: Array, step: float) -> Iterator[Array]:
    """Yield the noise [m] of rounding a motion on shifted grids of steps, shape (n,) each.

    `motion`, `step` [m].
    """
    for laid in (np.arange(_LAYINGS) + 0.5) / _LAYINGS:
        shifted = motion / step + laid
        yield step * (np.round(shifted) - shifted)
