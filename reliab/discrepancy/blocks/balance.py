"""The numerical substructure: ground acceleration and command → the force that would balance them.

The command is exact, so that its derivatives are, too: the force that must have come back to the controller
follows from the equation of motion and is compared with the measured one. An error of the integration shifts
the acceleration in time.
"""

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign import Campaign, Channel
from reliab.loop.effects import RecordEffect, Role, Scales, library
from reliab.loop.effects.integration_error import IntegrationError
from reliab.loop.hybrid_test import HybridTest, Motion3
from reliab.vocabulary import Block

Array = NDArray[np.float64]


class BalanceBlock(ObservedBlock):
    """(ground acceleration, command) → force.

    Parameters
    ----------
    campaign : Campaign
        A campaign with a structure, ground acceleration, command and force.
    scales : Scales
        How large things are.
    """

    block = Block.NUMERICAL
    channel = Channel.FORCE

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations = ()
        self.offsets = ()
        roles = (Role.RECORD, Role.INTEGRATION)
        self.candidates = tuple(effect for effect in library().values() if effect.role in roles)
        self.outside = ()
        self.motions = tuple(
            Motion3.through(test.channels[Channel.COMMAND], campaign.step) for test in campaign.tests
        )

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that balances ground motion and command [N], shape (n,)."""
        ground = self.tests[test].channels[Channel.GROUND]
        for effect in model.acting(Role.RECORD):
            if isinstance(effect, RecordEffect):
                ground = effect.applied(ground, 1.0 / self.rate)
        displacement, velocity, acceleration = self.motions[test].values
        shift = _shift(model)
        if shift:
            times = np.arange(acceleration.size, dtype=np.float64)
            acceleration = np.interp(times - shift * self.rate, times, acceleration)
        substructure = model.substructure
        demanded = acceleration + substructure.damping * velocity + substructure.stiffness * displacement
        return np.asarray(-model.mass * (ground + demanded))


def _shift(model: HybridTest) -> float:
    """Time [s] by which the integrated acceleration is ahead, x''(t − s) = u(t)."""
    if model.structure is None:
        return 0.0
    omega = model.structure.circular_frequency
    return sum(effect.shift(omega) for effect in model.effects if isinstance(effect, IntegrationError))
