"""The rebuilt error of a test with several actuators: by interface displacement, with what widens it."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from reliab.arrays import Array
from reliab.assessment.coupled_error.coupled_histories import CoupledHistories
from reliab.assessment.coupled_error.coupled_parts import CoupledParts, divide
from reliab.assessment.rebuilt_error.initial import Start
from reliab.assessment.rebuilt_error.interval import ACCURACY, drawn_at
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.assessment.rebuilt_error.own_frequency import OwnFrequency
from reliab.assessment.rebuilt_error.sobol import normal_points
from reliab.assessment.rebuilt_error.spread import Estimate, Spread
from reliab.assessment.rebuilt_error.tolerances import Tolerances
from reliab.structures import Partition
from reliab.vocabulary import Metric

_OF_STRUCTURE = ("frequency", "damping_ratio", "experimental_fraction", "feedback_lag")
_AT_SENSORS = ("sensor_scale", "time_shift", "sensor_offset", "hysteresis", "lagging_hysteresis")
_OF_EXACT = 0.001  # accuracy of an error whose structure is exact
LOST_IN_NOISE = 0.05  # of the largest ideal motion, that noise leaves open


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknowns:
    """Names and standard deviations of what is drawn; those of sensors end with the sensor's number."""

    names: tuple[str, ...]
    deviations: Array  # Relative, or in SI units, shape (unknowns,)
    own_frequency: OwnFrequency | None = None  # What the test shows of its frequency

    @classmethod
    def of_test(
        cls,
        tolerances: Tolerances,
        starts: Array,
        degrees: int,
        own_frequency: OwnFrequency | None = None,
    ) -> "Unknowns":
        """Collect what is not known; `starts`: deviations of offsets and first errors [m], shape (2, p)."""
        stated = dict(tolerances.items())
        if own_frequency is not None:
            stated["frequency"] = own_frequency.deviation
        deviations = {name: stated[name] for name in _OF_STRUCTURE}
        for place in range(degrees):
            number = place + 1
            deviations |= {f"{name}_{number}": stated[name] for name in _AT_SENSORS}
            # filters delay a reading as a skew does
            deviations[f"time_shift_{number}"] = float(np.hypot(stated["time_shift"], stated["filter_delay"]))
            deviations[f"sensor_offset_{number}"] = float(np.hypot(stated["sensor_offset"], starts[0, place]))
            deviations[f"initial_displacement_{number}"] = float(starts[1, place])
            deviations[f"initial_velocity_{number}"] = float(starts[1, place])
        deviations |= tolerances.of_parts
        drawn = {name: value for name, value in deviations.items() if value > 0.0}
        return cls(names=tuple(drawn), deviations=np.array(list(drawn.values())), own_frequency=own_frequency)

    @property
    def accuracy(self) -> float:
        """Relative standard deviation of what the computation itself adds to an error."""
        return _OF_EXACT if self.own_frequency is None else ACCURACY

    def draw(self, draws: int, seed: int) -> dict[str, Array]:
        """Draw all of them, each shape (draws,), and the lag of the fed-back force even where it is known."""
        deviations = dict(zip(self.names, self.deviations.tolist(), strict=True))
        points = normal_points(len(deviations), draws, seed)
        return {"feedback_lag": np.zeros(draws), **drawn_at(points, deviations, self.own_frequency)}


