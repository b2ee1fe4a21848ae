"""The actuator with the displacement sensor: command → measured displacement."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.calibration import delay, gain
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign import Campaign, Channel
from reliab.discrepancy.outside import outside_terms
from reliab.loop.effects import Role, Scales, library
from reliab.loop.effects.sensor_bias import SensorBias
from reliab.loop.hybrid_test import HybridTest, Motion3, drive, read_displacement
from reliab.vocabulary import Block

Array = NDArray[np.float64]

_ON_THE_WAY = (Role.DELAY, Role.PISTON)
_FINEST_RATE = 2000.0  # Hz, so that an input that is taken as linear within a step is


class ActuatorBlock(ObservedBlock):
    """Command → measured displacement.

    Parameters
    ----------
    campaign : Campaign
        A campaign with both channels.
    scales : Scales
        How large things are.
    """

    block = Block.ACTUATOR
    channel = Channel.MEASURED

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations = (gain(self.nominal), delay(self.nominal))
        self.offsets = (SensorBias,)
        roles = (*_ON_THE_WAY, Role.DISPLACEMENT_READING)
        known = library().values()
        self.candidates = tuple(e for e in known if e.role in roles and e is not SensorBias)
        self.outside = outside_terms(self.block)
        self._parts = max(1, int(np.ceil(_FINEST_RATE / campaign.rate - 0.05)))
        self._commands = [
            Motion3.through(test.channels[Channel.COMMAND], campaign.step, parts=self._parts)
            for test in self.tests
        ]
        self.motions = tuple(command.at_each(self._parts) for command in self._commands)
        self._driven = lru_cache(maxsize=6 * len(self.tests))(self._drive)

    def piston(self, model: HybridTest, test: int) -> Motion3:
        """Motion of the piston in a test."""
        moved = HybridTest(actuator=model.actuator, effects=model.acting(*_ON_THE_WAY))
        return self._driven(moved, test)

    def _drive(self, model: HybridTest, test: int) -> Motion3:
        return drive(model, self._commands[test]).at_each(self._parts)

    def predict(self, model: HybridTest, test: int) -> Array:
        """Displacement that the sensor reads [m], shape (n,)."""
        return read_displacement(model, self.piston(model, test))
