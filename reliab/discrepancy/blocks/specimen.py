"""The specimen with the load cell: motion of the piston → force."""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import pairwise
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import lag_of_force, stiffness
from reliab.discrepancy.blocks.observed import ObservedBlock, SuperposedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.effects.added_mass import AddedMass
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect, Role, Scales, SteppedEffect
from reliab.effects.force_bias import ForceBias
from reliab.effects.general.general_terms import general_terms
from reliab.effects.kernel import Kernel
from reliab.effects.registry import library
from reliab.effects.sensor_drift import SensorDrift
from reliab.effects.series_play import SeriesPlay
from reliab.effects.viscous_damping import ViscousDamping
from reliab.signals.noise import harmonics_up_to, reliable_frequency
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, follow, load, read_displacement, read_force
from reliab.structures.frame import Specimen

_SKETCHED_RATE = 250.0  # Hz
_CACHED_FORCES = 4  # of recordings, from the last models in two threads
_AT_CUT = 25  # samples on either side of the cut between two tests
_STEP_AT_CUT = 2.0  # times the largest step of these: one recording was cut there
_AWAY = 0.5  # from rest, of the usual displacement and of the usual way in as many samples


class SpecimenTerm(NamedTuple):
    """A force under a given motion, up to a factor."""

    source: Kernel | int  # Kernel, or row of the motion to which the force is proportional
    numbers: tuple[float, ...] = ()  # Coefficients of the kernel
    sensor: tuple[Effect, ...] = ()  # What the displacement sensor adds to the smoothed motion that it read


class SpecimenBlock(SuperposedBlock[HybridTest | SpecimenTerm]):
    """Motion of the piston → force."""

    block = Block.SPECIMEN
    channel = Channel.FORCE
    inputs = (Channel.MEASURED,)
    offsets = (ForceBias,)
    linear = (ViscousDamping, AddedMass)
    forgets = False  # Whether a specimen knows from the beginning how far it will be moved
    twins = MappingProxyType({ViscousDamping: (ClockOffset,), ClockOffset: (ViscousDamping, AddedMass)})

    def __init__(
        self,
        campaign: Campaign,
        scales: Scales,
        pistons: Sequence[Motion3],
        *,
        is_smoothed: bool = False,
        is_timed: bool = True,
    ) -> None:
        """Take the motion of the piston; unless it is `is_timed`, the lag of the force is calibrated."""
        super().__init__(campaign, scales)
        specimen = self.nominal.specimen or Specimen(stiffness=0.0)
        is_stated = specimen.stiffness > 0.0
        if not is_stated:
            self.nominal = HybridTest(mass=campaign.mass, specimen=specimen)
        self.open_stiffness = stiffness(self.nominal, scales)
        spring = stiffness(self.nominal) if is_stated else self.open_stiffness
        self.calibrations = (spring,) if is_timed else (spring, lag_of_force())
        forces = (e for e in library().values() if e.role is Role.FORCE and e.refines is None)
        sensor: tuple[type[Effect], ...] = (SensorDrift,) if is_smoothed else ()
        self.candidates = (*forces, *sensor, *((ClockOffset,) if is_timed else ()))
        self.outside = general_terms(self.block)
        self.smoothed = is_smoothed
        goes_on = [False, *(_continues(a, b) for a, b in pairwise(self.tests))]
        self._beginnings = np.maximum.accumulate(np.where(goes_on, 0, np.arange(len(goes_on)))).tolist()
        self.highest = self.highest_signal
        if is_smoothed:  # that up to which the motion is known well
            self.highest = reliable_frequency(self._readings, 1.0 / self.rate, self.highest_signal)
        self.move(pistons)

    def move(self, pistons: Sequence[Motion3]) -> None:
        """Take the motion of the piston in every test."""
        self.motions = tuple(pistons)
        peaks = [float(np.abs(piston.values[0]).max()) for piston in self.motions]
        earlier = np.full(len(peaks), max(peaks)) if self.forgets else np.maximum.accumulate([0.0, *peaks])
        self._moved_before = earlier.tolist()
        self._forces = lru_cache(maxsize=_CACHED_FORCES)(self._forces_in_recording)
        self._pistons = lru_cache(maxsize=_CACHED_FORCES)(self._piston_in_recording)
        self.forget_terms()

    def without_memory(self) -> "SpecimenBlock":
        """Return the same block, in which the largest displacement so far is that of all tests."""
        block = copy(self)
        block.forgets = True
        block.__dict__.pop("sketch", None)
        block.move(self.motions)
        return block

    @property
    def _readings(self) -> list[Array]:
        """Measured displacement in every test [m]."""
        return [test.channels[Channel.MEASURED] for test in self.tests]

    def highest_of(self, test: int) -> float:
        """Return the highest frequency at which models are judged in a test [Hz]: harmonics under a sine."""
        if not self.smoothed:
            return self.highest
        harmonics = harmonics_up_to(self._readings[test], 1.0 / self.rate)
        return min(max(self.highest, harmonics), self.highest_signal)

    @cached_property
    def sketch(self) -> ObservedBlock:
        """The same under a motion of fewer samples."""
        factor = self.thinning(_SKETCHED_RATE)
        if factor == 1:
            return self
        thinned_block = copy(self)
        thinned_block.every = factor
        thinned_block.move([motion.thin(factor) for motion in self.motions])
        return thinned_block

    def terms(self, model: HybridTest, test: int) -> list[tuple[float, HybridTest | SpecimenTerm]]:
        """Return the forces that add up to that of a model in a test, each with its factor.

        There is a single one where effects change the motion that others see.
        """
        tested_model = replace(model, moved_before=self._moved_before[self._beginnings[test]])
        if any(isinstance(effect, SeriesPlay) for effect in model.effects):
            other_effects = (effect for effect in tested_model.effects if not isinstance(effect, ClockOffset))
            return [(1.0, replace(tested_model, effects=tuple(other_effects)))]
        specimen = model.specimen or Specimen(stiffness=0.0)
        linear = (specimen.stiffness, specimen.damping, specimen.mass)
        sensor = self._sensor(model)
        terms: list[tuple[float, HybridTest | SpecimenTerm]]
        terms = [
            (factor, SpecimenTerm(source=row, sensor=sensor))
            for row, factor in enumerate(linear)
            if factor != 0.0
        ]
        setting = tested_model.setting(self.motions[test].step)
        for effect in model.acting(Role.FORCE, Role.FORCE_READING):
            if isinstance(effect, SteppedEffect) and not isinstance(effect, ClockOffset):
                numbers, factor = effect.coefficients(setting).tolist(), 1.0
                if effect.kernel.linear is not None:
                    factor, numbers[effect.kernel.linear] = numbers[effect.kernel.linear], 1.0
                terms.append((factor, SpecimenTerm(effect.kernel, tuple(numbers), sensor)))
        return terms

    def _sensor(self, model: HybridTest) -> tuple[Effect, ...]:
        """Give what a model's sensor adds to the motion, where the smoothed one that it read is known."""
        return model.acting(Role.DISPLACEMENT_READING) if self.smoothed else ()

    def signal(self, term: HybridTest | SpecimenTerm, test: int) -> Array:
        """Return a force in a test, or that of a whole model [N], shape (n,)."""
        first = self._beginnings[test]
        return np.asarray(self._forces(term, first)[test - first])

    def _forces_in_recording(self, term: HybridTest | SpecimenTerm, first: int) -> list[Array]:
        """Compute a force in all tests of one recording: what the specimen remembers goes on between them."""
        sensor = self._sensor(term) if isinstance(term, HybridTest) else term.sensor
        piston = self._pistons(sensor, first)
        if isinstance(term, HybridTest):
            force = read_force(term, piston, load(term, piston))
        elif isinstance(term.source, Kernel):
            force = follow(term.source, term.numbers, piston)
        else:
            force = np.asarray(piston.values[term.source])
        sizes = [motion.values.shape[1] for motion in self._motions_of_recording(first)]
        return np.split(force, np.cumsum(sizes[:-1]))

    def _motions_of_recording(self, first: int) -> Sequence[Motion3]:
        return self.motions[first : first + self._beginnings.count(first)]

    def _piston_in_recording(self, sensor: tuple[Effect, ...], first: int) -> Motion3:
        """Motion of the piston in all tests of one recording, without what the sensor added."""
        motions = self._motions_of_recording(first)
        values = np.concatenate([motion.values for motion in motions], axis=1)
        piston = Motion3(values=values, step=motions[0].step)
        return _remove_reading(HybridTest(effects=sensor), piston) if sensor else piston


