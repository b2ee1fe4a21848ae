"""Change a motion's rate or length."""

import math
from dataclasses import replace

import numpy as np

from reliab.errors import InputError
from reliab.motions.motion import Motion

_WHOLE = 1e-9  # a fraction of a step below which a time counts as lying on a sample


def resample(motion: Motion, rate_hz: float = 1024.0) -> Motion:
    """Interpolate a motion linearly at another rate.

    The paper interpolates every record to 1024 Hz. Linear interpolation changes nothing between the
    samples of a rate above the record's own, but a lower rate drops what lies between its samples.

    `motion`: the record, n samples at its own step; `rate_hz`: new sampling rate [Hz], positive. Returns
    samples at k / rate_hz for every k that lies within the record; at most one new step shorter. Raises
    InputError if the rate is not positive or leaves fewer than two samples.

    >>> slow = Motion(name="ramp", acceleration=[0.0, 1.0, 0.0], time_step=0.5)
    >>> resample(slow, rate_hz=4.0).acceleration.tolist()
    [0.0, 0.5, 1.0, 0.5, 0.0]
    """
    if not (math.isfinite(rate_hz) and rate_hz > 0):
        raise InputError("The sampling rate must be positive", value=rate_hz, remedy="Give it in hertz")
    steps = math.floor(motion.duration * rate_hz + _WHOLE)
    if steps < 1:
        raise InputError(
            "The sampling rate must leave at least two samples",
            value=f"{rate_hz} Hz over {motion.duration} s",
            where=motion.name,
        )
    times = np.arange(steps + 1) / rate_hz
    samples = np.interp(times, motion.times, motion.acceleration)
    return replace(motion, acceleration=samples, time_step=1.0 / rate_hz)


def truncate(motion: Motion, duration: float) -> Motion:
    """Keep the first seconds of a motion.

    `duration`: longest duration to keep [s], at least one step of the record. Returns the samples up to the
    given time; the motion itself if it is no longer than that. Raises InputError if the duration is shorter
    than one step.

    >>> record = Motion(name="ramp", acceleration=[0.0, 1.0, 2.0, 3.0], time_step=0.5)
    >>> truncate(record, 1.2).duration
    1.0
    """
    if not duration * (1 + _WHOLE) >= motion.time_step:
        raise InputError(
            "The duration must be at least one time step of the record",
            value=f"{duration} s against a step of {motion.time_step} s",
            where=motion.name,
        )
    if duration >= motion.duration:
        return motion
    steps = math.floor(duration / motion.time_step + _WHOLE)
    return replace(motion, acceleration=motion.acceleration[: steps + 1])
