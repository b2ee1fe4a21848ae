"""What every test that runs is asked: its error with an interval from time to time, and two alarms.

That of the energy is stated in `loop_energy`. That of the error compares an error so far with the
threshold, though its peak, by which it is divided, may still grow and a quiet end may dilute it. It waits
until the peak of the response has not doubled for 12 s, and is raised when the low end of the interval is
above twice the threshold: of the responses of 450 structures (0.4 to 4 Hz, damping ratios of 1 to 6 %) to
synthetic earthquakes, with errors that grow with the motion and such that do not, one in a hundred fell to
less than half of its error after that. While the motion does not stand out of the noise of its sensor, as in
a rest before it, no error is stated: it would be that of the noise.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from reliab.assessment.rebuilt_error.initial import FEWEST_SAMPLES
from reliab.assessment.rebuilt_error.loop_energy import LoopEnergy, NetDamping, select_modes
from reliab.assessment.rebuilt_error.recursion import Recursion, run_on
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical
from reliab.core.vocabulary import Metric
from reliab.recordings.recording import LARGEST_READING
from reliab.structures.partition import Partition

TIME_WITHOUT_DOUBLING = (
    12.0  # s for which the peak of the response must not have doubled before an error is judged
)
SHRINKING_SHARE = 0.5  # share to which an error may still fall after that time
FALSE_ERROR_ALARMS = 0.01  # share of tests that end below the threshold and have an alarm of the error


class RunningSums:
    """Sums over the error r = x_m − x_I of a test, and over x_I.

    `size`: Samples so far, with those of a rest before that were forgotten.
    `values`: Σr², half the square of its first value, max|r|, max|x_I|, r of the last sample, max|x_I| when
    it last doubled, and the number of the sample at which it did, shape (7,).
    """

    def __init__(self, rest_samples: int = 0) -> None:
        self.size, self.values = rest_samples, np.zeros(7)

    def add(self, error: Array, ideal: Array) -> None:
        """Add the next samples of r and x_I [m], shape (k,) each."""
        _add(self.values, error, ideal, self.size)
        self.size += error.size

    @property
    def latest(self) -> float:
        """Error of the last sample [m]."""
        return float(self.values[4])

    @property
    def mean_square(self) -> float:
        """Mean square of r over the whole test so far [m²], by the trapezoidal rule."""
        inner = self.values[0] - self.values[1] - 0.5 * self.values[4] ** 2
        return max(float(inner), 0.0) / max(self.size - 1, 1)

    @property
    def rms(self) -> float:
        """RMS^R so far [-]; zero while nothing moves."""
        return float(np.sqrt(self.mean_square)) / self.largest if self.largest > 0.0 else 0.0

    @property
    def mte(self) -> float:
        """MTE^R so far [-]; zero while nothing moves."""
        peak, ideal = self.values[2:4].tolist()
        return peak / ideal if ideal > 0.0 else 0.0

    @property
    def largest(self) -> float:
        """Largest response without actuator errors [m]."""
        return float(self.values[3])

    @property
    def calm(self) -> float:
        """Samples since the peak of x_I last doubled."""
        return self.size - 1 - float(self.values[6])


@compiled
def _add(sums: Array, errors: Array, ideal: Array, first: int) -> None:
    """Add samples to the sums, in place; `first`: number of the first of them."""
    for i in range(errors.size):
        if first + i == 0:
            sums[1] = 0.5 * errors[i] * errors[i]
        sums[0] += errors[i] * errors[i]
        sums[2] = max(sums[2], abs(errors[i]))
        sums[3] = max(sums[3], abs(ideal[i]))
        sums[4] = errors[i]
        if sums[3] > 2.0 * sums[5]:
            sums[5], sums[6] = sums[3], first + i


class RunningResponse:
    """Outputs of a recursion to inputs that come in pieces; `state`: at the first, at rest by default."""

    def __init__(self, recursion: Recursion, state: Array | None = None) -> None:
        self._recursion = recursion
        self._state = np.zeros(recursion.order) if state is None else np.array(state, dtype=np.float64)
        self._last = np.zeros((recursion.early.shape[1], 0))

    @classmethod
    def sum_of(cls, responses: "Sequence[RunningResponse]", weights: Sequence[float]) -> "RunningResponse":
        """Continue the weighted sum of responses of one recursion at their last sample."""
        pairs = [(weight, vars(one)) for one, weight in zip(responses, weights, strict=True) if weight]
        total = cls(pairs[0][1]["_recursion"])
        total._state = np.asarray(sum(weight * one["_state"] for weight, one in pairs))
        total._last = np.asarray(sum(weight * one["_last"] for weight, one in pairs))
        return total

    def follow(self, inputs: Array) -> Array:
        """Return outputs to the next inputs, shape (p, k), shape (outputs, k)."""
        earlier_size = self._last.shape[1]
        inputs = np.concatenate([self._last, inputs], axis=1)
        self._last = inputs[:, -1:]
        return run_on(self._recursion, inputs, self._state)[:, earlier_size:]


class ErrorWithInterval(Protocol):
    """An error of the samples so far, with its interval."""

    def estimate(self, metric: Metric) -> Estimate:
        """RMS^R or MTE^R with its interval."""

    def probability(self, threshold: float, metric: Metric = Metric.RMS) -> float:
        """Probability that the error is below a threshold [-]."""


@dataclass(frozen=True, kw_only=True)
class Now:
    """What is known of a running test at its last sample; errors of a measured specimen as last computed."""

    samples: int  # Samples so far
    time: float  # Time since the first sample [s]
    error: float | None  # x_m − x_I [m]; None while the specimen is not learned
    # rms, mte: RMS^R and MTE^R so far [-], sensor noise included; zero while nothing moves, None while the
    # specimen is not learned
    rms: float | None
    mte: float | None
    # Smallest net damping of the watched modes; None where too little motion was recorded
    damping: NetDamping | None
    near_instability: bool  # Whether a mode has lost most of its damping

    def size(self, metric: Metric) -> float | None:
        """RMS^R or MTE^R so far [-]."""
        return self.rms if metric is Metric.RMS else self.mte


def require_readings(*histories: Array) -> None:
    """Refuse values that no sensor reads."""
    if not (np.abs(histories) < LARGEST_READING).all():
        raise InputError(
            f"Every value must be a finite number below {LARGEST_READING:g}", remedy="Repair the row"
        )


class RunningTest(ABC):
    """A test that is followed; `time_step`, `skew` [s]: the standard deviation of that of the channels."""

    growth: ClassVar[float] = 0.5
    """Share of itself by which a test must grow before its intervals are computed again."""
    growth_in_noise: ClassVar[float] = 0.1
    """The same while its motion does not stand out of the noise."""
    periods_between: ClassVar[float] = 4.0
    """Periods of the structure by which it must grow at least."""

    def __init__(self, structure: Partition, time_step: float, skew: float = 0.0) -> None:
        require_physical("time step", time_step)
        self.structure, self.time_step = structure, time_step
        self._period = 1.0 / (float(structure.natural_frequencies[0]) or 1.0)
        self._energy = LoopEnergy(select_modes(structure, time_step, skew))
        self._asked = 0
        self._result: ErrorWithInterval | None = None
        # Low end of the last interval over the error at that time, by displacement and metric [-]
        self._lows: dict[str, dict[Metric, float]] = {}
        self._lost = False

    @property
    @abstractmethod
    def samples(self) -> int:
        """Samples so far."""

    @property
    @abstractmethod
    def now(self) -> Now:
        """What is known at the last sample."""

    def _now(self, error: float | None, rms: float | None, mte: float | None) -> Now:
        """Say what is known of one displacement."""
        return Now(
            samples=self.samples,
            time=(self.samples - 1) * self.time_step,
            error=error,
            rms=rms,
            mte=mte,
            damping=self._energy.net,
            near_instability=self._energy.near_instability,
        )

    @property
    def displacements(self) -> Mapping[str, Now]:
        """What is known of each interface displacement at the last sample, by name."""
        return {"": self.now}

    @abstractmethod
    def _calm(self, name: str) -> float:
        """Time for which the peak of the exact response of a displacement has not doubled [s]."""

    @property
    def gains_energy_since(self) -> float | None:
        """Time from which on the loop may diverge [s]; None while nothing points to it."""
        return None if self._energy.since is None else self._energy.since * self.time_step

    @property
    def gaining_frequency(self) -> float | None:
        """Natural frequency of the mode that may diverge [Hz]; None while nothing points to it."""
        mode = self._energy.gaining
        return None if mode is None else mode.circular_frequency / (2.0 * np.pi)

    @property
    def result(self) -> ErrorWithInterval | None:
        """The last error with its intervals; None before there was one, and while it is that of noise."""
        return self._result

    def exceeds(self, threshold: float, metric: Metric = Metric.RMS) -> bool:
        """Whether the error will stay above a threshold, whatever peak and quiet end are still to come.

        `threshold` [-].
        Returns false before there were intervals, and until the peak of the response has not doubled for 12
        s.
        """
        return any(
            calm >= TIME_WITHOUT_DOUBLING and SHRINKING_SHARE * low > threshold
            for calm, low in self._lowest_so_far(Metric(metric))
        )

    def _lowest_so_far(self, metric: Metric) -> Iterator[tuple[float, float]]:
        """Time for which a peak has not doubled [s] and low end of the error so far, of each displacement."""
        for name, lows in self._lows.items():
            yield self._calm(name), lows[metric] * (self.displacements[name].size(metric) or 0.0)

    @property
    def is_whole(self) -> bool:
        """Whether all samples are held, so that the test can be judged as one that is assessed."""
        return True

    @property
    def moves(self) -> bool:
        """Whether a displacement stands out of the noise of its sensor."""
        return self._energy.moves

    @property
    def due(self) -> bool:
        """Whether the test has grown so much that intervals are worth computing again."""
        new_samples = self.samples - self._asked
        least = max(FEWEST_SAMPLES, int(self.periods_between * self._period / self.time_step))
        growth = self.growth_in_noise if self._lost else self.growth
        return self._energy.moves and new_samples >= max(least, int(growth * self._asked))

    def _conclude(
        self,
        error: ErrorWithInterval | None,
        by_displacement: Mapping[str, ErrorWithInterval],
        *,
        lost_in_noise: bool = False,
    ) -> None:
        """Keep an error that was computed from all samples so far; None where it is not known.

        `by_displacement`: the same of each displacement that is judged.
        """
        self._result = None if lost_in_noise else error
        self._asked, self._lost, so_far = self.samples, lost_in_noise, self.displacements
        self._lows = {
            name: {
                metric: degree.estimate(metric).low / (so_far[name].size(metric) or np.inf)
                for metric in Metric
            }
            for name, degree in by_displacement.items()
            if self._result is not None
        }
