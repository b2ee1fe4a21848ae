"""A specimen that yields and returns to where it began: flag-shaped hysteresis."""

import math
from dataclasses import dataclass, replace

from reliab.effects.bilinear_stiffness import BilinearStiffness
from reliab.effects.effect import Parameter
from reliab.effects.kernel import Kernel, Numbers

_LEAST_WIDTH = 1e-3  # of the yield displacement
_SHARES = (0.2, 0.8)  # with which each bend is tried


def _force(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: f, d, n, β. State: started, place, and force, over d and f. The force follows the motion
    # elastically between the curves of loading and unloading, each that of bilinear stiffness.
    place, exponent = motion[0] / coefficients[1], coefficients[2]
    inner = place / max(1.0 - coefficients[3], _LEAST_WIDTH)
    unit, inner_unit = max(1.0, abs(place)), max(1.0, abs(inner))
    ratio = math.pow(min(1.0, abs(place)) / unit, exponent)
    inner_ratio = math.pow(min(1.0, abs(inner)) / inner_unit, exponent)
    loading = place * math.pow(1.0 + ratio, -1.0 / exponent) / unit
    unloading = place * math.pow(1.0 + inner_ratio, -1.0 / exponent) / inner_unit
    force = state[2] + place - state[1] if state[0] != 0.0 else place
    force = min(max(force, min(loading, unloading)), max(loading, unloading))
    state[0], state[1], state[2] = 1.0, place, force
    return coefficients[0] * (force - place)


@dataclass(frozen=True, kw_only=True)
class SelfCentring(BilinearStiffness):
    """A force f·(p − x/d): the spring bends at f, and unloads along a curve that is lower by β·f.

    p follows x/d elastically between the curve of loading b(x/d) and that of unloading, which is
    (1 − β)·b(x/(1 − β)d), with the b of :class:`~reliab.effects.bilinear_stiffness.BilinearStiffness`. This
    is the flag of prestressed braces, rocking walls with dampers and shape-memory alloys (Christopoulos,
    Filiatrault and Folz 2002, Earthquake Engineering and Structural Dynamics 31, 1131).
    """

    name = "self_centring"
    description = "the specimen yields and returns to where it began, along a flag-shaped hysteresis"
    refines = BilinearStiffness
    limiting_cases = (BilinearStiffness,)
    parameters = (
        *(
            replace(parameter, starts=parameter.starts * len(_SHARES))
            for parameter in BilinearStiffness.parameters
        ),
        Parameter(
            name="flag_share",
            units="-",
            meaning="share of that force by which it unloads lower",
            signed=True,
            typical=0.5,
            lower=-1e-9,
            upper=1.0,
            starts=tuple(share for share in _SHARES for _ in BilinearStiffness.parameters[0].starts),
        ),
    )
    kernel = Kernel(function=_force, states=3, linear=0, by_path=True)

    flag_share: float = 0.0  # Share β [-] of f by which it unloads lower, from 0 to 1
