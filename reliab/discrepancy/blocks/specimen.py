"""The specimen with the load cell: motion of the piston → force."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.calibration import stiffness
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign import Campaign, Channel
from reliab.discrepancy.outside import outside_terms
from reliab.loop.effects import Role, Scales, library
from reliab.loop.effects.force_bias import ForceBias
from reliab.loop.hybrid_test import HybridTest, Motion3, load, read_force
from reliab.vocabulary import Block

Array = NDArray[np.float64]


class SpecimenBlock(ObservedBlock):
    """Motion of the piston → force.

    Parameters
    ----------
    campaign : Campaign
        A campaign with a force.
    scales : Scales
        How large things are.
    pistons : sequence of Motion3
        Motion of the piston in every test, as the actuator's model or a smoother gives it.
    """

    block = Block.SPECIMEN
    channel = Channel.FORCE

    def __init__(self, campaign: Campaign, scales: Scales, pistons: Sequence[Motion3], *, every: int = 1) -> None:
        self.every = every
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        specimen = self.nominal.specimen
        stiff = specimen is not None and specimen.stiffness > 0.0
        self.calibrations = (stiffness(self.nominal),) if stiff else ()
        self.offsets = (ForceBias,)
        self.candidates = tuple(effect for effect in library().values() if effect.role is Role.FORCE)
        self.outside = outside_terms(self.block)
        self._pistons = tuple(pistons)

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that the load cell reads [N], shape (n,)."""
        piston = self._pistons[test]
        return read_force(model, piston, load(model, piston))
