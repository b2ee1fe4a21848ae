"""The actuator with the displacement sensor: command → measured displacement."""

from collections.abc import Sequence
from copy import copy
from functools import cached_property, lru_cache

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import delay, gain
from reliab.discrepancy.blocks.observed import ObservedBlock, lag_of
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.effects.clock_offset import LeadingReading
from reliab.effects.effect import Role, Scales
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import library
from reliab.effects.sensor_bias import SensorBias
from reliab.signals.late_reading import record_late
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, drive, read_displacement

_DRIVE_ROLES = (Role.DELAY, Role.PISTON)
_SKETCHED_RATE = 500.0  # Hz
_FINEST_RATE = 2000.0  # Hz
_LARGEST_ERROR = 2e-5  # of an input that is taken as linear within a step, RMS over that of the input


class ActuatorBlock(ObservedBlock):
    """Command → measured displacement."""

    block = Block.ACTUATOR
    channel = Channel.MEASURED
    inputs = (Channel.COMMAND,)
    offsets = (SensorBias,)

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        super().__init__(campaign, scales)
        self.calibrations = (gain(self.nominal), delay(self.nominal))
        roles = (*_DRIVE_ROLES, Role.DISPLACEMENT_READING)
        effects = library().values()
        effects_here = (e for e in effects if e.role in roles and e is not SensorBias and e.refines is None)
        self.candidates = (*effects_here, LeadingReading)
        self.outside = general_terms(self.block)
        parts = _parts(campaign)
        commands = [
            Motion3.interpolate(test.channels[Channel.COMMAND], campaign.step, parts=parts)
            for test in self.tests
        ]
        self.command(commands, parts)
        self.motions = tuple(command.thin(parts) for command in commands)

    def command(self, motions: Sequence[Motion3], parts: int) -> None:
        """Compute the motion of the command in every test, at a number of steps for each prediction."""
        self._commands, self._parts = tuple(motions), parts
        self._driven = lru_cache(maxsize=6 * len(self.tests))(self._drive)

    def piston(self, model: HybridTest, test: int) -> Motion3:
        """Motion of the piston in a test."""
        drive_model = HybridTest(actuator=model.actuator, effects=model.acting(*_DRIVE_ROLES))
        return self._driven(drive_model, test)

    def _drive(self, model: HybridTest, test: int) -> Motion3:
        return drive(model, self._commands[test]).thin(self._parts)

    @cached_property
    def sketch(self) -> ObservedBlock:
        """The same, driven at a longer step."""
        factor = self.thinning(_SKETCHED_RATE)
        if factor * self._parts == 1:
            return self
        thinned_block = copy(self)
        thinned_block.every = factor
        thinned_block.command([command.thin(self._parts * factor) for command in self._commands], 1)
        return thinned_block

    def predict(self, model: HybridTest, test: int) -> Array:
        """Displacement that the sensor reads [m], shape (n,)."""
        piston = self.piston(model, test)
        return record_late(read_displacement(model, piston), lag_of(model), piston.step)


def _parts(campaign: Campaign) -> int:
    """Return the steps of a simulation to each sample, fine enough for the frequencies in the commands.

    Between the ends of a step h a command u(t) differs from a straight line by h²u''/12 on the average.
    """
    slowest = np.inf
    for test in campaign.tests:
        command = Motion3.interpolate(test.channels[Channel.COMMAND], campaign.step).values
        size, curvature = (float(np.std(command[k])) for k in (0, 2))
        slowest = min(slowest, np.sqrt(12.0 * _LARGEST_ERROR * size / max(curvature, 1e-300)))
    rate = min(1.0 / max(slowest, 1e-300), _FINEST_RATE)
    return max(1, int(np.ceil(rate / campaign.rate - 0.05)))
