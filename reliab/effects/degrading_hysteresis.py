"""Bouc–Wen hysteresis that loses stiffness and strength and slips (Baber & Wen 1981, Baber & Noori 1985)."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.effect import Parameter, Setting
from reliab.effects.hysteresis import Hysteresis


@dataclass(frozen=True, kw_only=True)
class DegradingHysteresis(Hysteresis):
    """A hysteresis that loses stiffness and strength with the energy it dissipates, and slips about z = 0.

    z' = h(z)·(v/(d·η))·(1 − ν·|z|ⁿ(β·sgn(vz) + γ)) with η = 1 + δ_η·ε, ν = 1 + δ_ν·ε and the slip
    h = 1 − ζ·exp(−(z/0.2)²); ε is the energy dissipated in the test so far over f·d.
    """

    name = "degrading_hysteresis"
    description = "the specimen's hysteresis loses stiffness or strength from cycle to cycle, or is pinched"
    refines = Hysteresis
    limiting_cases = ()
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

    stiffness_loss: float = 0.0  # δ_η [-], growth of the flexibility with the energy
    strength_loss: float = 0.0  # δ_ν [-], fall of the strength with the energy
    slip: float = 0.0  # ζ [-], share of the stiffness that is missing about z = 0, from 0 to 0.95

    def coefficients(self, setting: Setting) -> Array:
        """Return the parameters and two zeros, for no effect of the speed."""
        del setting
        return np.concatenate([self.values, np.zeros(2)])
