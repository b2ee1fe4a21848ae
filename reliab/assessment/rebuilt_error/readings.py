"""What a force that is fed back late belongs to, and what a sensor with hysteresis reads."""

import numpy as np

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError

_SUPPORT = 3  # samples before the newest that the interpolation uses


def require_lag(lag: float, duration: float) -> None:
    """Refuse a lag of the fed-back force that no test of a duration can have, both [s]."""
    if not (np.isfinite(lag) and lag >= 0.0):
        raise InputError(
            "The lag of the fed-back force must be finite and not negative",
            value=f"{lag} s",
            remedy="Give seconds, 0.0005 for half a millisecond",
        )
    if lag > duration:
        raise InputError(
            "The lag of the fed-back force must be shorter than the test",
            value=f"{lag:g} s",
            remedy="Give seconds, 0.0005 for half a millisecond",
        )


def delay_history(values: Array, lag: float, time_step: float) -> Array:
    """History at t − lag, by the cubic through the last samples: causal, so that a running test can use it.

    `lag`, `time_step` [s].

    >>> late = delay_history(np.arange(8.0) ** 2, 0.25, 1.0)
    >>> late[4:].tolist()
    [14.0625, 22.5625, 33.0625, 45.5625]
    """
    require_lag(lag, values.size * time_step)
    if lag == 0.0:
        return values
    steps = lag / time_step
    whole_steps = int(steps)
    # nodes at −3 … 0 steps before the sample `whole` steps ago; read at −(steps − whole)
    place = -(steps - whole_steps)
    nodes = np.arange(-float(_SUPPORT), 1.0)
    weights = [np.prod((place - np.delete(nodes, k)) / (nodes[k] - np.delete(nodes, k))) for k in range(4)]
    extended = np.concatenate([np.full(whole_steps + _SUPPORT, values[0]), values])
    nodes_of_samples = [extended[k : k + values.size] for k in range(_SUPPORT + 1)]
    return np.asarray(sum(weight * part for weight, part in zip(weights, nodes_of_samples, strict=True)))


def delay_from_sample(values: Array, first: int, lag: float, time_step: float) -> Array:
    """History at t − lag from its `first` sample on; no more of those before are looked at than it needs."""
    context = int(lag / time_step) + _SUPPORT + 1
    available = min(first, context)
    extended = np.pad(values[first - available :], (context - available, 0), mode="edge")
    return delay_history(extended, lag, time_step)[context:]


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
    position = motion[0]
    reading = np.empty(motion.size)
    for k in range(motion.size):
        position = min(max(position, motion[k] - radius), motion[k] + radius)
        reading[k] = position
    return reading
