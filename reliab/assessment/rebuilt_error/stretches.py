"""The error of a test that is judged stretch by stretch: a long test takes no more memory than a short one.

The histories of x_c − x_m that the sensor's noise leaves open are drawn for one stretch after the other, and
the recursion of each draw goes on where the stretch before ended. The sums over the error are those of the
whole test. The noise, its band and the levels of the actuator's error are those of each stretch. Every
stretch is drawn with the same random numbers: what a draw assumes of the rig it assumes throughout, which
makes the interval rather too wide than too narrow. A test no longer than two stretches has the interval of
`rebuild`.
"""

from dataclasses import dataclass, replace

import numpy as np

from reliab.assessment.rebuilt_error.difference_draws import draw_differences
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.initial import Start, check_histories, start_of_test
from reliab.assessment.rebuilt_error.interval import (
    EXACT,
    FEWEST_SWEPT,
    Histories,
    StandardDeviations,
    Swept,
    samples_in_step,
    sweep,
)
from reliab.assessment.rebuilt_error.noise import SensorNoise, estimate_noise
from reliab.assessment.rebuilt_error.readings import delay_history
from reliab.assessment.rebuilt_error.recursion import Recursion, respond
from reliab.assessment.rebuilt_error.size import samples_in_step_of_structure
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.core.arrays import Array
from reliab.core.vocabulary import Metric
from reliab.structures.partition import Partition

_STANDS = 1e-9  # share of the largest response up to which a command counts as standing still
_SAMPLES_SWEPT = 1 << 15  # of a stretch
_SAMPLES = 1 << 19  # of a stretch, before they are thinned


@dataclass(frozen=True, kw_only=True)
class StatedTest:
    """What is stated of a test."""

    structure: Partition  # The whole structure
    time_step: float  # Step between samples [s]
    feedback_lag: float  # Time by which the force is fed back late [s]
    sensor_offset: float | None  # Offset of the displacement sensor [m]; None to read it from rest
    tolerances: Tolerances  # How far stated values may be off
    seed: int  # Seed of the draws


