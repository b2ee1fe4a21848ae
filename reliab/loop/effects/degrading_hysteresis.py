"""Bouc–Wen hysteresis that loses stiffness and strength and slips (Baber & Wen 1981, Baber & Noori 1985)."""

import math
from dataclasses import dataclass

from reliab.loop.effects.effect import Role, SteppedEffect
from reliab.loop.effects.hysteresis import Hysteresis
from reliab.loop.effects.kernel import Kernel, Numbers
from reliab.loop.effects.parameter import Parameter
from reliab.vocabulary import Block

_YIELDS = 1e-4  # of the elastic stiffness


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, displacement, z, dissipated energy over f·d.
    force, displacement = coefficients[0], coefficients[1]
    gamma, exponent = coefficients[2], coefficients[3]
    beta = 1.0 - gamma - 2.0 * min(gamma, 0.0) ** 2
    travel = (motion[0] - state[1]) / displacement if state[0] != 0.0 else 0.0
    sign = 1.0 if travel >= 0.0 else -1.0
    parts = min(int(abs(travel) / 0.1) + 1, 50)
    part = travel / parts
    z, energy = state[2], state[3]
    for place in range(parts):
        softer = 1.0 + coefficients[5] * energy
        weaker = 1.0 + coefficients[6] * energy
        slip = 1.0 - coefficients[7] * math.exp(-((z / 0.2) ** 2))
        direction = beta if sign * z >= 0.0 else -beta
        rise = slip * part / softer * (1.0 - weaker * abs(z) ** exponent * (direction + gamma))
        middle = min(max(z + 0.5 * rise, -100.0), 100.0)
        direction = beta if sign * middle >= 0.0 else -beta
        rise = slip * part / softer * (1.0 - weaker * abs(middle) ** exponent * (direction + gamma))
        energy = max(energy + middle * (part - rise), 0.0)
        z = min(max(z + rise, -100.0), 100.0)
        if abs(rise) < _YIELDS * abs(part):  # it yields, and goes on yielding to the end of the step
            energy = max(energy + (parts - 1 - place) * part * z, 0.0)
            break
    state[0], state[1], state[2], state[3] = 1.0, motion[0], z, energy
    return force * (z - coefficients[4] * motion[0] / displacement)


@dataclass(frozen=True, kw_only=True)
class DegradingHysteresis(SteppedEffect):
    """A hysteresis that loses stiffness and strength with the energy it dissipates, and slips about z = 0.

    z' = h(z)·(v/(d·η))·(1 − ν·|z|ⁿ(β·sgn(vz) + γ)) with η = 1 + δ_η·ε, ν = 1 + δ_ν·ε and the slip
    h = 1 − ζ·exp(−(z/0.2)²); ε is the energy dissipated in the test so far over f·d.

    Parameters
    ----------
    force_n, displacement_m, gamma, exponent, lost_share : float
        As of :class:`~reliab.loop.effects.hysteresis.Hysteresis`, before anything is lost.
    stiffness_loss : float
        δ_η [-], growth of the flexibility with the energy.
    strength_loss : float
        δ_ν [-], fall of the strength with the energy.
    slip : float
        ζ [-], share of the stiffness that is missing about z = 0, from 0 to 0.95.
    """

    name = "degrading_hysteresis"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen's hysteresis loses stiffness or strength from cycle to cycle, or is pinched"
    refines = Hysteresis
    parameters = (
        *Hysteresis.parameters,
        Parameter(
            name="stiffness_loss",
            units="-",
            meaning="growth of the flexibility with the dissipated energy",
            signed=True,
            typical=0.1,
            lower=0.0,
            upper=5.0,
            starts=(0.005,),
        ),
        Parameter(
            name="strength_loss",
            units="-",
            meaning="fall of the strength with the dissipated energy",
            signed=True,
            typical=0.1,
            lower=0.0,
            upper=5.0,
            starts=(0.005,),
        ),
        Parameter(
            name="slip",
            units="-",
            meaning="share of the stiffness that is missing where the hysteretic force changes sign",
            signed=True,
            typical=0.5,
            lower=0.0,
            upper=0.95,
            starts=(0.05,),
        ),
    )
    kernel = Kernel(function=_force, states=4)

    force_n: float
    displacement_m: float
    gamma: float = 0.5
    exponent: float = 2.0
    lost_share: float = 0.0
    stiffness_loss: float = 0.0
    strength_loss: float = 0.0
    slip: float = 0.0
