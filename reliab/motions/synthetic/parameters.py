"""The physical parameters of one recording, and their computation from the regression's variables.

Dabaghi & Der Kiureghian (2018) fit a marginal distribution to each parameter and regress on ν = Φ⁻¹(F(θ)), so
that θ = F⁻¹(Φ(ν)). For a lognormal parameter ν is its logarithm; the four other distributions are given here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, expm1, log, pi
from typing import Final

import scipy

from reliab.core.arrays import Array
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import NO_PULSE, PULSE, Regression

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


_CENTIMETRE = 0.01


@dataclass(frozen=True, kw_only=True)
class ComponentParameters:
    """Parameters of one horizontal component."""

    arias_intensity: float  # Arias intensity I_a [m/s]
    strong_duration: float  # Time between 5 % and 95 % of the Arias intensity, D5-95 [s]
    onset_duration: float  # Time from the start to 5 % of it, D0-5 [s]
    rise_duration: float  # Time from the start to 30 % of it, D0-30 [s]
    frequency: float  # Frequency of the noise filter when 30 % is reached [Hz]
    frequency_slope: float  # Rate of change of that frequency [Hz/s]
    bandwidth: float  # Damping ratio ζ of the noise filter, between 0 and 1

    @property
    def strong_end(self) -> float:
        """Time from the start to 95 % of the Arias intensity, D0-95 [s]."""
        return self.onset_duration + self.strong_duration


@dataclass(frozen=True, kw_only=True)
class PulseParameters:
    """Parameters of the velocity pulse of a recording."""

    velocity: float  # Amplitude V_p [m/s]
    period: float  # Period T_p of the oscillation [s]
    oscillations: float  # Length of the pulse in periods, γ
    phase: float  # Phase of the oscillation against its envelope [rad]
    peak_time: float  # Time from the start to the peak of the envelope [s]

    @property
    def start(self) -> float:
        """Time at which the pulse begins [s]."""
        return self.peak_time - 0.5 * self.oscillations * self.period


@dataclass(frozen=True, kw_only=True)
class RecordingParameters:
    """Parameters of both components of one recording."""

    # Along the major principal axis, or in the direction of the pulse (without the pulse itself)
    first: ComponentParameters
    second: ComponentParameters  # Orthogonal to the first
    pulse: PulseParameters | None = None  # The velocity pulse in the direction of the first component


def regression_of(*, pulse_like: bool) -> Regression:
    """Return the regression for motions with or without a pulse."""
    return PULSE if pulse_like else NO_PULSE


def physical_parameters(normal: Array, *, pulse_like: bool) -> RecordingParameters:
    """Transform the normal variables of the regression to physical parameters.

    `normal` (19,) with a pulse or (14,).

    >>> parameters = physical_parameters(NO_PULSE.coefficients[:, 0], pulse_like=False)
    >>> round(parameters.second.arias_intensity, 2)
    14.9
    """
    values = dict(zip(regression_of(pulse_like=pulse_like).names, normal.tolist(), strict=True))
    return RecordingParameters(
        first=_component(values, "1"),
        second=_component(values, "2"),
        pulse=_pulse(values) if pulse_like else None,
    )


def _component(values: Mapping[str, float], number: str) -> ComponentParameters:
    return ComponentParameters(
        arias_intensity=exp(values[f"arias_{number}"]) * _CENTIMETRE,
        strong_duration=exp(values[f"d5_95_{number}"]),
        onset_duration=exp(values[f"d0_5_{number}"]),
        rise_duration=exp(values[f"d0_30_{number}"]),
        frequency=exp(values[f"frequency_{number}"]),
        frequency_slope=slope(values[f"slope_{number}"]),
        bandwidth=bandwidth(values[f"bandwidth_{number}"]),
    )


def _pulse(values: Mapping[str, float]) -> PulseParameters:
    return PulseParameters(
        velocity=exp(values["pulse_velocity"]) * _CENTIMETRE,
        period=exp(values["pulse_period"]),
        oscillations=oscillations(values["pulse_oscillations"]),
        phase=pi * phase(values["pulse_phase"]),
        peak_time=exp(values["pulse_time"]),
    )
