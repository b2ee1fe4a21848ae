"""The error of one test, rebuilt from its own command and measured displacement.

A test obeys M x_c'' + C_n x_c' + K_n x_c = −M ι a_g − γ f, the undisturbed structure the same with the
specimen's true force under its own motion. Their difference e = x_c − x_I obeys the whole structure's own
equation, driven only by the restoring force that was wrong ::

    M e'' + C e' + K e = γ (Z x_c − f),   f = Z x_m,   Z = k_e + c_e s + m_e s²
    one degree of freedom:   e'' + 2ξω₀e' + ω₀²e = αω₀²(x_c − x_m)
    x_m − x_I = e − (x_c − x_m)

Neither the ground motion nor a reference is needed, and the actuator may do anything. The equation holds for
a linear structure with the stated properties (derivation: subtract the two equations of motion).
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    Histories,
    StandardDeviations,
    draw_unknown,
    exact_of_draws,
    sweep,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.parts import ErrorPart, Parts, divide, part_of_tracking
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.assessment.rebuilt_error.size import require_fitting, samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import DisplacementError, Spread
from reliab.assessment.rebuilt_error.stretches import StatedTest, collect_unknowns, draw_error
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.assessment.rebuilt_error.widenings import Widening, widenings
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

_KEPT_DRAWS = 128

DRAWS = 256
"""Number of draws of the uncertain quantities, a power of two."""


@dataclass(frozen=True, kw_only=True, eq=False)
class RebuiltError(DisplacementError):
    """The error of a test with its uncertainty."""

    time_step: float  # Step between samples [s]
    structure: Partition  # The structure with which it was rebuilt
    noise: SensorNoise  # Noise of the displacement sensor
    start: Start  # How the test begins, and the sensor's offset
    unknown: StandardDeviations  # Standard deviations that went into the intervals
    histories: Histories  # Smoothed histories from which the error is rebuilt
    # Draws of x_c − x_m that the noise leaves open [m], some of them, shape (at most 128, ceil(n/every))
    differences: Array
    every: int  # Number of samples of which one was drawn
    seed: int  # Seed of the draws

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (1, n)."""
        return self.histories.command[np.newaxis]

    def exact(self) -> Iterator[tuple[Partition, Array]]:
        """Structures, and responses without actuator errors [m], shape (1, m), of the first draws."""
        arguments = self.histories, self.structure, self.unknown, self.differences, self.every
        return exact_of_draws(*arguments, seed=self.seed)

    def parts(self) -> Parts:
        """Divide the error into amplitude, delay, what is neither, and the fed-back force."""
        return divide(self.histories, self.structure)

    def part_of_tracking(self, followed_command: Array) -> ErrorPart:
        """Part of the error that an actuator with this displacement [m] accounts for, shape (n,)."""
        return part_of_tracking(self.histories, self.structure, followed_command)

    def widenings(self, metric: Metric = Metric.RMS) -> tuple[Widening, ...]:
        """Which unknowns widen the interval most, the widest first."""
        quantities, _ = draw_unknown(self.unknown, self.draws.rms.size, self.seed)
        rows = self.histories, self.structure, EXACT, self.differences, self.every
        noise_spread = sweep(*rows, draws=len(self.differences), seed=self.seed).spread
        return widenings(self.draws, quantities, self.unknown.deviations(), noise_spread, metric)


def conclude(
    histories: Histories,
    read: Array,
    reference: Array,
    *,
    structure: Partition,
    noise: SensorNoise,
    nominal_spread: Spread,
    spread: Spread,
    differences: Array,
    stride: int,
    unknown: StandardDeviations,
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
        rms=spread.estimate(Metric.RMS, float(np.median(nominal_spread.rms))),
        mte=spread.estimate(Metric.MTE, float(np.median(nominal_spread.mte))),
        draws=spread,
        noise=noise,
        start=start,
        unknown=unknown,
        histories=histories,
        differences=differences[:_KEPT_DRAWS].copy(),  # the others are many times the histories
        every=stride,
        seed=seed,
    )


def rebuild(
    command: Array,
    measured_displacement: Array,
    time_step: float,
    structure: Structure | Partition,
    *,
    feedback_lag: float = 0.0,
    sensor_offset: float | None = None,
    resolution: float | None = None,
    tolerances: Tolerances | None = None,
    draws: int = DRAWS,
    seed: int = 0,
) -> RebuiltError:
    """Rebuild the error of a test from its command and measured displacement.

    `command`, `measured_displacement` [m]; `time_step`, `feedback_lag` [s]; `sensor_offset`, `resolution`
    [m].

    An actuator that moves 1 % too little under a steady sine at resonance:

    >>> time = np.arange(0.0, 60.0, 1.0 / 256.0)
    >>> command = np.minimum(time / 20.0, 1.0) * np.sin(2.0 * np.pi * time)
    >>> error = rebuild(command, 0.99 * command, 1.0 / 256.0, Structure(frequency=1.0, damping_ratio=0.05))
    >>> round(error.rms.value, 3)
    0.06
    """
    test = StatedTest(
        structure=whole_structure(structure),
        time_step=time_step,
        feedback_lag=feedback_lag,
        sensor_offset=sensor_offset,
        tolerances=tolerances or Tolerances(),
        seed=seed,
    )
    full_structure = test.structure
    command, measured_displacement = check_histories(
        command, measured_displacement, time_step, full_structure
    )
    require_fitting(command.size, samples_in_step_of_structure(full_structure, time_step), time_step)
    noise = replace(estimate_noise(command, measured_displacement, time_step), resolution=resolution)
    start = start_of_test(command, measured_displacement, time_step, full_structure, noise, sensor_offset)
    read = measured_displacement - start.offset
    fed_back = command - delay_history(read, feedback_lag, time_step)
    recursion = Recursion.from_displacement(full_structure, time_step)
    response = respond(recursion, fed_back, -start.standing * recursion.static[:, 0])[0]
    unknown = collect_unknowns(test, start, response, command)
    error, stretch_draws = draw_error(
        command, read, fed_back, test, noise=noise, start=start, unknown=unknown, draws=draws
    )
    return conclude(
        stretch_draws.histories,
        read,
        command - response,
        structure=full_structure,
        noise=noise,
        nominal_spread=error.stated.spread,
        spread=error.swept.spread,
        differences=stretch_draws.differences,
        stride=stretch_draws.every,
        unknown=unknown,
        start=start,
        seed=seed,
    )
