"""The rebuilt error of a test: histories, RMS^R and MTE^R, intervals and probabilities."""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.displacement_error import DisplacementError
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.interval import Histories, Unknown
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.parts import Part, Parts, divide, part_of_tracking
from reliab.assessment.rebuilt_error.spread import Spread
from reliab.assessment.rebuilt_error.widenings import Widening, widenings
from reliab.structures import Partition
from reliab.vocabulary import Metric

_WIDENING_DRAWS = 128


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltError(DisplacementError):
    """The error of a test with its uncertainty."""

    time_step: float  # Step between samples [s]
    structure: Partition  # The structure with which it was rebuilt
    noise: SensorNoise  # Noise of the displacement sensor
    start: Start  # How the test begins, and the sensor's offset
    unknown: Unknown  # Standard deviations that went into the intervals
    histories: Histories  # Smoothed histories from which the error is rebuilt
    # Draws of x_c − x_m that the noise leaves open [m], as many as widenings need, shape (at most 128,
    # ceil(n/every))
    differences: Array
    every: int  # Number of samples of which one was drawn
    seed: int  # Seed of the draws

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (1, n)."""
        return self.histories.command[np.newaxis]

    def parts(self) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force."""
        return divide(self.histories, self.structure)

    def part_of_tracking(self, followed: Array) -> Part:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        return part_of_tracking(self.histories, self.structure, followed)

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        return widenings(
            self.histories,
            self.structure,
            self.unknown,
            self.differences,
            self.every,
            metric=metric,
            draws=_WIDENING_DRAWS,
            seed=self.seed,
        )


def conclude(
    histories: Histories,
    read: Array,
    reference: Array,
    *,
    structure: Partition,
    noise: SensorNoise,
    as_stated: Spread,
    spread: Spread,
    differences: Array,
    every: int,
    unknown: Unknown,
    start: Start,
    seed: int,
) -> RebuiltError:
    """Combine histories, noise and draws into a rebuilt error.

    `read`, `reference` [m].
    """
    return RebuiltError(
        time_step=histories.time_step,
        structure=structure,
        error=read - reference,
        smooth_error=histories.measured - reference,
        reference=reference,
        rms=spread.estimate(Metric.RMS, float(np.median(as_stated.rms))),
        mte=spread.estimate(Metric.MTE, float(np.median(as_stated.mte))),
        draws=spread,
        noise=noise,
        start=start,
        unknown=unknown,
        histories=histories,
        differences=differences[:_WIDENING_DRAWS].copy(),  # the others are many times the histories
        every=every,
        seed=seed,
    )
