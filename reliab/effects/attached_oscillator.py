"""A mass on a spring and a damper of its own that the specimen carries: a tuned mass, or liquid in a tank."""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from reliab.effects.added_mass import AddedMass
from reliab.effects.effect import Effect, Parameter, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers

_STARTS = tuple(0.04 * 1.3**k for k in range(11))  # whose resonances overlap with a damping ratio of 0.15


def _force(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: mass, frequency [Hz], damping ratio. State: started, place, velocity and acceleration of
    # the mass, by Newmark's method of average acceleration.
    rate = 2.0 * math.pi * coefficients[1]
    if state[0] == 0.0:
        state[0], state[1], state[2], state[3] = 1.0, motion[0], motion[1], 0.0
        return 0.0
    place = state[1] + step * state[2] + 0.25 * step * step * state[3]
    speed = state[2] + 0.5 * step * state[3]
    pull = 2.0 * coefficients[2] * rate * (motion[1] - speed) + rate * rate * (motion[0] - place)
    pull /= 1.0 + coefficients[2] * rate * step + 0.25 * (rate * step) ** 2
    state[1], state[2], state[3] = place + 0.25 * step * step * pull, speed + 0.5 * step * pull, pull
    return coefficients[0] * pull


@dataclass(frozen=True, kw_only=True)
class AttachedOscillator(SteppedEffect):
    """A force m·y'' with y'' = 2ζω(v − y') + ω²(x − y), ω = 2πf: a mass that swings on the specimen.

    As of tuned mass dampers (Den Hartog 1956, *Mechanical vibrations*, chapter 3) and, for small waves, of
    liquid in a tank (Housner 1957, Bulletin of the Seismological Society of America 47, 15).
    """

    name = "attached_oscillator"
    block = AddedMass.block
    role = AddedMass.role
    description = "the specimen carries a mass that swings on a spring of its own, as a tuned mass or liquid"
    limiting_cases: ClassVar[tuple[type[Effect], ...]] = (AddedMass,)
    parameters: ClassVar[tuple[Parameter, ...]] = (
        replace(
            AddedMass.parameters[0],
            meaning="mass that swings",
            lower=0.0,
            starts=AddedMass.parameters[0].starts * len(_STARTS),
        ),
        Parameter(
            name="frequency_hz",
            units="Hz",
            meaning="natural frequency of the mass on its spring",
            scale=(("velocity", 1.0), ("displacement", -1.0)),
            typical=0.2,
            spread=1.0,
            lower=0.02,
            upper=3.0,
            starts=_STARTS,
        ),
        Parameter(
            name="damping_ratio",
            units="-",
            meaning="damping ratio of the mass on its spring",
            typical=0.05,
            spread=1.2,
            lower=2e-3,
            upper=0.7,
            starts=(0.15,) * len(_STARTS),
        ),
    )
    kernel = Kernel(function=_force, states=4, linear=0)

    mass_kg: float  # Mass m [kg]
    frequency_hz: float  # Natural frequency f [Hz] of the mass on its spring
    damping_ratio: float  # Damping ratio ζ [-]
