"""Noise whose frequency varies in time: white noise through a filter with time-varying parameters."""

from collections.abc import Iterator
from itertools import pairwise
from math import ceil, cos, exp, log, pi, sin, sqrt
from typing import Final

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.motions.synthetic.modulation import Modulation
from reliab.motions.synthetic.parameters import ComponentParameters

_LOWEST_FREQUENCY: Final = 0.3
"""Lower bound of the filter frequency [Hz] (Dabaghi & Der Kiureghian 2017)."""

_FORGOTTEN: Final = 1e-5
"""Responses that have decayed to this part of their first amplitude are left out."""

_STEPS_PER_BANDWIDTH: Final = 8
"""The frequency goes in steps of ζ/8 of itself, a sixteenth of the width of the filter's peak."""

_NARROWEST: Final = 0.05
"""Bandwidth ζ below which the steps become no smaller."""


def filter_frequency(component: ComponentParameters, modulation: Modulation, times: Array) -> Array:
    """Frequency of the filter at each time.

    It changes linearly between the times of 1 % and 99 % of the Arias intensity, is constant before and
    after, and never falls below 0.3 Hz; ``component.frequency`` holds at 30 %.

    `times` (n,) [s]; returns (n,) [Hz].
    """
    first, middle, last = (modulation.time_of_share(share) for share in (0.01, 0.30, 0.99))
    linear = component.frequency + component.frequency_slope * (np.clip(times, first, last) - middle)
    return np.maximum(linear, _LOWEST_FREQUENCY)


def filter_noise(noise: Array, frequency: Array, bandwidth: float, time_step: float) -> Array:
    """Filter white noise through a damped oscillator; each impulse keeps the frequency of its instant.

    x(t) = Σ h(t − τ, ω(τ)) w(τ) / √(Σ h(t − τ, ω(τ))²) over all earlier impulses τ, with h(t, ω) = ω/√(1 −
    ζ²) exp(−ζωt) sin(ω√(1 − ζ²) t) (Rezaeian & Der Kiureghian 2010; Dabaghi & Der Kiureghian 2017). The
    variance of x is 1 at every time but the first, where x is 0. Neighbouring impulses of nearly the same
    frequency share one recursion; ω is therefore a staircase whose steps are small compared with the width of
    the filter's peak.

    `noise` (n,); `frequency` (n,) [Hz]; `time_step` [s]; returns (n,).

    >>> noise = np.array([1.0, 0.0, 0.0, 0.0])
    >>> filter_noise(noise, np.full(4, 2.0), bandwidth=0.2, time_step=0.01)
    array([0.        , 1.        , 0.88843676, 0.7887594 ])
    """
    total, power = np.zeros(noise.size), np.zeros(noise.size)
    for begin, end in _blocks(frequency, bandwidth):
        angle = 2.0 * pi * time_step * float(frequency[(begin + end) // 2])
        stop = min(end + ceil(-log(_FORGOTTEN) / (bandwidth * angle)), noise.size)
        impulses = np.zeros((2, stop - begin))
        impulses[0, : end - begin] = noise[begin:end]
        impulses[1, 0] = 1.0
        responses = _oscillate(impulses, angle, bandwidth)
        energy = np.cumsum(responses[1] ** 2)
        total[begin:stop] += responses[0]
        power[begin:stop] += energy
        power[end:stop] -= energy[: stop - end]
    return np.divide(total, np.sqrt(power), out=total, where=power > 0.0)


def _blocks(frequency: Array, bandwidth: float) -> Iterator[tuple[int, int]]:
    """Begin and end of each run of samples whose frequency lies on one step of the staircase."""
    step = max(bandwidth, _NARROWEST) / _STEPS_PER_BANDWIDTH
    ends = np.flatnonzero(np.diff(np.floor(np.log(frequency) / step))) + 1
    yield from pairwise([0, *ends.tolist(), frequency.size])


def _oscillate(impulses: Array, angle: float, bandwidth: float) -> Array:
    """Response ω h of an oscillator of ω Δt = angle to impulses, shape (..., n)."""
    decay, turn = exp(-bandwidth * angle), angle * sqrt(1.0 - bandwidth**2)
    ahead, behind = 2.0 * decay * cos(turn), decay**2
    response: Array = scipy.signal.lfilter([0.0, angle * decay * sin(turn)], [1.0, -ahead, behind], impulses)
    return response
