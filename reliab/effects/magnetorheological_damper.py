"""A magnetorheological damper (Spencer and others 1997): hysteresis and dashpot behind a second dashpot."""

import math
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.bouc_wen import require_followed
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.hysteresis import Hysteresis
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.viscous_damping import ViscousDamping

_LARGEST_PART = 0.1  # of the yield displacement, or of the time in which the second dashpot gives way
_MOST_PARTS = 100
_YIELDS = 1e-4  # of the elastic stiffness, below which a step is followed no further
_LARGEST_FORCE = 20.0  # of the yield force


def _force(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: f, d, γ, n, c₀, c₁. State: started, displacement, z.
    # The second dashpot moves with y' = (f·z + c₀v)/(c₀ + c₁) and carries the whole force.
    force, width, gamma, exponent = coefficients[0], coefficients[1], coefficients[2], coefficients[3]
    inner, outer = coefficients[4], coefficients[5]
    beta = 1.0 - gamma - 2.0 * min(gamma, 0.0) ** 2
    velocity = (motion[0] - state[1]) / step if state[0] != 0.0 else 0.0
    z = state[2]
    fastest = max(abs(velocity) / width, force / ((inner + outer) * width))
    parts = min(int(fastest * step / _LARGEST_PART) + 1, _MOST_PARTS)
    part = step / parts
    for _ in range(parts):
        relative = velocity - (force * z + inner * velocity) / (inner + outer)
        sign = 1.0 if relative * z >= 0.0 else -1.0
        rise = part * relative / width * (1.0 - abs(z) ** exponent * (sign * beta + gamma))
        middle = min(max(z + 0.5 * rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        relative = velocity - (force * middle + inner * velocity) / (inner + outer)
        sign = 1.0 if relative * middle >= 0.0 else -1.0
        rise = part * relative / width * (1.0 - abs(middle) ** exponent * (sign * beta + gamma))
        before, z = z, min(max(z + rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        if abs(z - before) < _YIELDS * part / width * abs(velocity):
            break
    state[0], state[1], state[2] = 1.0, motion[0], z
    return outer * (force * z + inner * motion[1]) / (inner + outer)


@dataclass(frozen=True, kw_only=True)
class MagnetorheologicalDamper(SteppedEffect):
    """A force c₁y' with y' = (f·z + c₀v)/(c₀ + c₁) and z' = ((v − y')/d)·(1 − |z|ⁿ(β·sgn((v − y')z) + γ)).

    Spencer, Dyke, Sain and Carlson (1997), Journal of Engineering Mechanics 123, 230, equations 8 to 10 with
    k₀ = 0; the accumulator's spring k₁ is that of the linear specimen, its preload an offset of the force.
    """

    name = "magnetorheological_damper"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen yields and flows like a magnetorheological damper"
    refines = Hysteresis
    members = (Hysteresis, ViscousDamping)
    parameters = (
        *Hysteresis.parameters[:4],
        Parameter(
            name="damping_n_s_per_m",
            units="N·s/m",
            meaning="damping coefficient beside the hysteresis",
            scale=(("force", 1.0), ("velocity", -1.0)),
            signed=True,
            typical=0.3,
            lower=1e-4,
            upper=5.0,
            starts=(0.1, 0.1, 0.1, 0.1, 0.1, 0.1),
        ),
        Parameter(
            name="series_damping_n_s_per_m",
            units="N·s/m",
            meaning="damping coefficient behind both",
            scale=(("force", 1.0), ("velocity", -1.0)),
            typical=10.0,
            spread=2.0,
            lower=0.1,
            upper=1000.0,
            starts=(10.0, 10.0, 10.0, 10.0, 10.0, 10.0),
        ),
    )
    kernel = Kernel(function=_force, states=3)

    force_n: float  # Force f [N] at which the hysteretic part yields
    displacement_m: float  # Displacement d [m] at which it would yield if it stayed elastic
    gamma: float = 0.5  # Shape γ [-], as in :class:`~reliab.effects.hysteresis.Hysteresis`
    exponent: float = 2.0  # Sharpness n [-] of yielding
    damping_n_s_per_m: float  # c₀ [N·s/m]
    series_damping_n_s_per_m: float  # c₁ [N·s/m]

    def __post_init__(self) -> None:
        super().__post_init__()
        require_followed(self.exponent)

    def coefficients(self, setting: Setting) -> Array:
        """Parameters; a dashpot that gives energy would let the model run away."""
        del setting
        values = self.values
        values[4] = max(values[4], math.ulp(1.0))
        return np.asarray(values)
