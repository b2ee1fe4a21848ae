"""Bouc–Wen hysteresis in the specimen (Wen 1976), also with loss of stiffness and strength and with slip.

Losses are those of Baber & Wen (1981), the slip is that of Baber & Noori (1985); all share one kernel.
"""

import math
from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.friction import CoulombFriction
from reliab.effects.kernel import Kernel, Numbers
from reliab.errors import InputError
from reliab.vocabulary import Block

_YIELDS = 1e-4  # of the elastic stiffness
_LARGEST_PART = 0.1  # of the yield displacement: largest part into which the path is divided
_MOST_PARTS = 50
_LARGEST_FORCE = 100.0  # of the yield force
_SLIP_WIDTH = 0.2  # of the yield force


def _hysteretic_force(
    motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers
) -> float:
    # Coefficients: f, d, γ, n, share that the spring lost, δ_η, δ_ν, ζ.
    # State: started, displacement, z, dissipated energy over f·d. The path of the displacement decides, not
    # its speed.
    gamma, exponent = coefficients[2], coefficients[3]
    beta = 1.0 - gamma - 2.0 * min(gamma, 0.0) ** 2
    travel = (motion[0] - state[1]) / coefficients[1] if state[0] != 0.0 else 0.0
    sign = 1.0 if travel >= 0.0 else -1.0
    substeps = min(int(abs(travel) / _LARGEST_PART) + 1, _MOST_PARTS)
    increment = travel / substeps
    z, energy = state[2], state[3]
    for place in range(substeps):
        weaker = 1.0 + coefficients[6] * energy
        softer = increment / (1.0 + coefficients[5] * energy)
        if coefficients[7] > 0.0:
            softer *= 1.0 - coefficients[7] * math.exp(-((z / _SLIP_WIDTH) ** 2))
        direction = beta if sign * z >= 0.0 else -beta
        rise = softer * (1.0 - weaker * abs(z) ** exponent * (direction + gamma))
        middle = min(max(z + 0.5 * rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        direction = beta if sign * middle >= 0.0 else -beta
        rise = softer * (1.0 - weaker * abs(middle) ** exponent * (direction + gamma))
        energy = max(energy + middle * (increment - rise), 0.0)
        z = min(max(z + rise, -_LARGEST_FORCE), _LARGEST_FORCE)
        if abs(rise) < _YIELDS * abs(increment):  # it yields, and goes on yielding to the end of the step
            energy = max(energy + (substeps - 1 - place) * increment * z, 0.0)
            break
    state[0], state[1], state[2], state[3] = 1.0, motion[0], z, energy
    return coefficients[0] * (z - coefficients[4] * motion[0] / coefficients[1])


SHARPEST = 50.0
"""Largest exponent n [-] that the steps follow; above it the force leaves its bounds."""


def require_followed(exponent: float) -> None:
    """Refuse an exponent that the steps cannot follow.

    `exponent` [-].
    """
    if exponent > SHARPEST:
        raise InputError(
            f"The exponent of a hysteresis must be at most {SHARPEST:g}",
            value=f"{exponent:g}",
            remedy="Give 20 for a sharp corner",
        )


BOUC_WEN = Kernel(function=_hysteretic_force, states=4)
"""Kernel of eight coefficients: those of a hysteresis, then growth of flexibility, fall of strength, slip."""


@dataclass(frozen=True, kw_only=True)
class Hysteresis(SteppedEffect):
    """A force f·(z − s·x/d), z' = (v/d)·(1 − |z|ⁿ(β·sgn(vz) + γ)), beside the linear spring.

    The shape is that of z' = (v/d)·(1 − |z|ⁿ(sgn(vz) + g)) with g = γ/β and β = 1 − γ − 2·min(γ, 0)²: with
    γ ≥ 0 that of textbooks, β + γ = 1, in which f is the yield force; with γ below zero a part that yields
    later and later, and below −0.707 (g < −1) one that hardens without limit. It starts unstressed at
    the displacement of the first sample. With s = 0 the hysteretic part is in parallel with the whole spring;
    with s = 1 the spring has lost the stiffness f/d that the part brings, so that the stiffness of small
    motions stays what it was: kx + f·(z − x/d) is the αkx + (1 − α)kd·z of textbooks.

    >>> hardening = Hysteresis(force_n=1.0, displacement_m=0.01, gamma=-0.7785)
    >>> round(hardening.shape_ratio, 3)
    -1.375
    """

    name = "hysteresis"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen yields and dissipates like a Bouc–Wen hysteresis"
    limiting_cases = (CoulombFriction,)
    parameters = (
        Parameter(
            name="force_n",
            units="N",
            meaning="yield force of the hysteretic part",
            scale=(("force", 1.0),),
            signed=True,
            typical=0.3,
            lower=0.0,
            upper=10.0,
            starts=(0.03, 0.03, 0.03, 0.03, 0.03, 0.03),
        ),
        Parameter(
            name="displacement_m",
            units="m",
            meaning="yield displacement",
            scale=(("displacement", 1.0),),
            typical=0.2,
            spread=2.0,
            lower=1e-4,
            upper=10.0,
            starts=(0.03, 0.1, 0.3, 0.9, 0.01, 0.1),
        ),
        Parameter(
            name="gamma",
            units="-",
            meaning="shape of loading against unloading",
            signed=True,
            neutral=0.4,
            typical=0.6,
            lower=-0.9,
            upper=0.9,
            starts=(0.4, 0.4, 0.4, 0.4, -0.5, -0.5),
        ),
        Parameter(
            name="exponent",
            units="-",
            meaning="sharpness of yielding",
            typical=1.7,
            spread=0.8,
            lower=0.3,
            upper=15.0,
            starts=(1.7, 1.7, 1.7, 1.7, 1.7, 1.7),
        ),
        Parameter(
            name="lost_share",
            units="-",
            meaning="share of the hysteretic part's elastic stiffness that the linear spring has lost",
            signed=True,
            typical=1.0,
            lower=-1e-9,
            upper=1.0,
            starts=(0.5, 0.5, 0.5, 0.5, 0.5, 0.5),
        ),
    )
    kernel = BOUC_WEN

    force_n: float  # Force f at which the hysteretic part yields [N]
    displacement_m: float  # Displacement d at which it would yield if it stayed elastic [m]
    gamma: float = 0.5  # Shape γ [-] of loading against unloading, between −1 and 1
    exponent: float = 2.0  # Sharpness n [-] of yielding
    # Share s [-] of the part's elastic stiffness f/d that the linear spring has lost, from 0 to 1
    lost_share: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_followed(self.exponent)

    @property
    def shape_ratio(self) -> float:
        """The ratio g = γ/β [-] of the form z' = (v/d)·(1 − |z|ⁿ(sgn(vz) + g))."""
        return self.gamma / (1.0 - self.gamma - 2.0 * min(self.gamma, 0.0) ** 2)

    def coefficients(self, setting: Setting) -> Array:
        """Return the parameters and three zeros, for no loss and no slip."""
        del setting
        return np.concatenate([self.values, np.zeros(3)])


@dataclass(frozen=True, kw_only=True)
class DegradingHysteresis(SteppedEffect):
    """A hysteresis that loses stiffness and strength with the energy it dissipates, and slips about z = 0.

    z' = h(z)·(v/(d·η))·(1 − ν·|z|ⁿ(β·sgn(vz) + γ)) with η = 1 + δ_η·ε, ν = 1 + δ_ν·ε and the slip
    h = 1 − ζ·exp(−(z/0.2)²); ε is the energy dissipated in the test so far over f·d.
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
    kernel = BOUC_WEN

    # force_n, displacement_m, gamma, exponent, lost_share: As in
    # :class:`~reliab.effects.hysteresis.Hysteresis`, before anything is lost
    force_n: float
    displacement_m: float
    gamma: float = 0.5
    exponent: float = 2.0
    lost_share: float = 0.0
    stiffness_loss: float = 0.0  # δ_η [-], growth of the flexibility with the energy
    strength_loss: float = 0.0  # δ_ν [-], fall of the strength with the energy
    slip: float = 0.0  # ζ [-], share of the stiffness that is missing about z = 0, from 0 to 0.95

    def __post_init__(self) -> None:
        super().__post_init__()
        require_followed(self.exponent)
