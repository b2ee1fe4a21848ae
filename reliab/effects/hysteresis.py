"""Bouc–Wen hysteresis in addition to the linear spring, or in place of a part of it (Wen 1976)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.bouc_wen import BOUC_WEN, require_followed
from reliab.effects.coulomb_friction import CoulombFriction
from reliab.effects.effect import Effect, Parameter, Role, Setting, SteppedEffect


@dataclass(frozen=True, kw_only=True)
class Hysteresis(SteppedEffect):
    """A force f·(z − s·x/d), z' = (v/d)·(1 − |z|ⁿ(β·sgn(vz) + γ)), in addition to the linear spring.

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
    limiting_cases: ClassVar[tuple[type[Effect], ...]] = (CoulombFriction,)
    parameters: ClassVar[tuple[Parameter, ...]] = (
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
            meaning="share of elastic stiffness that the linear spring has lost",
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
        """Return the parameters and five zeros, for no loss, no slip and no effect of the speed."""
        del setting
        return np.concatenate([self.values, np.zeros(5)])
