"""Hysteresis of a displacement sensor: its reading depends on the side from which a place was reached."""

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled


def lag_of_reading(motion: Array, width: float) -> Array:
    """Distance [m] by which a reading lags behind a motion, over the hysteresis [-], shape (n,).

    `motion` [m]; `width` [-] of the loop, over the span of the motion. The lag is that of a play (Prandtl):
    a hysteresis of h makes a reading h times this smaller than a motion that rises, and larger than one that
    falls.

    >>> lag_of_reading(np.array([0.0, 1.0, 2.0, 1.9, 0.0]), 0.1).round(3).tolist()
    [0.0, 1.0, 1.0, 0.0, -1.0]
    """
    half = 0.5 * float(np.ptp(motion))
    radius = width * half
    if not radius > 0.0:
        return np.zeros_like(motion)
    return np.asarray((motion - _play(motion, radius)) * (half / radius))


@compiled
def _play(motion: Array, radius: float) -> Array:
    held = motion[0]
    reading = np.empty(motion.size)
    for k in range(motion.size):
        held = min(max(held, motion[k] - radius), motion[k] + radius)
        reading[k] = held
    return reading
