"""What is tried: actuators and specimens of the simulated tests, and what of them is stated wrongly."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Final

import numpy as np
from reliab_studies.laboratory.compensators.inverse import InverseCompensation

from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.core.arrays import Array
from reliab.effects.backlash import Backlash
from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.cubic_stiffness import CubicStiffness
from reliab.effects.delay_drift import DelayDrift
from reliab.effects.effect import Effect
from reliab.effects.first_order_lag import FirstOrderLag
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.rate_limit import RateLimit
from reliab.effects.second_order_dynamics import SecondOrderDynamics
from reliab.effects.stroke_saturation import StrokeSaturation
from reliab.simulation.hybrid_test.model import Actuator
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

from ..beyond_the_model import Rig

_SERVO_DAMPING = 0.7
_COMPENSATED = 6.0  # steps
_LARGEST = 0.999  # share of a peak that an actuator may fail to reach


@dataclass(frozen=True, kw_only=True)
class Scales:
    """Reference values by which sizes are scaled."""

    structure: Structure  # The structure
    displacement: float  # displacement, velocity: Peaks of the undisturbed response [m, m/s]
    velocity: float
    duration: float  # duration, step: Length of the test and step between samples [s]
    step: float
    lean: float  # Between −1 and 1: size and sign of an actuator's gain error beside its delay

    def delay(self, size: float) -> float:
        """Delay [s] that takes a share `size` of the damping: ατω₀² = size·2ξω₀."""
        structure = self.structure
        viscous = 2.0 * structure.damping_ratio / structure.circular_frequency
        return size * viscous / structure.experimental_fraction


def _gain_and_delay(size: float, scales: Scales) -> Rig:
    gain = 1.0 + scales.lean * size * scales.structure.damping_ratio
    return Rig(name="gain and delay", actuator=Actuator(gain=gain, delay=scales.delay(size)))


def _lag(size: float, scales: Scales) -> Rig:
    return Rig(name="first-order lag", effects=(FirstOrderLag(time_constant_s=scales.delay(size)),))


def _second_order(size: float, scales: Scales) -> Rig:
    frequency = _SERVO_DAMPING / (np.pi * scales.delay(size))
    servo = SecondOrderDynamics(natural_frequency_hz=frequency, damping_ratio=_SERVO_DAMPING)
    return Rig(name="second-order dynamics", effects=(servo,))


def _drift(size: float, scales: Scales) -> Rig:
    delay = scales.delay(size)
    drift = DelayDrift(delay_rate_s_per_s=delay / scales.duration)
    return Rig(name="drifting delay", actuator=Actuator(delay=0.5 * delay), effects=(drift,))


def _rate_limit(size: float, scales: Scales) -> Rig:
    limit = scales.velocity * (1.0 - min(size, _LARGEST))
    return Rig(name="rate limit", effects=(RateLimit(velocity_limit_m_per_s=limit),))


def _backlash(size: float, scales: Scales) -> Rig:
    width = size * scales.structure.damping_ratio * scales.displacement
    return Rig(name="backlash", effects=(Backlash(width_m=width),))


def _saturation(size: float, scales: Scales) -> Rig:
    stroke = scales.displacement * (1.0 - min(size, _LARGEST))
    return Rig(name="stroke saturation", effects=(StrokeSaturation(stroke_m=stroke),))


def _make_overcorrected(size: float, scales: Scales) -> Rig:
    delay = max((_COMPENSATED - 1.0) * scales.step - scales.delay(size), 0.0)
    return Rig(
        name="overcorrecting compensator",
        actuator=Actuator(delay=delay),
        compensator=InverseCompensation(steps=_COMPENSATED),
    )


RIGS: Final[tuple[Callable[[float, Scales], Rig], ...]] = (
    _gain_and_delay,
    _lag,
    _second_order,
    _drift,
    _rate_limit,
    _backlash,
    _saturation,
    _make_overcorrected,
)
"""Actuators of a size [-], which grows with the error that they cause."""

LINEAR: Final = "linear"


@dataclass(frozen=True, kw_only=True)
class NonlinearSpecimen:
    """A specimen per unit mass."""

    stiffness: float  # Of its linear spring [1/s²]
    effect: Effect  # Its further effect

    def specimen(self) -> Specimen:
        """Its linear part."""
        return Specimen(stiffness=self.stiffness)


def _cubic(stiffness: float, peak: float, rng: np.random.Generator) -> NonlinearSpecimen:
    cubic = rng.uniform(0.1, 0.5) * stiffness / peak**2
    return NonlinearSpecimen(stiffness=stiffness, effect=CubicStiffness(cubic_n_per_m3=cubic))


def _coulomb(stiffness: float, peak: float, rng: np.random.Generator) -> NonlinearSpecimen:
    friction = CoulombFriction(
        force_n=rng.uniform(0.02, 0.1) * stiffness * peak,
        regularisation_velocity_m_per_s=0.02 * np.sqrt(stiffness) * peak,
    )
    return NonlinearSpecimen(stiffness=stiffness, effect=friction)


def _hysteresis(stiffness: float, peak: float, rng: np.random.Generator) -> NonlinearSpecimen:
    yields, hardening = rng.uniform(0.2, 0.5) * peak, rng.uniform(0.1, 0.5)
    effect = Hysteresis(
        force_n=(1.0 - hardening) * stiffness * yields,
        displacement_m=yields,
        gamma=0.5,
        exponent=2.0,
        lost_share=0.0,
    )
    return NonlinearSpecimen(stiffness=hardening * stiffness, effect=effect)


SPECIMENS: Final[Mapping[str, Callable[[float, float, np.random.Generator], NonlinearSpecimen]]] = (
    MappingProxyType(
        {"cubic stiffness": _cubic, "Coulomb friction": _coulomb, "Bouc–Wen hysteresis": _hysteresis}
    )
)
"""Specimens of a stiffness [1/s²] that a linear structure would move by a peak [m]."""


QUANTISED: Final = "quantised, 40 dB"
RIGHT: Final = "right"

_DECIBELS: Final[Mapping[str, float]] = MappingProxyType(
    {"20 dB": 20.0, "30 dB": 30.0, "40 dB": 40.0, "60 dB": 60.0, QUANTISED: 40.0}
)


@dataclass(frozen=True, kw_only=True)
class Condition:
    """A sensor, and the structure as the laboratory states it."""

    # White noise so many decibels below the RMS of the motion, "20 dB" to "60 dB", or a sensor whose steps
    # are as coarse, "quantised, 40 dB"
    sensor: str
    # The quantity that is stated wrongly: "frequency", "damping_ratio" or "experimental_fraction"; nothing by
    # default
    quantity: str = ""
    wrong_by: float = 0.0  # By how much, relative [-]; stated as the tolerance too

    @property
    def stated(self) -> str:
        """What is wrong, in words."""
        if not self.quantity:
            return RIGHT
        symbol = {"frequency": "f", "damping_ratio": "ξ", "experimental_fraction": "α"}[self.quantity]
        return f"{symbol} {100.0 * self.wrong_by:+.0f} %".replace("-", "−")

    def structure(self, true: Structure) -> Structure:
        """Structure that the laboratory states."""
        if not self.quantity:
            return true
        return replace(true, **{self.quantity: (1.0 + self.wrong_by) * getattr(true, self.quantity)})

    @property
    def known(self) -> PriorKnowledge:
        """Standard deviations that it states."""
        deviations = {self.quantity: abs(self.wrong_by)} if self.quantity else {}
        return PriorKnowledge(tolerances=deviations)

    def read(self, true: Array, rng: np.random.Generator) -> Array:
        """Record a true history [m or N], shape (n,), as the sensor shows it."""
        level = 10.0 ** (-_DECIBELS[self.sensor] / 20.0) * float(np.sqrt(np.mean(true**2)))
        if self.sensor == QUANTISED:
            width = np.sqrt(12.0) * level
            return np.asarray(width * np.round(true / width + rng.uniform(-0.5, 0.5)), dtype=np.float64)
        return np.asarray(true + level * rng.standard_normal(true.size), dtype=np.float64)


PLAIN: Final = Condition(sensor="40 dB")
"""The condition in which judges are compared."""

CONDITIONS: Final = (
    PLAIN,
    *(Condition(sensor=name) for name in _DECIBELS if name != PLAIN.sensor),
    Condition(sensor=PLAIN.sensor, quantity="frequency", wrong_by=0.02),
    Condition(sensor=PLAIN.sensor, quantity="frequency", wrong_by=-0.02),
    Condition(sensor=PLAIN.sensor, quantity="damping_ratio", wrong_by=0.2),
    Condition(sensor=PLAIN.sensor, quantity="damping_ratio", wrong_by=-0.2),
    Condition(sensor=PLAIN.sensor, quantity="experimental_fraction", wrong_by=-0.05),
)
"""Every sensor with the structure stated rightly, and every wrong statement with the sensor of 40 dB."""