def _continues(earlier: MeasuredTest, later: MeasuredTest) -> bool:
    """Whether a test goes on where another ends: one recording was cut while the specimen moved.

    Tests of their own begin or end at rest, where the specimen neither moves nor is moved.
    """
    for channel in (Channel.MEASURED, Channel.FORCE):
        before, after = earlier.channels[channel][-_AT_CUT:], later.channels[channel][:_AT_CUT]
        largest_step = max(float(np.abs(np.diff(values)).max()) for values in (before, after))
        if abs(float(after[0] - before[-1])) > _STEP_AT_CUT * largest_step:
            return False
    readings = [test.channels[Channel.MEASURED] for test in (earlier, later)]
    ends = (readings[0][-_AT_CUT:], readings[1][:_AT_CUT])
    moves = np.concatenate([values[_AT_CUT - 1 :] - values[: 1 - _AT_CUT] for values in readings])
    values = np.concatenate(readings)
    places = [(end.mean() - values.mean()) / values.std() for end in ends]
    ways = [(end[-1] - end[0]) / moves.std() for end in ends]
    return bool(min(np.hypot(places, ways)) > _AWAY)


def _remove_reading(model: HybridTest, reading: Motion3) -> Motion3:
    """Motion of the piston where a reading of it was smoothed, with the sensor's own effects removed."""
    sensor_error = read_displacement(model, reading) - reading.values[0]
    values = reading.values.copy()
    values[0] -= sensor_error
    values[1] -= np.gradient(sensor_error, reading.step)
    return Motion3(values=values, step=reading.step)
