"""The rebuilt error of a test with several actuators: by interface displacement, with what widens it."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error.coupled_parts import CoupledHistories, CoupledParts, divide
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.interval import Unknown
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.spread import DisplacementError, Estimate, Spread
from reliab.assessment.rebuilt_error.widenings import Widening, widening_alone, widenings_of_draws
from reliab.significant import percent
from reliab.structures import Partition
from reliab.vocabulary import Metric

LOST_IN_NOISE = 0.05  # of the largest ideal motion, that noise leaves open


@dataclass(frozen=True, kw_only=True, eq=False)
class DegreeError(DisplacementError):
    """Error of one interface displacement."""

    name: str
    of_noise: Spread  # Of draws with all but the sensors' noise as stated
    noise: float  # Standard deviation of x_c − x_m that noise leaves open, over the largest ideal motion [-]

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return bool(self.noise < LOST_IN_NOISE)

    @property
    def why_not_judged(self) -> str:
        """Say why the displacement is not judged."""
        if np.isinf(self.noise):
            return f"{self.name} does not move, and its error is not judged."
        return (
            f"{self.name} moves too little for the noise of its sensors, which leaves "
            f"{percent(self.noise)} of its largest displacement open: its error is not judged."
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledError:
    """Error of a test with several actuators."""

    time_step: float  # s
    displacements: tuple[DegreeError, ...]  # In the order of the interface displacements
    structure: Partition  # As stated
    reduced: Partition  # With which it was rebuilt: no modes far above the motion
    noises: tuple[SensorNoise, ...]  # Of each sensor
    starts: tuple[Start, ...]  # How each channel begins
    unknown: Unknown
    drawn: Mapping[str, Array]  # What was drawn by name, each shape (draws,)
    histories: CoupledHistories
    every: int  # Number of samples of which one was drawn
    # Structures and responses at the interface without actuator errors [m], of some draws, shape (p, m)
    exact: Callable[[], Iterator[tuple[Partition, Array]]]

    @property
    def command(self) -> Array:
        """x_c at the interface [m], shape (p, n)."""
        return np.asarray(self.histories.carry @ self.histories.command)

    @property
    def judged(self) -> tuple[DegreeError, ...]:
        """Displacements that move enough for their noise."""
        return tuple(degree for degree in self.displacements if degree.judged)

    def governing(self, metric: Metric) -> DegreeError | None:
        """Return the displacement with the largest error; None where all are lost in noise."""
        return max(self.judged, key=lambda degree: degree.estimate(metric).value, default=None)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that every judged displacement's error is below a threshold."""
        least = (degree.probability(threshold, metric) for degree in self.judged)
        return min(least, default=0.5)

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R of the governing displacement with its interval; NaN where all are lost in noise."""
        governing = self.governing(metric)
        if governing is None:
            return Estimate(value=np.nan, low=np.nan, high=np.nan)
        return governing.estimate(metric)

    def errors(self, metric: Metric) -> Array:
        """RMS^R or MTE^R of the draws, the largest of the judged displacements [-], shape (draws,)."""
        return np.asarray(np.max([degree.draws.errors(metric) for degree in self.judged], axis=0))

    @cached_property
    def division(self) -> CoupledParts:
        """The errors of all displacements divided by actuator and by cause."""
        return divide(self.histories)

    def widenings(self, metric: Metric) -> tuple[Widening, ...]:
        """Return what widens the interval of the governing error, the widest first, if any is judged."""
        governing = self.governing(metric)
        if governing is None:
            return ()
        draws, deviations = governing.draws, self.unknown.deviations()
        parts = widenings_of_draws(draws, self.drawn, deviations, metric)
        parts.append(widening_alone("sensor_noise", draws, governing.of_noise, metric))
        return tuple(sorted(parts, key=lambda part: -part.contribution))


def errors_of_displacements(
    histories: CoupledHistories,
    raw: Array,
    names: tuple[str, ...],
    as_stated: tuple[Array, Array],
    swept: tuple[Array, Array],
    loose: Array,
    every: int,
) -> tuple[DegreeError, ...]:
    """Combine histories and draws, of noise `as_stated`, into the error of every interface displacement.

    `raw`: x_m as read [m], shape (p, n); `loose`: deviation that noise leaves x_c − x_m [m], shape (p,).
    """
    reference = histories.carry @ histories.command - histories.response
    strayed, smooth = (histories.carry @ read - reference for read in (raw, histories.measured))
    at, peaks = np.arange(reference.shape[1]) / every, np.abs(reference).max(axis=1)
    moves = peaks > np.finfo(float).eps * peaks.max()
    errors = []
    for place, name in enumerate(names):
        of_noise, spread = _spread(as_stated, place, at), _spread(swept, place, at)
        errors.append(
            DegreeError(
                name=name,
                error=strayed[place],
                smooth_error=smooth[place],
                reference=reference[place],
                draws=spread,
                of_noise=of_noise,
                rms=_estimate(Metric.RMS, of_noise, spread),
                mte=_estimate(Metric.MTE, of_noise, spread),
                noise=float(loose[place] / peaks[place]) if moves[place] else np.inf,
            )
        )
    return tuple(errors)


def _estimate(metric: Metric, of_noise: Spread, drawn: Spread) -> Estimate:
    """Error of what is stated, with an interval that reaches down to what noise alone leaves of it.

    An offset that is drawn can only add to the squares of an error, and sensors may have none.
    """
    estimate = drawn.estimate(metric, float(np.median(of_noise.errors(metric))))
    return replace(estimate, low=min(estimate.low, of_noise.interval(metric)[0]))


def _spread(swept: tuple[Array, Array], place: int, at: Array) -> Spread:
    """Errors of the draws of one displacement; their band `at` all samples, numbered by those swept."""
    square, peak, ideal = swept[0][:, :, place].T
    ideal = np.maximum(ideal, np.finfo(float).tiny)
    mean, deviation = (np.interp(at, np.arange(rows.shape[1]), rows[place]) for rows in swept[1])
    return Spread(
        rms=np.sqrt(square) / ideal,
        mte=peak / ideal,
        mean=mean,
        deviation=deviation,
    )
