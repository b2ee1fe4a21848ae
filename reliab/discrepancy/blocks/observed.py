"""An observed block: it predicts its channel from its input, for any model."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicSpline

from reliab.core.arrays import Array, Spectrum
from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.calibration import Calibration
from reliab.discrepancy.campaign.campaign import Channel, MeasuredTest
from reliab.discrepancy.spectra.segment import Segment
from reliab.discrepancy.spectra.smoothing import highest_frequency
from reliab.effects.added_mass import AddedMass
from reliab.effects.effect import Effect, Scales
from reliab.effects.viscous_damping import ViscousDamping
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3


class ObservedBlock(ABC):
    """A block whose input and output are known, or follow from what is known."""

    block: ClassVar[Block]  # Part of the loop
    channel: ClassVar[Channel]  # Its output
    inputs: ClassVar[tuple[Channel, ...]]  # What drives it

    tests: tuple[MeasuredTest, ...]  # The tests of the campaign, held-out ones too
    rate: float  # Sampling rate [Hz]
    every: int = 1  # Predictions are made at each `every`-th sample only
    scales: Scales  # Typical sizes of motion and force
    nominal: HybridTest  # The model before calibration
    calibrations: tuple[Calibration, ...]  # What is fitted in every model
    # Offsets of the sensor that are fitted in every model so that they hide nothing
    offsets: tuple[type[Effect], ...]
    candidates: tuple[type[Effect], ...]  # Effects that may be missing in this block
    outside: tuple[type[Effect], ...]  # Terms outside the library that are tried where something is left
    # Effects that the block may be unable to tell from one: they are fitted in its place, and data decide
    twins: ClassVar[Mapping[type[Effect], tuple[type[Effect], ...]]] = MappingProxyType({})
    # Motion of the piston in every test as far as it is known without a model, to locate the remaining error
    motions: tuple[Motion3, ...]

    @property
    def highest_signal(self) -> float:
        """Highest frequency at which there may be a signal [Hz]."""
        return highest_frequency(self.rate, self.nominal.structure)

    @property
    def highest(self) -> float:
        """Highest frequency at which models are judged [Hz]."""
        return self.highest_signal

    def highest_of(self, test: int) -> float:
        """Return the highest frequency at which models are judged in a test [Hz]."""
        del test
        return self.highest

    @property
    def memory(self) -> float:
        """Time [s] for which a free vibration from before a record goes on; zero where nothing vibrates."""
        return 0.0

    @property
    def unanswered(self) -> float:
        """Time at the end of a record [s] of which the output shows in the input only after it."""
        return 0.0

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

    @property
    def structure_damping(self) -> float:
        """Stated damping from which a damper of the specimen cannot be told [N·s/m], zero where it can."""
        return 0.0

    @abstractmethod
    def predict(self, model: HybridTest, test: int) -> Array:
        """Predict the channel in a test, shape (⌈n / every⌉,)."""

    def spectra(self, model: HybridTest, segments: Sequence[Segment]) -> list[Spectrum]:
        """Spectrum of the predicted channel in each segment, shape (bins,) each."""
        predicted = {test: self.predict(model, test) for test in {segment.test for segment in segments}}
        return [segment.coarse_spectrum(predicted[segment.test], self.every) for segment in segments]

    def measured(self, test: int) -> Array:
        """Return the channel as measured in a test, shape (n,)."""
        return self.tests[test].channels[self.channel]

    def at_rate(self, values: Array, test: int) -> Array:
        """Return predictions at all samples of a test, shape (n,)."""
        size = self.tests[test].size
        if self.every == 1:
            return values
        spline = CubicSpline(self.every * np.arange(values.size), values)
        return np.asarray(spline(np.arange(size)))
