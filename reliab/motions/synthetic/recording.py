"""Both horizontal components of one recording, from their parameters to samples.

White noise goes through a filter whose frequency varies in time, is modulated so that its intensity has the
durations of the recording, loses its spurious long-period content, and comes to rest at its end.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, cos, exp, log, log1p, pi, sin, sqrt
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import (
    ComponentParameters,
    PulseParameters,
    RecordingParameters,
)
from reliab.signals.filters import filter_recursively

_DISCARDED_BITS: Final = np.uint64(11)
_RESOLUTION: Final = 2.0**-53


class RandomStream:
    """Independent uniform and normal numbers for one purpose, found by a seed and a key.

    NumPy promises the bits of a bit generator for ever, but not what ``Generator.normal`` makes of them.
    The stream therefore takes the bits themselves: 53 of each 64 become a uniform number, and the inverse
    normal distribution makes it a normal one.

    >>> RandomStream(2017, 1).uniforms(2)
    array([0.37796854, 0.26692428])
    """

    def __init__(self, seed: int, *key: int) -> None:
        self._bits = np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key))

    def uniforms(self, count: int) -> Array:
        """Draw numbers uniform in the open interval (0, 1), shape (count,)."""
        raw = np.asarray(self._bits.random_raw(count))
        return ((raw >> _DISCARDED_BITS).astype(np.float64) + 0.5) * _RESOLUTION

    def normals(self, count: int) -> Array:
        """Draw standard normal numbers, shape (count,)."""
        normals: Array = scipy.special.ndtri(self.uniforms(count))
        return normals

    def uniform(self) -> float:
        """Draw one number uniform in the open interval (0, 1)."""
        return float(self.uniforms(1)[0])


_ONSET: Final = 0.05
_RISE: Final = 0.30
_END: Final = 0.95
_GENTLEST: Final = 1.0
"""Largest 1 / (2α + 1); with more the motion would be strongest at its start (α < 0)."""


@dataclass(frozen=True, kw_only=True)
class Modulation:
    """A power of time up to the peak, an exponential after it (Dabaghi & Der Kiureghian 2017, eq. 4).

    q(t) = c (t / t_m)^α up to t_m and c exp(−β (t − t_m)) after it. The expected Arias intensity of a process
    of unit variance modulated by q is (π/2g) ∫ q² dt, so that its share at any time has a closed form.

    >>> shape = Modulation(peak_time=4.0, peak_share=0.4, growth=3.0, arias_intensity=1.0)
    >>> round(shape.time_of_share(0.4), 6), round(shape.time_of_share(0.95), 3)
    (4.0, 8.97)
    """

    peak_time: float  # Time t_m of the largest intensity [s]
    peak_share: float  # Share of the Arias intensity that has arrived by then, p
    growth: float  # Exponent 2α + 1 of the share before the peak
    arias_intensity: float  # Arias intensity [m/s]

    @property
    def decay_time(self) -> float:
        """Time constant 1 / (2β) in which the remaining intensity falls by e [s]."""
        return self.peak_time * (1.0 - self.peak_share) / (self.growth * self.peak_share)

    def time_of_share(self, share: float) -> float:
        """Time at which a share of the Arias intensity, between 0 and 1, has arrived [s]."""
        if share <= self.peak_share:
            return float(self.peak_time * (share / self.peak_share) ** (1.0 / self.growth))
        return self.peak_time - self.decay_time * log((1.0 - share) / (1.0 - self.peak_share))

    def __call__(self, times: Array) -> Array:
        """Return the standard deviation of the acceleration [m/s²] at times from zero [s], shape (n,)."""
        rising = (np.minimum(times, self.peak_time) / self.peak_time) ** (0.5 * (self.growth - 1.0))
        falling = np.exp(-0.5 * np.maximum(times - self.peak_time, 0.0) / self.decay_time)
        mean_square = 2.0 * STANDARD_GRAVITY / pi * self.arias_intensity * (1.0 - self.peak_share)
        deviations: Array = rising * falling * (mean_square / self.decay_time) ** 0.5
        return deviations


def fit_modulation(component: ComponentParameters) -> Modulation:
    """Find the modulating function that has the durations of a component.

    D0-5 and D5-95 leave a family of functions that differ in the share of the intensity at the peak; D0-30
    picks one of them. A D0-30 outside the reach of the family (up to a third of the draws) gives its nearest
    member, whose peak is at 5 % or at 95 %. Dabaghi & Der Kiureghian minimise the squares of the three errors
    instead; the two agree wherever all three durations can be had.

    Returns with D0-5 and D5-95 exactly, unless D5-95 is so much longer than D0-5 that only D0-95 can be had.
    """
    ratio = component.strong_end / component.onset_duration
    rise_over_end = component.rise_duration / component.strong_end

    def excess(peak_share: float) -> float:
        shape = _unit_shape(peak_share, ratio)
        return shape.time_of_share(_RISE) / shape.time_of_share(_END) - rise_over_end

    if excess(_ONSET) >= 0.0:
        peak_share = _ONSET
    elif excess(_END) <= 0.0:
        peak_share = _END
    else:
        peak_share = scipy.optimize.brentq(excess, _ONSET, _END, xtol=1e-15)
    shape = _unit_shape(peak_share, ratio)
    return Modulation(
        peak_time=component.strong_end / shape.time_of_share(_END),
        peak_share=peak_share,
        growth=shape.growth,
        arias_intensity=component.arias_intensity,
    )


def _unit_shape(peak_share: float, ratio: float) -> Modulation:
    """Return the function with its peak at time 1 and a given ratio of D0-95 to D0-5."""
    rise_rate = log(peak_share / _ONSET)
    decay_rate = (1.0 - peak_share) / peak_share * log((1.0 - peak_share) / (1.0 - _END))

    def excess(rate: float) -> float:
        return rate * rise_rate + log1p(rate * decay_rate) - log(ratio)

    rate = (
        _GENTLEST if excess(_GENTLEST) <= 0.0 else scipy.optimize.brentq(excess, 0.0, _GENTLEST, xtol=1e-15)
    )
    return Modulation(peak_time=1.0, peak_share=peak_share, growth=1.0 / rate, arias_intensity=1.0)


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
    numerator = np.array([0.0, angle * decay * sin(turn)])
    denominator = np.array([1.0, -2.0 * decay * cos(turn), decay**2])
    rows = impulses.reshape(-1, impulses.shape[-1])
    responses = [filter_recursively(numerator, denominator, row) for row in rows]
    return np.reshape(responses, impulses.shape)


_ORDER: Final = 4


def corner_frequency(magnitude: float) -> float:
    """Corner frequency of the high-pass filter, 10^(1.4071 − 0.3452 M) (Dabaghi & Der Kiureghian 2018).

    Returns [Hz].

    >>> round(corner_frequency(7.0), 4)
    0.0979
    """
    return float(10.0 ** (1.4071 - 0.3452 * magnitude))


def padding(magnitude: float, time_step: float) -> int:
    """Return the number of zeros that the filter needs at either end, three periods of its corner."""
    return ceil(0.75 * _ORDER / corner_frequency(magnitude) / time_step)


def high_pass(acceleration: Array, magnitude: float, time_step: float) -> Array:
    """Remove the content below the corner frequency, without a phase shift.

    The amplitude response of the Butterworth filter is √(r / (1 + r)) with r = (f/f_c)⁸, so that neither the
    velocity nor the displacement keeps a residual.

    `acceleration` (..., n); `time_step` [s]; returns (..., n).
    """
    count = acceleration.shape[-1]
    length = scipy.fft.next_fast_len(count, real=True)
    ratio = (scipy.fft.rfftfreq(length, time_step) / corner_frequency(magnitude)) ** (2 * _ORDER)
    spectrum = scipy.fft.rfft(acceleration, length) * np.sqrt(ratio / (1.0 + ratio))
    filtered_motion: Array = scipy.fft.irfft(spectrum, length)[..., :count]
    return filtered_motion


def settle(acceleration: Array) -> Array:
    """Subtract the smallest straight line that leaves no velocity or displacement at the end.

    `acceleration` (..., n); returns (..., n).

    >>> bool(np.abs(settle(np.array([1.0, 1.0, 1.0, 1.0]))).max() < 1e-14)
    True
    """
    count = acceleration.shape[-1]
    weights = _weights_of_rest(count)
    line = np.stack([np.ones(count), np.linspace(-1.0, 1.0, count)])
    residuals = np.sum(acceleration[..., np.newaxis, :] * weights, axis=-1)
    effects = np.sum(weights[:, np.newaxis, :] * line, axis=-1)
    slopes = np.linalg.solve(effects, residuals[..., np.newaxis])[..., 0]
    acceleration_at_rest: Array = acceleration - np.sum(slopes[..., np.newaxis] * line, axis=-2)
    return acceleration_at_rest


def _weights_of_rest(count: int) -> Array:
    """Weights of the samples in the last velocity (over Δt) and the last displacement (over Δt²)."""
    velocity = np.ones(count)
    velocity[[0, -1]] = 0.5
    displacement = np.arange(count - 1, -1, -1, dtype=np.float64)
    displacement[0] = (count - 1) / 2 - 1 / 6
    displacement[-1] = 1 / 6
    return np.stack([velocity, displacement])


def pulse_acceleration(pulse: PulseParameters, times: Array) -> Array:
    """Acceleration of the pulse at each time.

    The velocity is an oscillation under a raised cosine, as Mavroeidis & Papageorgiou (2003) have it, less
    the part that Dabaghi & Der Kiureghian (2017) take out to leave no residual displacement. With u = t −
    t_max and within |u| ≤ γT/2,

        v = (V/2 cos(2πu/T + φ) − D/(γT)) (1 + cos(2πu/(γT))),
        D = VT (sin(φ + γπ) − sin(φ − γπ)) / (4π (1 − γ²)).

    `times` (n,) [s]; returns (n,) [m/s²].

    Mavroeidis, G. P. and Papageorgiou, A. S. (2003), Bull. Seismol. Soc. Am. 93(3), 1099-1131.
    """
    gamma, omega = pulse.oscillations, 2.0 * pi / pulse.period
    swing = sin(pulse.phase + gamma * pi) - sin(pulse.phase - gamma * pi)
    offset = pulse.velocity * swing / (4.0 * pi * (1.0 - gamma**2) * gamma)
    half_length = 0.5 * gamma * pulse.period
    time = np.clip(times - pulse.peak_time, -half_length, half_length)
    carrier = 0.5 * pulse.velocity * np.cos(omega * time + pulse.phase) - offset
    carrier_rate = -0.5 * pulse.velocity * omega * np.sin(omega * time + pulse.phase)
    envelope = 1.0 + np.cos(omega / gamma * time)
    envelope_rate = -omega / gamma * np.sin(omega / gamma * time)
    return carrier_rate * envelope + carrier * envelope_rate


TIME_STEP: Final = 0.01
"""Interval between samples [s]."""

_LENGTH: Final = 2.5
"""Length of the motion before filtering, in units of D0-95."""

_STILL: Final = 0.01
"""Part of its largest displacement below which a component is at rest, before and after the motion."""


def simulate_recording(
    parameters: RecordingParameters, magnitude: float, noises: Sequence[RandomStream]
) -> Array:
    """Simulate both components along the axes of the model, from rest to rest.

    Returns acceleration [m/s²] every 0.01 s, with the quiet time that the filter needs before and after.
    """
    components = (parameters.first, parameters.second)
    count = ceil(_LENGTH * max(component.strong_end for component in components) / TIME_STEP)
    quiet = padding(magnitude, TIME_STEP)
    times = TIME_STEP * np.arange(count, dtype=np.float64)
    strong = [_modulate_noise(*pair, times) for pair in zip(components, noises, strict=True)]
    motion = high_pass(np.pad(strong, ((0, 0), (quiet, quiet))), magnitude, TIME_STEP)
    intensities = np.array([component.arias_intensity for component in components])
    arias: Array = pi / (2.0 * STANDARD_GRAVITY) * TIME_STEP * np.sum(motion**2, axis=1)
    motion *= np.sqrt(intensities / arias)[:, np.newaxis]
    if parameters.pulse is not None:
        motion[0, quiet : quiet + count] += pulse_acceleration(parameters.pulse, times)
    return motion


def _modulate_noise(component: ComponentParameters, noise: RandomStream, times: Array) -> Array:
    modulation = fit_modulation(component)
    frequency = filter_frequency(component, modulation, times)
    process = filter_noise(noise.normals(times.size), frequency, component.bandwidth, TIME_STEP)
    return process * modulation(times)


def rotate(motion: Array, angle: float) -> Array:
    """Turn two orthogonal components to the axes of an instrument.

    `motion` (2, n); `angle` [rad]; returns (2, n).

    >>> rotate(np.array([[1.0], [0.0]]), pi / 6).round(3)
    array([[ 0.866],
           [-0.5  ]])
    """
    first, second = motion
    return np.stack([cos(angle) * first + sin(angle) * second, cos(angle) * second - sin(angle) * first])


def trim_quiet_ends(motion: Array) -> Array:
    """Cut off the quiet time before and after a motion, and bring what is left to rest.

    Both components are cut where the displacement of the first to move, and of the last to rest, is 1 % of
    its largest (Dabaghi & Der Kiureghian 2018); `settle` removes the small residual velocity and displacement
    after the cut.

    `motion` (2, n) [m/s²]; returns (2, m).
    """
    displacement = np.abs(np.cumsum(np.cumsum(motion, axis=1), axis=1))
    moving = (displacement > _STILL * displacement.max(axis=1, keepdims=True)).any(axis=0)
    first, last = np.flatnonzero(moving)[[0, -1]]
    return settle(motion[:, first : last + 1])
