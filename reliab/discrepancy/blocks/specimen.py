"""The specimen with the load cell: motion of the piston → force."""

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from dataclasses import replace
from functools import cached_property, lru_cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import (
    Calibration,
    free_stiffness,
    lag_of_force,
    stiffness,
)
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.spectra.segment import Segment
from reliab.discrepancy.spectra.smoothing import harmonics_up_to, reliable_frequency, velocity_spread
from reliab.discrepancy.terms.clock_offset import ClockOffset, lag_of, path_through, read_late, with_clock
from reliab.effects.added_mass import AddedMass
from reliab.effects.effect import Effect, Role, Scales, SteppedEffect
from reliab.effects.force_bias import ForceBias
from reliab.effects.general.general_terms import general_terms
from reliab.effects.kernel import Kernel
from reliab.effects.quadratic_damping import QuadraticDamping
from reliab.effects.registry import library
from reliab.effects.sensor_drift import SensorDrift
from reliab.effects.series_play import SeriesPlay
from reliab.effects.viscous_damping import ViscousDamping
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, follow, load, read_displacement, read_force
from reliab.structures.specimen import Specimen

_NODES = np.sqrt(3.0) * np.array([-1.0, 0.0, 1.0])  # of Gauss and Hermite
_WEIGHTS = np.array([1.0, 4.0, 1.0]) / 6.0
_SKETCHED_RATE = 250.0  # Hz
_CACHED_FORCES, _CACHED_SPECTRA, _CACHED_PATHS = 12, 40, 4  # terms that are remembered for each test


