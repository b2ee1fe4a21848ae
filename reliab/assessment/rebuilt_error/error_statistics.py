"""RMS^R and MTE^R from histories, and the statistics of many rebuilt errors at once.

Both are normalised by the peak of the exact response, as in `reliab.tracking.indices.response_error` ::

    RMS^R = √(mean (x_m − x_I)²)/max|x_I|,   MTE^R = max|x_m − x_I|/max|x_I|
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from reliab.assessment.rebuilt_error.recursion import Recursion, march, respond, straighten_history
from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.vocabulary import Metric


def mean_square(values: Array) -> float:
    """Mean square of a history over time by the trapezoidal rule."""
    inner = float(values @ values)
    return (inner - 0.5 * float(values[0] ** 2 + values[-1] ** 2)) / (values.size - 1)


def relative_errors(error: Array, reference: Array) -> tuple[float, float]:
    """RMS^R and MTE^R [-] of x_m − x_I and x_I [m], both shape (n,)."""
    peak = np.abs(reference).max()
    return float(np.sqrt(mean_square(error)) / peak), float(np.abs(error).max() / peak)


def relative_error(error: Array, reference: Array, metric: Metric) -> float:
    """RMS^R or MTE^R [-] of the same."""
    rms, mte = relative_errors(error, reference)
    return rms if metric is Metric.RMS else mte


def mean_and_deviation(band: Array, draws: int) -> tuple[Array, Array]:
    """Mean and standard deviation over draws from sums of their values and squares, shape (2, …)."""
    mean = band[0] / draws
    return mean, np.sqrt(np.maximum(band[1] / draws - mean**2, 0.0))


@compiled
def tally(
    sums: tuple[float, float, float], error: float, exact: float, weight: float, band: Array, sample: int
) -> tuple[float, float, float]:
    """Add a sample to the weighted squares of x_m − x_I, its peak and that of x_I, and to the band."""
    band[0, sample] += error
    band[1, sample] += error * error
    return sums[0] + weight * error * error, max(sums[1], abs(error)), max(sums[2], abs(exact))


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenDraws:
    """Draws of a test and what drives their errors, at each swept sample of the interface."""

    recursion: Recursion  # Of each draw
    states: Array  # At the first sample, shape (draws, 2n)
    command: Array  # x_c [m], shape (p, m)
    inputs: Array  # What a unit of each unknown of the sensors adds to x_c − x_m, shape (columns, p, m)
    shifts: Array  # How much each draw has of them, shape (draws, columns)
    late: Array  # What a force that is fed back late adds to x_c − x_m [m], shape (p, m)
    velocity: Array  # Of x_m [m/s], shape (p, m)
    lags: Array  # Of the force beyond the stated one [s], shape (draws,)

    def errors(self, differences: Array) -> tuple[Array, Array]:
        """Statistics of errors and their band; the states move to the last sample.

        `differences`: histories of x_c − x_m [m], shape (rows, p, m), which the draws take in turn.
        Returns mean square of x_m − x_I [m²], its peak and the peak of x_I [m], shape (draws, 3, p); and the
        sums of x_m − x_I over the draws and of its squares, shape (2, p, m).
        """
        band = np.zeros((2, *self.command.shape))
        answer = _sweep(
            *self.recursion.matrices,
            self.recursion.smooth,
            (0,) * len(self.command),
            self.states,
            np.ascontiguousarray(self.command),
            np.ascontiguousarray(differences),
            np.ascontiguousarray(self.inputs),
            np.ascontiguousarray(self.shifts),
            np.ascontiguousarray(self.late),
            np.ascontiguousarray(self.velocity),
            np.ascontiguousarray(self.lags),
            band,
        )
        return answer, band

    def exact(self, differences: Array) -> Iterator[Array]:
        """Responses of the interface without actuator errors [m], shape (p, m), draw by draw."""
        for draw, (state, shift, lag) in enumerate(zip(self.states, self.shifts, self.lags, strict=True)):
            difference = differences[draw % len(differences)] + np.tensordot(shift, self.inputs, 1)
            fed_back = difference + self.late + lag * self.velocity
            yield self.command - respond(self.recursion.select_draw(draw), fed_back, state)


@compiled
def _sweep(
    transition: Array,
    early: Array,
    late_of: Array,
    output: Array,
    feed_through: Array,
    smooth: bool,  # noqa: FBT001 - a compiled kernel
    actuators: tuple[int, ...],
    states: Array,
    command: Array,
    differences: Array,
    inputs: Array,
    shifts: Array,
    fed_back_late: Array,
    velocity: Array,
    feedback_lag: Array,
    band: Array,
) -> Array:
    draws, channels, size = states.shape[0], len(actuators), command.shape[1]
    answer = np.empty((draws, 3, channels))
    strayed, fed_back = np.empty((channels, size)), np.empty((channels, size))
    for draw in range(draws):
        _read(differences[draw % differences.shape[0]], inputs, shifts[draw], strayed)
        for j in range(channels):
            for i in range(size):
                late = fed_back_late[j, i] + feedback_lag[draw] * velocity[j, i]
                fed_back[j, i] = strayed[j, i] + late
        driving = straighten_history(fed_back) if smooth else fed_back
        errors = march(
            transition[draw],
            early[draw],
            late_of[draw],
            output[draw],
            feed_through[draw],
            actuators,
            fed_back,
            driving,
            states[draw],
        )
        for j in range(channels):
            _count(errors[j], strayed[j], command[j], answer[draw, :, j], band[:, j])
    return answer


@compiled
def _count(error: Array, difference: Array, command: Array, answer: Array, band: Array) -> None:
    """Mean square of x_m − x_I, its peak and that of x_I, and x_m − x_I and its square at each sample."""
    sums = (0.0, 0.0, 0.0)
    last = error.size - 1
    for i in range(error.size):
        weight = 0.5 if i in (0, last) else 1.0
        sums = tally(sums, error[i] - difference[i], command[i] - error[i], weight, band, i)
    answer[0], answer[1], answer[2] = sums[0] / last, sums[1], sums[2]


@compiled
def _read(difference: Array, inputs: Array, shifts: Array, answer: Array) -> None:
    """Add shares of columns to x_c − x_m."""
    for j in range(difference.shape[0]):
        for i in range(difference.shape[1]):
            total = difference[j, i]
            for k in range(inputs.shape[0]):
                total += shifts[k] * inputs[k, j, i]
            answer[j, i] = total
