"""A damper that is stronger in one direction than in the other."""

import math
from dataclasses import dataclass

from reliab.effects.directional_friction import DirectionalFriction
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.power_law_damping import PowerLawDamping
from reliab.effects.viscous_damping import ViscousDamping

_ASYMMETRY = DirectionalFriction.parameters[-1]


def _viscous_force(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers
) -> float:
    return coefficients[0] * (motion[1] + coefficients[1] * abs(motion[1]))


def _power_law_force(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, _state: Numbers
) -> float:
    v = motion[1]
    either_way = v + coefficients[2] * abs(v)
    return coefficients[0] * either_way * math.pow(v * v + 1e-18, 0.5 * (coefficients[1] - 1.0))


@dataclass(frozen=True, kw_only=True)
class DirectionalDamping(ViscousDamping):
    """A force c·(v + a·|v|): a linear damper of c(1 + a) forwards and c(1 − a) backwards, as of vehicles."""

    name = "directional_damping"
    description = "the specimen's damper is stronger in one direction than in the other"
    refines = ViscousDamping
    parameters = (*ViscousDamping.parameters, _ASYMMETRY)
    kernel = Kernel(function=_viscous_force, linear=0)

    # `damping_n_s_per_m` is the mean damping coefficient c of both directions
    asymmetry: float = 0.0  # a [-], half the difference of both directions over their mean, between −1 and 1


@dataclass(frozen=True, kw_only=True)
class DirectionalPowerLawDamping(PowerLawDamping):
    """A force c·(sgn(v) + a)·|v|ᵖ: a damper of c(1 + a) forwards and c(1 − a) backwards."""

    name = "directional_power_law_damping"
    reported_name = "directional_damping"
    description = DirectionalDamping.description
    refines = PowerLawDamping
    limiting_cases = (PowerLawDamping, DirectionalDamping)
    parameters = (*PowerLawDamping.parameters, _ASYMMETRY)
    kernel = Kernel(function=_power_law_force, linear=0)

    # `coefficient` is the mean c of both directions
    asymmetry: float = 0.0  # a [-], half the difference of both directions over their mean, between −1 and 1
