"""The specimen with the load cell: motion of the piston → force."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property, lru_cache
from types import MappingProxyType

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.blocks.calibration import (
    Calibration,
    open_stiffness,
    stiffness,
    unknown_stiffness,
)
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.spectra.smoothing import harmonics_up_to, reliable_frequency, velocity_spread
from reliab.discrepancy.terms import ClockOffset, ElasticStops, SoftenedSpring, outside_terms, with_clock
from reliab.effects import (
    AddedMass,
    Effect,
    ForceBias,
    Kernel,
    QuadraticDamping,
    Role,
    Scales,
    SensorDrift,
    SeriesPlay,
    SteppedEffect,
    ViscousDamping,
    library,
)
from reliab.simulation.hybrid_test import HybridTest, Motion3, follow, load, read_displacement, read_force
from reliab.structures import Specimen
from reliab.vocabulary import Block

_NODES = np.sqrt(3.0) * np.array([-1.0, 0.0, 1.0])  # of Gauss and Hermite
_WEIGHTS = np.array([1.0, 4.0, 1.0]) / 6.0
_SKETCHED_RATE = 250.0  # Hz
_CACHED_FORCES = 12  # forces of effects that are remembered for each test


class SpecimenBlock(ObservedBlock):
    """Motion of the piston → force."""

    block = Block.SPECIMEN
    channel = Channel.FORCE
    inputs = (Channel.MEASURED,)
    twins = MappingProxyType({ViscousDamping: (ClockOffset,), ClockOffset: (ViscousDamping, AddedMass)})

    def __init__(
        self, campaign: Campaign, scales: Scales, pistons: Sequence[Motion3], *, smoothed: bool = False
    ) -> None:
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations: tuple[Calibration, ...] = (stiffness(self.nominal),)
        specimen = self.nominal.specimen or Specimen(stiffness=0.0)
        if not specimen.stiffness > 0.0:
            self.nominal = HybridTest(mass=campaign.mass, specimen=specimen)
            self.calibrations = (unknown_stiffness(),)
        self.offsets = (ForceBias,)
        in_force = tuple(
            effect for effect in library().values() if effect.role is Role.FORCE and effect.refines is None
        )
        of_sensor: tuple[type[Effect], ...] = (SensorDrift,) if smoothed else ()
        self.candidates = (*in_force, *of_sensor, ClockOffset)
        self.outside = (*outside_terms(self.block), SoftenedSpring, ElasticStops)
        self.smoothed = smoothed
        self._spreads = self._velocity_spreads() if smoothed else []
        self.move(pistons)

    def move(self, pistons: Sequence[Motion3]) -> None:
        """Compute the motion of the piston in every test."""
        self.motions = tuple(pistons)
        peaks = [float(np.abs(piston.values[0]).max()) for piston in self.motions]
        self._moved_before = np.maximum.accumulate([0.0, *peaks]).tolist()
        self._followed = lru_cache(maxsize=_CACHED_FORCES * len(self.tests))(self._follow_one)

    def with_open_stiffness(self) -> "SpecimenBlock":
        """Return the same block, whose stiffness may be any multiple of the stated one."""
        opened = copy(self)
        opened.__dict__.pop("sketch", None)
        opened.calibrations = (open_stiffness(self.nominal),)
        opened.move(self.motions)
        return opened

    def _velocity_spreads(self) -> list[float]:
        readings = [test.channels[Channel.MEASURED] for test in self.tests]
        return [velocity_spread(reading, 1.0 / self.rate, self.highest_signal) for reading in readings]

    @cached_property
    def highest(self) -> float:
        """Highest frequency at which models are judged [Hz]: that up to which the motion is known well."""
        if not self.smoothed:
            return super().highest
        readings = [test.channels[Channel.MEASURED] for test in self.tests]
        return reliable_frequency(readings, 1.0 / self.rate, self.highest_signal)

    def highest_of(self, test: int) -> float:
        """Return the highest frequency at which models are judged in a test [Hz]: harmonics under a sine."""
        if not self.smoothed:
            return self.highest
        reading = self.tests[test].channels[Channel.MEASURED]
        return min(max(self.highest, harmonics_up_to(reading, 1.0 / self.rate)), self.highest_signal)

    @cached_property
    def sketch(self) -> ObservedBlock:
        """The same under a motion of fewer samples."""
        factor = self.thinning(_SKETCHED_RATE)
        if factor == 1:
            return self
        thinned = copy(self)
        thinned.every = factor
        thinned.move([motion.at_each(factor) for motion in self.motions])
        return thinned

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that the load cell reads [N], shape (n,)."""
        followed = replace(model, moved_before=self._moved_before[test])
        return with_clock(model, self._force(followed, test), self.motions[test].step)

    def _force(self, model: HybridTest, test: int) -> Array:
        """Predict the force as if all channels had one clock."""
        piston = self.motions[test]
        if self.smoothed and model.acting(Role.DISPLACEMENT_READING):
            piston = _without_reading(model, piston)
        if self.smoothed and any(isinstance(effect, QuadraticDamping) for effect in model.effects):
            return read_force(model, piston, self._expected_load(model, piston, test))
        if piston is not self.motions[test] or any(
            isinstance(effect, SeriesPlay) for effect in model.effects
        ):
            return read_force(model, piston, load(model, piston))
        setting = model.setting(piston.step)
        force = load(replace(model, effects=()), piston)
        for effect in model.acting(Role.FORCE, Role.FORCE_READING):
            if isinstance(effect, SteppedEffect):
                numbers = tuple(effect.coefficients(setting).tolist())
                force += self._followed(effect.kernel, numbers, test)
        return force

    def _follow_one(self, kernel: Kernel, numbers: tuple[float, ...], test: int) -> Array:
        """Force that one effect adds [N]; under a given motion the effects are independent of each other."""
        return follow(kernel, numbers, self.motions[test])

    def _expected_load(self, model: HybridTest, piston: Motion3, test: int) -> Array:
        """Mean of the force where the velocity is known up to its spread only."""
        expected = np.zeros(piston.values.shape[1])
        for node, weight in zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True):
            values = piston.values.copy()
            values[1] += node * self._spreads[test]
            expected += weight * load(model, Motion3(values=values, step=piston.step))
        return expected


def _without_reading(model: HybridTest, reading: Motion3) -> Motion3:
    """Motion of the piston where a reading of it was smoothed, with the sensor's own effects removed."""
    added = read_displacement(model, reading) - reading.values[0]
    values = reading.values.copy()
    values[0] -= added
    values[1] -= np.gradient(added, reading.step)
    return Motion3(values=values, step=reading.step)
