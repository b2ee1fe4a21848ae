"""The rebuilt error of a test: histories, RMS^R and MTE^R, intervals and probabilities."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.interval import (
    Histories,
    Unknown,
    draw_unknown,
    driven_draws,
    states_at_first_sample,
    structures_of_draws,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.parts import Part, Parts, divide, part_of_tracking
from reliab.assessment.rebuilt_error.recursion import Recursion, structure_of_draw
from reliab.assessment.rebuilt_error.spread import DisplacementError, Spread
from reliab.assessment.rebuilt_error.widenings import Widening, widenings
from reliab.structures import Partition
from reliab.vocabulary import Metric

_WIDENING_DRAWS, _EXACT_DRAWS = 128, 64


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

    def exact(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors [m], shape (1, m), of the first draws."""
        thin = self.histories.thinned(self.every)
        drawn, moving = draw_unknown(self.unknown, _EXACT_DRAWS, self.seed)
        structures = structures_of_draws(self.structure, drawn)
        recursion = Recursion.of_displacement(structures, thin.time_step).of_draws(_EXACT_DRAWS)
        at_first = (drawn["initial_state"], moving, thin.standing)
        states = states_at_first_sample(self.structure, recursion, *at_first)
        responses = driven_draws(thin, recursion, drawn, states).exact(self.differences[:, np.newaxis])
        for draw, response in enumerate(responses):
            yield structure_of_draw(structures, draw), response

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
