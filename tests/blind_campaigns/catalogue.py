"""What every hidden effect is called, where it acts, and how a dimensionless size becomes its parameters.

A *size* is roughly the effect's share of the signal in its own channel; `draws.py` turns it so that the
effect-to-noise ratio comes out as wished. The equations stand in README.md, the compiled ones in
`march.py`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from blind_campaigns.system import Array, Effect


@dataclass(frozen=True, kw_only=True)
class Scales:
    """How large things are in the training tests of a campaign when no effect acts (SI units)."""

    displacement_rms: float
    displacement_peak: float
    velocity_rms: float
    velocity_peak: float
    force_rms: float
    stiffness: float
    delay: float
    duration: float
    integration_step: float

    @property
    def omega(self) -> float:
        """Dominant circular frequency of the motion [rad/s]."""
        return self.velocity_rms / self.displacement_rms

    @property
    def viscosity(self) -> float:
        """Damping coefficient whose force equals the spring's [N·s/m]."""
        return self.stiffness / self.omega


Build = Callable[[float, Scales, Array], dict[str, float]]


@dataclass(frozen=True, kw_only=True)
class Definition:
    """One kind of effect; `build` takes a size, the scales and six uniform numbers that fix its shape."""

    name: str
    block: str
    channel: str
    units: dict[str, str]
    build: Build
    largest: float = 0.5
    in_library: bool = True
    fields: dict[str, tuple[str, float]] = field(default_factory=dict)

    def make(self, size: float, scales: Scales, shape: Array) -> Effect:
        """Return the effect of a size; six numbers in (0, 1) fix its sign and shape."""
        parameters = {name: float(value) for name, value in self.build(size, scales, shape).items()}
        return Effect(
            name=self.name, block=self.block, channel=self.channel, parameters=parameters, fields=self.fields
        )


def sign(number: float) -> float:
    """Return ±1 from a uniform number."""
    return 1.0 if number < 0.5 else -1.0


def between(low: float, high: float, number: float) -> float:
    """Return the uniform number mapped to (low, high)."""
    return low + (high - low) * number


def between_decades(low: float, high: float, number: float) -> float:
    """Return the uniform number mapped log-uniformly to (low, high)."""
    return float(low * (high / low) ** number)


def same(**names: str) -> dict[str, tuple[str, float]]:
    """Return the fields of a record that take a parameter as it is."""
    return {parameter: (name, 1.0) for parameter, name in names.items()}


def whole_steps(seconds: float, step: float) -> float:
    """Return a duration of whole integration steps, at least one."""
    return max(1, round(seconds / step)) * step


def registry() -> dict[str, Definition]:
    """Return every definition by name, library first."""
    from blind_campaigns import library, outside

    everything = [*library.ACTUATOR, *library.SENSOR, *library.SPECIMEN, *library.LOOP, *outside.OUTSIDE]
    return {definition.name: definition for definition in everything}


SLOWEST_S = 0.05
"""No actuator worth a test lags, or drifts in delay, by more [s]."""

SOFTEST_HZ = 3.0
"""No servo worth a test is softer [Hz]."""

HERTZ = 2.0 * math.pi
"""Radians to a cycle."""


def scales_of(
    *, pistons: list[Array], velocities: list[Array], forces: list[Array], stiffness: float, delay: float,
    duration: float, integration_step: float,
) -> Scales:  # fmt: skip
    """Return the scales of noise-free training tests."""
    piston, velocity, force = (np.concatenate(parts) for parts in (pistons, velocities, forces))
    return Scales(
        displacement_rms=float(np.sqrt(np.mean(piston**2))),
        displacement_peak=float(np.abs(piston).max()),
        velocity_rms=float(np.sqrt(np.mean(velocity**2))),
        velocity_peak=float(np.abs(velocity).max()),
        force_rms=float(np.sqrt(np.mean(force**2))),
        stiffness=stiffness,
        delay=delay,
        duration=duration,
        integration_step=integration_step,
    )
