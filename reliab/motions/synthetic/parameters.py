"""The physical parameters of one recording, and their computation from the regression's variables."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import exp, pi

from reliab.arrays import Array
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import NO_PULSE, PULSE, Regression
from reliab.motions.synthetic.marginals import bandwidth, oscillations, phase, slope

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
