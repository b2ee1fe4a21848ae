"""Relaxation: a spring in series with a dashpot, in parallel with the specimen's spring (Maxwell 1867).

With the specimen's own spring one branch is the standard linear solid; two branches are a generalised
Maxwell model, after Ferry (1980), *Viscoelastic properties of polymers*, chapter 1.
"""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from reliab.core.vocabulary import Block
from reliab.effects.effect import Effect, Parameter, Role, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers
from reliab.effects.viscous_damping import ViscousDamping


def _branch(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, x, displacement q of the dashpot; T·q' = x − q is exact for a straight x.
    ratio = step / coefficients[1]
    decay = math.exp(-ratio)
    late = 1.0 - (1.0 - decay) / ratio
    x = motion[0]
    if state[0] == 0.0:
        state[2] = x
    else:
        state[2] = decay * state[2] + (1.0 - decay - late) * state[1] + late * x
    state[0], state[1] = 1.0, x
    return coefficients[0] * (x - state[2])


def _two_branches(motion: Numbers, _time: float, step: float, coefficients: Numbers, state: Numbers) -> float:
    # State: started, x, displacements q of both dashpots. The second branch has the time r·T.
    x = motion[0]
    ratio = step / coefficients[1]
    second_ratio = ratio / coefficients[3]
    decay, second_decay = math.exp(-ratio), math.exp(-second_ratio)
    late = 1.0 - (1.0 - decay) / ratio
    second_late = 1.0 - (1.0 - second_decay) / second_ratio
    if state[0] == 0.0:
        state[2], state[3] = x, x
    else:
        state[2] = decay * state[2] + (1.0 - decay - late) * state[1] + late * x
        state[3] = second_decay * state[3] + (1.0 - second_decay - second_late) * state[1] + second_late * x
    state[0], state[1] = 1.0, x
    return coefficients[0] * (x - state[2]) + coefficients[2] * (x - state[3])


@dataclass(frozen=True, kw_only=True)
class ViscoelasticBranch(SteppedEffect):
    """A force k(x − q) with T·q' = x − q: stiffer in fast motion, and relaxing with the time T."""

    name = "viscoelastic_branch"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = "the specimen relaxes, like a spring in series with a dashpot beside its spring"
    limiting_cases: ClassVar[tuple[type[Effect], ...]] = (ViscousDamping,)
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="stiffness_n_per_m",
            units="N/m",
            meaning="stiffness of the branch",
            scale=(("force", 1.0), ("displacement", -1.0)),
            signed=True,
            typical=0.3,
            lower=0.0,
            upper=10.0,
            starts=(0.02, 0.02, 0.02, 0.02),
        ),
        Parameter(
            name="time_s",
            units="s",
            meaning="relaxation time",
            scale=(("displacement", 1.0), ("velocity", -1.0)),
            typical=1.0,
            spread=2.0,
            lower=0.02,
            upper=300.0,
            starts=(0.3, 1.0, 3.0, 20.0),
        ),
    )
    kernel = Kernel(function=_branch, states=3, linear=0)

    stiffness_n_per_m: float  # Stiffness k [N/m]
    time_s: float  # Relaxation time T [s]


@dataclass(frozen=True, kw_only=True)
class TwoViscoelasticBranches(ViscoelasticBranch):
    """A force k₁(x − q₁) + k₂(x − q₂) with T·q₁' = x − q₁ and rT·q₂' = x − q₂."""

    name = "two_viscoelastic_branches"
    reported_name = "viscoelastic_branch"
    description = (
        "the specimen relaxes with two times, like springs in series with dashpots beside its spring"
    )
    refines = ViscoelasticBranch
    limiting_cases = ()
    parameters = (
        *ViscoelasticBranch.parameters,
        replace(
            ViscoelasticBranch.parameters[0],
            name="second_stiffness_n_per_m",
            meaning="stiffness of the slower branch",
        ),
        Parameter(
            name="time_ratio",
            units="-",
            meaning="relaxation time of the slower branch over that of the first",
            typical=10.0,
            spread=1.0,
            lower=2.0,
            upper=1000.0,
            starts=(10.0, 50.0),
        ),
    )
    kernel = Kernel(function=_two_branches, states=4)

    # `stiffness_n_per_m` and `time_s` are those of the faster branch, k₁ and T
    second_stiffness_n_per_m: float  # Stiffness k₂ [N/m] of the slower branch
    time_ratio: float  # Ratio r [-] of both times
