"""A specimen that is softer below the largest displacement that it has seen (Mullins 1969)."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.effects.effect import Parameter, Role, Setting, SteppedEffect
from reliab.effects.kernel import Kernel, Numbers


def _softened(motion: Numbers, _time: float, _step: float, coefficients: Numbers, state: Numbers) -> float:
    # Coefficients: c, p, largest displacement in earlier tests, d. State: largest displacement so far.
    state[0] = max(state[0], coefficients[2], abs(motion[0]))
    below = 1.0 - (abs(motion[0]) / state[0]) ** coefficients[1] if state[0] > 0.0 else 0.0
    return -motion[0] * (coefficients[0] * below + coefficients[3] * state[0])


@dataclass(frozen=True, kw_only=True)
class Softening(SteppedEffect):
    """A force −c·x·(1 − (|x|/max|x|)ᵖ), where the maximum is that of this test and of all earlier ones.

    Rubber that was stretched once is softer up to there, and as stiff as it was beyond (Mullins 1969, Rubber
    Chemistry and Technology 42, 339); so is cracked concrete, or timber whose joints have loosened. Tests
    follow each other as the campaign lists them.
    """

    name = "softening"
    block = Block.SPECIMEN
    role = Role.FORCE
    description = (
        "the specimen is softer while it moves less than it did before, in this test or in an earlier one"
    )
    parameters: ClassVar[tuple[Parameter, ...]] = (
        Parameter(
            name="lost_n_per_m",
            units="N/m",
            meaning="stiffness lost far below the largest displacement",
            scale=(("force", 1.0), ("displacement", -1.0)),
            signed=True,
            typical=0.5,
            lower=-10.0,
            upper=10.0,
            starts=(0.1, 0.1, 0.1),
        ),
        Parameter(
            name="power",
            units="-",
            meaning="power with which the stiffness returns",
            typical=2.0,
            spread=1.0,
            lower=0.2,
            upper=20.0,
            starts=(4.0, 2.0, 1.0),
        ),
    )
    kernel = Kernel(function=_softened, states=1, by_path=True)
    remembers_peaks = True

    lost_n_per_m: float  # c [N/m]
    power: float  # p [-]

    def coefficients(self, setting: Setting) -> Array:
        """Parameters, the largest displacement in earlier tests [m], and no damage."""
        return np.array([self.lost_n_per_m, self.power, setting.moved_before, 0.0])


@dataclass(frozen=True, kw_only=True)
class Damage(Softening):
    """A softening whose stiffness at the largest displacement falls with it, too, by d·max|x|."""

    name = "damage"
    reported_name = "softening"
    description = "the specimen loses stiffness with the largest displacement that it has seen"
    refines = Softening
    parameters = (
        *Softening.parameters,
        Parameter(
            name="damage_n_per_m2",
            units="N/m²",
            meaning="stiffness lost for each metre of the largest displacement",
            scale=(("force", 1.0), ("displacement", -2.0)),
            signed=True,
            typical=0.3,
            lower=-10.0,
            upper=10.0,
            starts=(0.05,),
        ),
    )

    damage_n_per_m2: float  # d [N/m²]

    def coefficients(self, setting: Setting) -> Array:
        """Parameters with the largest displacement in earlier tests [m]."""
        return np.array([self.lost_n_per_m, self.power, setting.moved_before, self.damage_n_per_m2])