@dataclass(frozen=True, kw_only=True, eq=False)
class DegreeError:
    """Error of one interface displacement."""

    name: str
    error: Array  # x_m − x_I as the sensors read x_m [m], shape (n,)
    reference: Array  # x_I [m], shape (n,)
    draws: Spread  # RMS^R and MTE^R of the draws
    rms: Estimate
    mte: Estimate
    noise: float  # Standard deviation of x_c − x_m that noise leaves open, over the largest ideal motion [-]

    @property
    def judged(self) -> bool:
        """Whether the displacement moves enough for its noise."""
        return bool(self.noise < LOST_IN_NOISE)

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""
        return self.rms if Metric(metric) is Metric.RMS else self.mte

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold [-]."""
        return self.draws.probability_below(threshold, metric)


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledError:
    """Error of a test with several actuators."""

    time_step: float  # s
    degrees: tuple[DegreeError, ...]  # In the order of the interface displacements
    partition: Partition  # As stated
    structure: Partition  # With which it was rebuilt: no modes far above the motion
    noises: tuple[SensorNoise, ...]  # Of each sensor
    starts: tuple[Start, ...]  # How each channel begins
    unknown: Unknowns
    drawn: Array  # What was drawn, shape (unknowns, draws)
    histories: CoupledHistories
    every: int  # Number of samples of which one was drawn
    # Structures and responses at the interface without actuator errors [m], of some draws, shape (p, m)
    exact: Callable[[], Iterator[tuple[Partition, Array]]]

    @property
    def judged(self) -> tuple[DegreeError, ...]:
        """Displacements that move enough for their noise."""
        return tuple(degree for degree in self.degrees if degree.judged)

    def governing(self, metric: Metric) -> DegreeError | None:
        """Return the displacement with the largest error; None where all are lost in noise."""
        return max(self.judged, key=lambda degree: degree.estimate(metric).value, default=None)

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that every judged displacement's error is below a threshold."""
        least = (degree.probability(threshold, metric) for degree in self.judged)
        return min(least, default=0.5)

    @cached_property
    def parts(self) -> CoupledParts:
        """The error divided by actuator and by cause."""
        return divide(self.histories)

    def widenings(self, metric: Metric) -> dict[str, float]:
        """Return the standard deviation of the governing error that each unknown causes [-], largest first.

        By least squares of the draws' squared errors on what was drawn, linear and squared; "sensor_noise"
        is what is not explained.
        """
        governing = self.governing(metric)
        if governing is None:
            return {}
        errors = governing.draws.errors(metric)
        scaled = self.drawn / np.maximum(self.drawn.std(axis=1, keepdims=True), 1e-300)
        columns = np.vstack([np.ones(errors.size), scaled, scaled**2])
        coefficients = np.linalg.lstsq(columns.T, errors, rcond=None)[0]
        count = len(self.unknown.names)
        effects = {
            name: float(
                np.std(
                    coefficients[1 + place] * scaled[place]
                    + coefficients[1 + count + place] * scaled[place] ** 2
                )
            )
            for place, name in enumerate(self.unknown.names)
        }
        effects["sensor_noise"] = float(np.std(errors - coefficients @ columns))
        return dict(sorted(effects.items(), key=lambda item: -item[1]))


def conclude(
    *,
    partition: Partition,
    structure: Partition,
    histories: CoupledHistories,
    noises: tuple[SensorNoise, ...],
    starts: tuple[Start, ...],
    unknown: Unknowns,
    as_stated: tuple[Array, Array, Array],
    swept: tuple[Array, Array, Array],
    raw: Array,
    loose: Array,
    every: int,
    exact: Callable[[], Iterator[tuple[Partition, Array]]],
) -> CoupledError:
    """Combine histories and draws into errors of every interface displacement."""
    reference = histories.carry @ histories.command - histories.response
    strayed = histories.carry @ raw - reference
    degrees = []
    for place, name in enumerate(partition.names):
        peak = float(np.abs(reference[place]).max())
        largest = float(np.abs(reference).max())
        moves = peak > np.finfo(float).eps * largest
        stated, drawn = _spread(as_stated, place), _spread(swept, place)
        degrees.append(
            DegreeError(
                name=name,
                error=strayed[place],
                reference=reference[place],
                draws=drawn,
                rms=_estimate(Metric.RMS, stated, drawn),
                mte=_estimate(Metric.MTE, stated, drawn),
                noise=float(loose[place] / peak) if moves else np.inf,
            )
        )
    return CoupledError(
        time_step=histories.time_step,
        degrees=tuple(degrees),
        partition=partition,
        structure=structure,
        noises=noises,
        starts=starts,
        unknown=unknown,
        drawn=swept[2],
        histories=histories,
        every=every,
        exact=exact,
    )


def _estimate(metric: Metric, of_noise: Spread, drawn: Spread) -> Estimate:
    """Error of what is stated, with an interval that reaches down to what noise alone leaves of it.

    An offset that is drawn can only add to the squares of an error, and sensors may have none.
    """
    found = drawn.estimate(metric, float(np.median(of_noise.errors(metric))))
    return replace(found, low=min(found.low, of_noise.interval(metric)[0]))


def _spread(swept: tuple[Array, Array, Array], place: int) -> Spread:
    square, peak, ideal = swept[0][:, :, place].T
    ideal = np.maximum(ideal, np.finfo(float).tiny)
    return Spread(
        rms=np.sqrt(square) / ideal,
        mte=peak / ideal,
        mean=swept[1][0, place],
        deviation=swept[1][1, place],
    )