class SpecimenBlock(ObservedBlock):
    """Motion of the piston → force."""

    block = Block.SPECIMEN
    channel = Channel.FORCE
    inputs = (Channel.MEASURED,)
    linear = (ViscousDamping, AddedMass)
    twins = MappingProxyType({ViscousDamping: (ClockOffset,), ClockOffset: (ViscousDamping, AddedMass)})

    def __init__(
        self,
        campaign: Campaign,
        scales: Scales,
        pistons: Sequence[Motion3],
        *,
        smoothed: bool = False,
        timed: bool = True,
    ) -> None:
        """Take the motion of the piston; unless it is `timed`, the lag of the force is calibrated."""
        self.tests = campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.calibrations: tuple[Calibration, ...] = (stiffness(self.nominal),)
        specimen = self.nominal.specimen or Specimen(stiffness=0.0)
        if not specimen.stiffness > 0.0:
            self.nominal = HybridTest(mass=campaign.mass, specimen=specimen)
            self.calibrations = (free_stiffness(self.nominal, scales),)
        self.offsets = (ForceBias,)
        in_force = tuple(
            effect for effect in library().values() if effect.role is Role.FORCE and effect.refines is None
        )
        of_sensor: tuple[type[Effect], ...] = (SensorDrift,) if smoothed else ()
        self.candidates = (*in_force, *of_sensor, *((ClockOffset,) if timed else ()))
        if not timed:
            self.calibrations += (lag_of_force(),)
        self.outside = general_terms(self.block)
        self.smoothed = smoothed
        self._spreads = self._velocity_spreads() if smoothed else []
        self.move(pistons)

    def move(self, pistons: Sequence[Motion3]) -> None:
        """Compute the motion of the piston in every test."""
        self.motions = tuple(pistons)
        peaks = [float(np.abs(piston.values[0]).max()) for piston in self.motions]
        self._moved_before = np.maximum.accumulate([0.0, *peaks]).tolist()
        self._followed = lru_cache(maxsize=_CACHED_FORCES * len(self.tests))(self._follow_one)
        self._path = lru_cache(maxsize=_CACHED_PATHS * len(self.tests))(self._path_of_one)
        self._seen = lru_cache(maxsize=_CACHED_SPECTRA * len(self.tests))(self._seen_one)

    def with_open_stiffness(self) -> "SpecimenBlock":
        """Return the same block, whose stiffness may be any multiple of the stated one."""
        opened = copy(self)
        opened.__dict__.pop("sketch", None)
        opened.calibrations = (free_stiffness(self.nominal, self.scales), *self.calibrations[1:])
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
        thinned.move([motion.thin(factor) for motion in self.motions])
        return thinned

    def predict(self, model: HybridTest, test: int) -> Array:
        """Force that the load cell reads [N], shape (n,)."""
        if self._independent(model):
            force = np.zeros(self.motions[test].values.shape[1])
            for factor, term in self._terms(model, test):
                force += factor * self._followed(term, test)
        else:
            force = self._coupled(replace(model, moved_before=self._moved_before[test]), test)
        return with_clock(model, force, self.motions[test].step)

    def spectra(self, model: HybridTest, segments: Sequence[Segment]) -> list[Spectrum]:
        """Spectrum of the predicted force in each segment, of forces whose spectra are remembered."""
        if not self._independent(model):
            return super().spectra(model, segments)
        lag, spectra = lag_of(model), [np.zeros(segment.bins, dtype=np.complex128) for segment in segments]
        for test in dict.fromkeys(segment.test for segment in segments):
            places = [place for place, segment in enumerate(segments) if segment.test == test]
            of_test = tuple(segments[place] for place in places)
            for factor, term in self._terms(model, test):
                for place, spectrum in zip(places, self._seen(term, lag, of_test), strict=True):
                    spectra[place] += factor * spectrum
        return spectra

    def _independent(self, model: HybridTest) -> bool:
        """Whether the given motion is that of the specimen, so that no effect changes another's force."""
        smoothed = self.smoothed and bool(model.acting(Role.DISPLACEMENT_READING))
        return not (smoothed or any(isinstance(effect, SeriesPlay) for effect in model.effects))

    def _terms(self, model: HybridTest, test: int) -> list[tuple[float, "Term"]]:
        """Return the forces that add up to that of a model in a test, each with its factor."""
        specimen = model.specimen or Specimen(stiffness=0.0)
        linear = (specimen.stiffness, specimen.damping, specimen.mass)
        terms = [(factor, Term(source=row)) for row, factor in enumerate(linear) if factor != 0.0]
        setting = replace(model.setting(self.motions[test].step), moved_before=self._moved_before[test])
        spread = self._velocity_is_spread(model)
        for effect in model.acting(Role.FORCE, Role.FORCE_READING):
            if isinstance(effect, SteppedEffect) and not isinstance(effect, ClockOffset):
                expected = spread and effect.role is Role.FORCE and not effect.kernel.by_path
                terms.append(_term(effect.kernel, effect.coefficients(setting).tolist(), expected))
        return terms

    def _velocity_is_spread(self, model: HybridTest) -> bool:
        """Whether a force depends so much on the velocity that its mean over the velocity's spread counts."""
        return self.smoothed and any(isinstance(effect, QuadraticDamping) for effect in model.effects)

    def _follow_one(self, term: "Term", test: int) -> Array:
        """Force of one term in a test, shape (n,)."""
        piston = self.motions[test]
        if not isinstance(term.source, Kernel):
            row: Array = piston.values[term.source]
            return row
        if not term.expected:
            return follow(term.source, term.numbers, piston)
        faster = self._at_velocities(piston, test)
        return _mean((weight, follow(term.source, term.numbers, moved)) for weight, moved in faster)

    def _seen_one(self, term: "Term", lag: float, segments: tuple[Segment, ...]) -> tuple[Spectrum, ...]:
        """Spectrum of one term in each of some segments of one test, recorded by a clock that lags [s]."""
        test = segments[0].test
        late = lag / self.motions[test].step
        force = read_late(self._path(term, test), late) if late else self._followed(term, test)
        return tuple(segment.coarse_spectrum(force, self.every) for segment in segments)

    def _path_of_one(self, term: "Term", test: int) -> Array:
        """Coefficients of the path through the force of one term in a test."""
        return path_through(self._followed(term, test))

    def _coupled(self, model: HybridTest, test: int) -> Array:
        """Predict the force where effects change the motion that others see, as if there were one clock."""
        piston = self.motions[test]
        if self.smoothed and model.acting(Role.DISPLACEMENT_READING):
            piston = _without_reading(model, piston)
        if not self._velocity_is_spread(model):
            return read_force(model, piston, load(model, piston))
        faster = self._at_velocities(piston, test)
        return read_force(model, piston, _mean((weight, load(model, moved)) for weight, moved in faster))

    def _at_velocities(self, piston: Motion3, test: int) -> Iterator[tuple[float, Motion3]]:
        """Motions at the velocities over which a mean is taken, each with its weight."""
        for node, weight in zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True):
            values = piston.values.copy()
            values[1] += node * self._spreads[test]
            yield weight, Motion3(values=values, step=piston.step)


class Term(NamedTuple):
    """A force under a given motion, up to a factor."""

    source: Kernel | int  # Kernel, or row of the motion to which the force is proportional
    numbers: tuple[float, ...] = ()  # Coefficients of the kernel
    expected: bool = False  # Whether it is the mean over velocities that are known up to their spread


def _term(kernel: Kernel, numbers: list[float], expected: bool) -> tuple[float, Term]:  # noqa: FBT001
    """Take the coefficient to which a kernel is proportional, if there is one, for a factor."""
    factor = 1.0
    if kernel.linear is not None:
        factor, numbers[kernel.linear] = numbers[kernel.linear], 1.0
    return factor, Term(source=kernel, numbers=tuple(numbers), expected=expected)


def _mean(weighted: Iterable[tuple[float, Array]]) -> Array:
    """Mean of forces by weights that sum to one."""
    return np.asarray(np.sum([weight * force for weight, force in weighted], axis=0))


def _without_reading(model: HybridTest, reading: Motion3) -> Motion3:
    """Motion of the piston where a reading of it was smoothed, with the sensor's own effects removed."""
    added = read_displacement(model, reading) - reading.values[0]
    values = reading.values.copy()
    values[0] -= added
    values[1] -= np.gradient(added, reading.step)
    return Motion3(values=values, step=reading.step)
