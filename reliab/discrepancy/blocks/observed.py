"""An observed block: it predicts its channel from its input, for any model."""

from abc import ABC, abstractmethod
from collections.abc import Hashable, Mapping, Sequence
from copy import copy
from functools import lru_cache
from types import MappingProxyType
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import Calibration
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.segment import Segment, highest_frequency
from reliab.effects.added_mass import AddedMass
from reliab.effects.clock_offset import ClockOffset, LeadingReading
from reliab.effects.effect import Effect, Scales
from reliab.effects.viscous_damping import ViscousDamping
from reliab.signals.cubic_path import CubicPath
from reliab.signals.late_reading import record_late
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3

Term = TypeVar("Term", bound=Hashable)

_CACHED_SIGNALS, _CACHED_SPECTRA = 12, 40  # terms that are remembered for each test


class ObservedBlock(ABC):
    """A block whose input and output are known, or follow from what is known."""

    block: ClassVar[Block]  # Part of the loop
    channel: ClassVar[Channel]  # Its output
    inputs: ClassVar[tuple[Channel, ...]]  # What drives it

    campaign: Campaign  # The campaign
    tests: tuple[MeasuredTest, ...]  # Its tests, held-out ones too
    rate: float  # Sampling rate [Hz]
    every: int = 1  # Predictions are made at each `every`-th sample only
    scales: Scales  # Typical sizes of motion and force
    nominal: HybridTest  # The model before calibration
    highest: float  # Highest frequency at which models are judged [Hz]
    memory: float = 0.0  # Time [s] for which a free vibration from before a record goes on
    answer_time: float = 0.0  # Time at the end of a record [s] whose output shows in the input after it
    # Stated damping from which a damper of the specimen cannot be told [N·s/m], zero where it can
    structure_damping: float = 0.0
    calibrations: tuple[Calibration, ...]  # What is fitted in every model
    open_stiffness: Calibration | None = None  # Stiffness of any value, where a stated one is calibrated
    # Offsets of the sensor that are fitted in every model so that they hide nothing
    offsets: tuple[type[Effect], ...] = ()
    candidates: tuple[type[Effect], ...]  # Effects that may be missing in this block
    outside: tuple[type[Effect], ...] = ()  # Terms outside the library that are tried where something is left
    # Effects that the block may be unable to tell from one: they are fitted in its place, and data decide
    twins: ClassVar[Mapping[type[Effect], tuple[type[Effect], ...]]] = MappingProxyType({})
    # Effects that make the best linear model of the block, with its calibrations
    linear: ClassVar[tuple[type[Effect], ...]] = ()
    # Whether the channel is computed from derivatives, so that it says nothing of models above the
    # frequencies at which they are judged
    is_narrow: ClassVar[bool] = False
    # Motion of the piston in every test as far as it is known without a model, to locate the remaining error
    motions: tuple[Motion3, ...]

    def __init__(self, campaign: Campaign, scales: Scales) -> None:
        self.campaign, self.tests = campaign, campaign.tests
        self.rate = campaign.rate
        self.scales = scales
        self.nominal = campaign.nominal
        self.highest = self.highest_signal

    def release_stiffness(self) -> Self:
        """Return the same block, whose stiffness may have any value; itself where none is calibrated."""
        if self.open_stiffness is None:
            return self
        open_block, free = copy(self), self.open_stiffness
        open_block.calibrations = tuple(free if item.key == free.key else item for item in self.calibrations)
        return open_block

    def without_memory(self) -> "ObservedBlock":
        """Return the same block, in which the largest displacement so far is that of all tests."""
        return self

    @property
    def highest_signal(self) -> float:
        """Highest frequency at which there may be a signal [Hz]."""
        return highest_frequency(self.rate, self.nominal.structure)

    def highest_of(self, test: int) -> float:
        """Return the highest frequency at which models are judged in a test [Hz]."""
        del test
        return self.highest

    @property
    def sketch(self) -> "ObservedBlock":
        """The same block predicted at fewer instants, for derivatives; itself where it is fast anyway."""
        return self

    def thinning(self, rate: float) -> int:
        """Factor by which predictions can be thinned down to a least rate [Hz]."""
        return max(1, int(self.rate / self.every / rate))

    @property
    def removable(self) -> dict[type[Effect], float]:
        """Damping [N·s/m] and mass [kg] that are present; no more than these can be missing."""
        specimen = self.nominal.specimen
        return {
            ViscousDamping: specimen.damping if specimen else 0.0,
            AddedMass: specimen.mass if specimen else 0.0,
        }

    @abstractmethod
    def predict(self, model: HybridTest, test: int) -> Array:
        """Predict the channel in a test, shape (⌈n / every⌉,)."""

    def spectra(self, model: HybridTest, segments: Sequence[Segment]) -> list[Spectrum]:
        """Spectrum of the predicted channel in each segment, shape (bins,) each."""
        predictions = {test: self.predict(model, test) for test in {segment.test for segment in segments}}
        return [segment.coarse_spectrum(predictions[segment.test], self.every) for segment in segments]

    def measured(self, test: int) -> Array:
        """Return the channel as measured in a test, shape (n,)."""
        return self.tests[test].channels[self.channel]

    def interpolate(self, values: Array, test: int) -> Array:
        """Return predictions at all samples of a test, shape (n,)."""
        size = self.tests[test].size
        if self.every == 1:
            return values
        instants = self.every * np.arange(values.size, dtype=np.float64)
        return CubicPath.interpolate(instants, values)(np.arange(size, dtype=np.float64))