@dataclass(frozen=True, kw_only=True, eq=False)
class ErrorSoFar:
    """RMS^R and MTE^R of a test from its beginning to the end of a stretch, with intervals."""

    noise: SensorNoise  # Noise of the displacement sensor in the stretch
    start: Start  # How the test begins, and the sensor's offset
    unknown: StandardDeviations  # Standard deviations that went into the intervals
    # stated, swept: Errors of the draws with everything as stated, so that only noise is open, and with all
    # that is not known
    stated: Swept
    swept: Swept

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""
        value = float(np.median(self.stated.spread.errors(metric)))
        return self.swept.spread.estimate(metric, value)

    @property
    def rms(self) -> Estimate:
        """RMS^R with its interval."""
        return self.estimate(Metric.RMS)

    @property
    def mte(self) -> Estimate:
        """MTE^R with its interval."""
        return self.estimate(Metric.MTE)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold, as `RebuiltError.probability` states it."""
        return self.swept.spread.probability_below(threshold, metric)

    def prepend_rest(self, steps: int) -> "ErrorSoFar":
        """Return the error of the same test with a longer rest before it, by a number of samples."""
        return replace(self, stated=self.stated.prepend_rest(steps), swept=self.swept.prepend_rest(steps))


@dataclass(frozen=True, kw_only=True, eq=False)
class StretchDraws:
    """What was drawn of a stretch."""

    histories: Histories  # Smoothed histories
    differences: Array  # Draws of x_c − x_m [m], shape (draws, ceil(n/every))
    every: int  # Number of samples of which one was drawn


def draw_error(
    command: Array,
    read: Array,
    fed_back: Array,
    test: StatedTest,
    *,
    noise: SensorNoise,
    start: Start,
    unknown: StandardDeviations,
    draws: int,
    earlier: ErrorSoFar | None = None,
) -> tuple[ErrorSoFar, StretchDraws]:
    """Draw the error of a test, or of its next stretch.

    `command`, `read`, `fed_back` [m].
    Returns the error from the beginning of the test, and what was drawn of these samples.
    """
    structure, seed = test.structure, test.seed
    stride = samples_in_step(samples_in_step_of_structure(structure, test.time_step), noise, command.size)
    if np.ptp(command) > 0.0:
        difference, fed_back = noise.smooth(command - read), noise.smooth(fed_back)
        lowest = float(structure.natural_frequencies[0])
        differences = draw_differences(command, read, noise, lowest, stride, draws, seed)
    else:  # a piston whose command stands still is where the sensor shows it on average
        difference = fed_back = np.full(command.size, np.mean(command - read))
        differences = difference[np.newaxis, ::stride]
    histories = Histories(
        command=command,
        measured=command - difference,
        fed_back=fed_back,
        time_step=test.time_step,
        standing=-start.standing,
    )

    def sweep_draws(
        unknown: StandardDeviations, differences: Array, draws: int, earlier: Swept | None
    ) -> Swept:
        return sweep(
            histories, structure, unknown, differences, stride, draws=draws, seed=seed, earlier=earlier
        )

    error = ErrorSoFar(
        noise=noise,
        start=start,
        unknown=unknown,
        stated=sweep_draws(EXACT, differences[::2], draws // 2, None if earlier is None else earlier.stated),
        swept=sweep_draws(unknown, differences, draws, None if earlier is None else earlier.swept),
    )
    return error, StretchDraws(histories=histories, differences=differences, every=stride)


def collect_unknowns(test: StatedTest, start: Start, response: Array, command: Array) -> StandardDeviations:
    """Collect what is uncertain; `response`, `command` [m]."""
    relative = float(np.sqrt(mean_square(response) / mean_square(command)))
    return StandardDeviations(
        tolerances=test.tolerances,
        offset=start.offset_deviation,
        error_at_start=0.0 if start.at_rest else relative * start.amplitude,
    )


def error_of_stretch(
    command: Array,
    measured_displacement: Array,
    test: StatedTest,
    *,
    draws: int,
    samples: int | None = None,
    earlier: ErrorSoFar | None = None,
) -> ErrorSoFar:
    """Draw the error of a test up to the end of its first or next stretch.

    `command`, `measured_displacement` [m]. The stretch has the first `samples` of them; with those that
    follow, the first stretch tells more of the noise and of how the test begins.
    """
    structure, step = test.structure, test.time_step
    if earlier is None:
        command, measured_displacement = check_histories(command, measured_displacement, step, structure)
        noise = estimate_noise(command, measured_displacement, step)
        start = start_of_test(command, measured_displacement, step, structure, noise, test.sensor_offset)
    elif np.ptp(command) > _STANDS * float(earlier.stated.statistics[:, 2].max()):
        noise, start = estimate_noise(command, measured_displacement, step), earlier.start
    else:
        command = np.full(command.size, np.mean(command))
        noise, start = earlier.noise, earlier.start
    read = measured_displacement - start.offset
    fed_back = command - delay_history(read, test.feedback_lag, step)
    if earlier is None:
        recursion = Recursion.from_displacement(structure, step)
        response = respond(recursion, fed_back, -start.standing * recursion.static[:, 0])[0]
        unknown = collect_unknowns(test, start, response, command)
    else:
        unknown = earlier.unknown
    return draw_error(
        command[:samples],
        read[:samples],
        fed_back[:samples],
        test,
        noise=noise,
        start=start,
        unknown=unknown,
        draws=draws,
        earlier=earlier,
    )[0]


def samples_in_stretch(structure: Partition, time_step: float) -> int:
    """Return the number of samples after which a stretch of a running test is judged and forgotten.

    `time_step` [s].
    Returns so many that a stretch ends with a sample that is swept, and 256 draws of twice as many take half
    a gigabyte.
    """
    stride = samples_in_step_of_structure(structure, time_step)
    return stride * min(max(_SAMPLES // stride, FEWEST_SWEPT), _SAMPLES_SWEPT)
