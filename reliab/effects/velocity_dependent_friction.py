"""Friction that depends on the speed of sliding, as in sliding bearings."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.effects.bouc_wen import SLIDING
from reliab.effects.effect import Parameter, Setting
from reliab.effects.hysteresis import Hysteresis


@dataclass(frozen=True, kw_only=True)
class VelocityDependentFriction(Hysteresis):
    """A force f·(z·(1 − r·exp(−|v|/v_s)) − s·x/d): friction that grows with the speed (r > 0), or falls.

    Constantinou, Mokha and Reinhorn (1990), Journal of Structural Engineering 116, 455: f is the friction at
    large speed, f·(1 − r) that of slow sliding; with r < 0 it is the effect of Stribeck.
    """

    name = "velocity_dependent_friction"
    description = "the specimen's friction depends on the speed of sliding"
    refines = Hysteresis
    parameters = (
        *Hysteresis.parameters,
        Parameter(
            name="slow_share",
            units="-",
            meaning="share of the force that is missing at low speed",
            signed=True,
            typical=0.4,
            lower=-2.0,
            upper=0.95,
            starts=(0.3,),
        ),
        Parameter(
            name="speed_m_per_s",
            units="m/s",
            meaning="speed over which the force changes",
            scale=(("velocity", 1.0),),
            typical=0.15,
            spread=1.0,
            lower=5e-3,
            upper=1.0,
            starts=(0.15,),
        ),
    )
    kernel = SLIDING

    slow_share: float = 0.0  # r [-], share of the force that is missing at low speed; negative: it is larger
    speed_m_per_s: float = 0.1  # v_s [m/s], over which the force changes

    def coefficients(self, setting: Setting) -> Array:
        """Return the parameters, with zeros for no loss and no slip."""
        del setting
        return np.concatenate([self.values[:5], np.zeros(3), self.values[5:]])