def lag_of(model: HybridTest) -> float:
    """Time by which the clocks of a model record a channel later than the other [s]."""
    late = sum(effect.lag_s for effect in model.effects if isinstance(effect, ClockOffset))
    return late - sum(effect.lead_s for effect in model.effects if isinstance(effect, LeadingReading))


class SuperposedBlock(ObservedBlock, Generic[Term]):
    """A block whose channel is a sum of terms, each of which is computed and transformed once."""

    def forget_terms(self) -> None:
        """Compute every term anew from here on."""
        count = len(self.tests)
        self._signal = lru_cache(maxsize=_CACHED_SIGNALS * count)(self.signal)
        self._spectra = lru_cache(maxsize=_CACHED_SPECTRA * count)(self._spectra_of_term)

    @abstractmethod
    def terms(self, model: HybridTest, test: int) -> Sequence[tuple[float, Term]]:
        """Terms that add up to the channel of a model in a test, each with its factor."""

    @abstractmethod
    def signal(self, term: Term, test: int) -> Array:
        """Compute one term in a test, shape (⌈n / every⌉,)."""

    def predict(self, model: HybridTest, test: int) -> Array:
        """Sum of the terms, as it is recorded, shape (⌈n / every⌉,)."""
        values = np.zeros(self.motions[test].values.shape[1])
        for factor, term in self.terms(model, test):
            values += factor * self._signal(term, test)
        return record_late(values, lag_of(model), self.motions[test].step)

    def spectra(self, model: HybridTest, segments: Sequence[Segment]) -> list[Spectrum]:
        """Spectrum of the channel in each segment, from terms whose spectra are remembered."""
        lag, spectra = lag_of(model), [np.zeros(segment.bins, dtype=np.complex128) for segment in segments]
        for test in dict.fromkeys(segment.test for segment in segments):
            places = [place for place, segment in enumerate(segments) if segment.test == test]
            test_segments = tuple(segments[place] for place in places)
            for factor, term in self.terms(model, test):
                for place, spectrum in zip(places, self._spectra(term, lag, test_segments), strict=True):
                    spectra[place] += factor * spectrum
        return spectra

    def _spectra_of_term(self, term: Term, lag: float, segments: tuple[Segment, ...]) -> tuple[Spectrum, ...]:
        """Spectrum of one term in each of some segments of one test, recorded by a clock that lags [s]."""
        test = segments[0].test
        values = record_late(self._signal(term, test), lag, self.motions[test].step)
        return tuple(segment.coarse_spectrum(values, self.every) for segment in segments)
