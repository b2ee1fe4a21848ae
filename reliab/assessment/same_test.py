"""Several runs of one test whose actuator erred by different amounts: the response without an error.

All runs approach one response as their actuator errors vanish, whatever the specimen does. Gain and delay
of each run are the coordinates of its error; responses are extrapolated to the place where both vanish,
sample by sample, in the spirit of Insam and Rixen's fidelity by convergence. What is extrapolated is the
response that `rebuild` computes for each run: it is the measured one where the actuator does not err, and
changes little with its error where the structure is as stated. The measured responses, and a line beside a
parabola, show how far the extrapolation is to be trusted.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from reliab.assessment.assessment import Assessment
from reliab.assessment.judged_test import plot_errors
from reliab.assessment.parts import fit_followers
from reliab.assessment.rebuilt_error.error_statistics import relative_error
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.assessment.verdict import Word, probability_text, word_of_probability
from reliab.core.arrays import Array
from reliab.core.columns import Columns
from reliab.core.errors import InputError
from reliab.core.plain_values import Keys, PlainResult, ResultWithRows, same_names
from reliab.core.significant_digits import percent_and_interval, percent_with_interval, significant
from reliab.core.vocabulary import PERCENT, Metric
from reliab.signals.spectra import cross_correlate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FEWEST_APART = 0.25  # of the largest tracking error: spread that the runs must have
_LEAST_CORRELATION = 0.8  # correlation of the responses of two runs of one test
_APART_IN_TIME = 0.02  # of a period of the structure by which runs may seem to begin apart
_ASIDE = 0.15  # of the largest tracking error: runs further from one line are described by a plane
_FEWEST_FOR_PARABOLA = 3  # runs from which on a parabola can be told
_DRAWS = 256
_LEVELS = (0.05, 0.95)
_OPEN = 0.5  # share of the draws in which the command did not pass the filter of the measured displacement


@dataclass(frozen=True, kw_only=True)
class RunOfTest(PlainResult):
    """One run, judged with the others."""

    keys: ClassVar[Keys] = {
        **same_names("file", "gain"),
        "d_ms": "delay",
        **same_names("alone", "error", "probability"),
        "verdict": "word",
        "contradicts": "contradicts",
    }

    file: str  # Name of the run
    gain: float  # Share of the command that the actuator moved [-]
    delay: float  # Delay of the actuator [s], negative where it leads
    alone: Estimate  # Error as rebuilt from this run alone [-]
    error: Estimate  # Error against the extrapolated response, with its 90 % interval [-]
    probability: float  # That it stays below the threshold
    word: Word  # Verdict on the run
    contradicts: bool  # Whether the two intervals have nothing in common


@dataclass(frozen=True, kw_only=True, eq=False)
class SameTest(ResultWithRows):
    """Runs of one test, and the response to which they extrapolate."""

    rows_in = "runs"
    keys: ClassVar[Keys] = {
        **same_names("metric", "threshold", "reliable"),
        "line_against_parabola": "checked",
        "peak_m": "peak",
        "runs": "runs",
        "warnings": "sentences",
    }
    table_columns: ClassVar[Columns] = {
        "run": ("file", ""),
        "verdict": ("verdict", lambda word: Word(word).phrase, "left"),
        "gain": ("gain", ".3f"),
        "d, ms": ("d_ms", ".2f"),
        "alone": ("alone", lambda size: percent_and_interval(**size)[0]),
        "all runs": ("error", lambda size: percent_and_interval(**size)[0]),
        "90 % interval": ("error", lambda size: percent_and_interval(**size)[1]),
        "probability": ("probability", probability_text),
    }

    metric: Metric  # Which error was asked about
    threshold: float  # Error with which it is compared [-]
    time_step: float  # Step of the responses [s]
    response: Array  # Response without an error of the actuator [m], shape (n,)
    # RMS between what a line and a parabola give over the peak [-]; None with two runs, or in a plane
    checked: float | None
    runs: tuple[RunOfTest, ...]

    @property
    def reliable(self) -> bool:
        """Whether every run is reliable."""
        return all(run.word is Word.RELIABLE for run in self.runs)

    @property
    def sentences(self) -> tuple[str, ...]:
        """Say how far the extrapolation can be trusted, and where it contradicts a run's own error."""
        return tuple(self._sentences())

    def _sentences(self) -> Iterator[str]:
        if len(self.runs) < _FEWEST_FOR_PARABOLA:
            yield (
                "Two runs cannot show a curvature: a third run with another delay would check the "
                "extrapolation."
            )
        for run in self.runs:
            if run.contradicts:
                yield (
                    f"{run.file}: from this run alone the error is {_interval(run.alone)}, by all runs "
                    f"together {_interval(run.error)}. The structure, the specimen or a channel is not as "
                    "stated; the result of all runs together depends on neither structure nor specimen."
                )

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error of each run against the extrapolated response with its 90 % interval [%]."""
        return plot_errors({run.file: run.error for run in self.runs}, self.metric, self.threshold, axes)

    @property
    def peak(self) -> float:
        """Largest displacement without an error of the actuator [m]."""
        return float(np.abs(self.response).max())


def combine_runs(runs: Mapping[str, Assessment]) -> SameTest:
    """Judge runs of one test together: two at least, by name, whose actuators differ in gain or delay."""
    assessments = list(runs.values())
    _require_one_test(runs)
    extrapolation = _Extrapolation.from_runs(assessments)
    first, best = assessments[0], extrapolation.best
    return SameTest(
        metric=first.error.metric,
        threshold=first.error.threshold,
        time_step=first.recording.time_step,
        response=best,
        checked=extrapolation.curvature,
        runs=tuple(extrapolation.judge_run(name, place) for place, name in enumerate(runs)),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Extrapolation:
    """Responses without an error to which the runs may extrapolate."""

    found: Sequence[Assessment]
    places: Array  # Errors of gain and delay of the runs, shape (runs, 2)
    measured: Array  # Measured responses [m], shape (runs, n)
    candidates: Sequence[Array]  # By lower curves first, the best one, and that of the measured responses [m]
    draws: Array  # Responses that what is not known leaves open [m], shape (draws, n)

    @classmethod
    def from_runs(cls, assessments: Sequence[Assessment]) -> "_Extrapolation":
        size = min(assessment.error.reference.size for assessment in assessments)
        rebuilt = np.array([_exact(assessment)[:size] for assessment in assessments])
        measured = np.array([_measured_motion(assessment, size) for assessment in assessments])
        places = np.array([_tracking(assessment, size) for assessment in assessments])
        curves = _curves(places)
        candidates = [*(curve.intercept(rebuilt) for curve in curves), curves[-1].intercept(measured)]
        generator = np.random.default_rng(0)
        zero_shifts = _unknown_zero(assessments[0], generator) @ curves[-1].slopes(measured)
        candidate_places = generator.permutation(np.arange(_DRAWS) % len(candidates))
        return cls(
            found=assessments,
            places=places,
            measured=measured,
            candidates=candidates,
            draws=np.array(candidates)[candidate_places] + zero_shifts,
        )

    @property
    def best(self) -> Array:
        """Response of the curve to be trusted most [m], shape (n,)."""
        return self.candidates[-2]

    @property
    def curvature(self) -> float | None:
        """RMS between what a line and a parabola give over the peak [-]; None where there is one curve."""
        if len(self.candidates) < _FEWEST_FOR_PARABOLA:
            return None
        difference = self.candidates[0] - self.best
        return float(np.sqrt(np.mean(difference**2)) / np.abs(self.best).max())

    def judge_run(self, name: str, place: int) -> RunOfTest:
        """Judge one of the runs by all of them."""
        assessment, path = self.found[place], self.measured[place]
        metric = assessment.error.metric
        sizes = np.array([relative_error(path - response, response, metric) for response in self.draws])
        value, single_error = (
            relative_error(path - self.best, self.best, metric),
            assessment.error.estimate(metric),
        )
        low, high = np.quantile(sizes, _LEVELS).tolist()
        probability = (float(np.sum(sizes < assessment.error.threshold)) + 0.5) / (sizes.size + 1.0)
        return RunOfTest(
            file=name,
            gain=1.0 + float(self.places[place, 0]),
            delay=float(self.places[place, 1]) / assessment.structure.circular_frequency,
            alone=single_error,
            error=Estimate(value=value, low=min(low, value), high=max(high, value)),
            probability=probability,
            word=word_of_probability(probability),
            contradicts=bool(low > single_error.high or high < single_error.low),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Curve:
    """Responses as a function of the tracking error: coefficients of least squares."""

    design: Array  # Columns one, s, s² or one, gain and delay, shape (runs, columns)
    directions: (
        Array  # What the columns but the first have as slope by gain and delay, shape (2, columns − 1)
    )

    def intercept(self, responses: Array) -> Array:
        """Response where the actuator does not err [m], shape (n,)."""
        return np.asarray((np.linalg.pinv(self.design) @ responses)[0])

    def slopes(self, responses: Array) -> Array:
        """Change of the response with gain and delay where the actuator does not err, shape (2, n)."""
        return np.asarray(self.directions @ (np.linalg.pinv(self.design) @ responses)[1:])


def _curves(places: Array) -> list[_Curve]:
    """Curves through the tracking errors of the runs (gain, delay), the one to be trusted most last."""
    largest = float(np.linalg.norm(places, axis=1).max())
    direction = np.linalg.svd(places, full_matrices=False)[2][0]
    coordinates = places @ direction
    if not np.ptp(coordinates) > _FEWEST_APART * largest or largest == 0.0:
        raise InputError(
            "The runs hardly differ in gain or delay of the actuator",
            value=", ".join(
                f"{significant(PERCENT * float(np.linalg.norm(place)), 2)} %" for place in places
            ),
            remedy="Repeat the test with an added delay of the command, or another compensation",
        )
    constant = np.ones(coordinates.size)
    aside = float(np.linalg.norm(places - np.outer(coordinates, direction), axis=1).max())
    if aside > _ASIDE * largest and coordinates.size >= _FEWEST_FOR_PARABOLA:
        return [_Curve(design=np.column_stack([constant, places]), directions=np.eye(2))]
    line = _Curve(design=np.column_stack([constant, coordinates]), directions=direction[:, np.newaxis])
    if coordinates.size < _FEWEST_FOR_PARABOLA:
        return [line]
    directions = np.column_stack([direction, np.zeros(2)])
    return [
        line,
        _Curve(design=np.column_stack([constant, coordinates, coordinates**2]), directions=directions),
    ]


def _exact(assessment: Assessment) -> Array:
    """Response without actuator errors with everything as stated, in common to all runs [m]."""
    inferred_error = assessment.error.inferred
    return assessment.error.reference if inferred_error is None else inferred_error.exact_as_stated()


def _measured_motion(assessment: Assessment, size: int) -> Array:
    """Measured displacement without the sensor's noise, as it was read [m], shape (size,)."""
    readings = assessment.error.rebuilt.readings
    return np.asarray(readings.smoothed.measured[0, :size])


def _tracking(assessment: Assessment, size: int) -> Array:
    """Errors of gain and of delay of a run, the latter times ω₀: both as shares of the command."""
    command = assessment.recording.command[:size]
    measured_displacement = _measured_motion(assessment, size)
    gain, delay, _ = fit_followers(command, measured_displacement, assessment.recording.time_step)
    return np.array([gain.item() - 1.0, delay.item() * assessment.structure.circular_frequency])


def _unknown_zero(assessment: Assessment, generator: np.random.Generator) -> Array:
    """Draw where the tracking error truly vanishes, as far as channels are known, shape (draws, 2)."""
    sizes = assessment.error.rebuilt.inferred.sizes
    late = np.hypot(sizes.get("time_shift", 0.0), sizes.get("filter_delay", 0.0))
    zero_draws = generator.standard_normal((_DRAWS, 2)) * [sizes.get("sensor_scale", 0.0), late]
    zero_draws[:, 1] += sizes.get("open_filter", 0.0) * (generator.uniform(size=_DRAWS) < _OPEN)
    zero_draws[:, 1] *= assessment.structure.circular_frequency
    return np.asarray(zero_draws)


def _interval(size: Estimate) -> str:
    return percent_with_interval(size.value, size.low, size.high)


def _require_one_test(runs: Mapping[str, Assessment]) -> None:
    assessments: Sequence[Assessment] = list(runs.values())
    if len(assessments) < 2:  # noqa: PLR2004 - a pair
        raise InputError(
            "Extrapolating needs at least two runs",
            value=len(assessments),
            remedy="Name every run of the test",
        )
    first = assessments[0]
    for name, assessment in runs.items():
        if not np.isclose(assessment.recording.time_step, first.recording.time_step, rtol=1e-6):
            raise InputError(
                "The runs have different sampling rates",
                value=f"{significant(1.0 / assessment.recording.time_step)} Hz",
                remedy="Resample them to one rate",
                where=name,
            )
        size = min(assessment.recording.command.size, first.recording.command.size)
        correlation, offset = _largest_correlation(
            first.recording.command[:size], assessment.recording.command[:size]
        )
        if not correlation > _LEAST_CORRELATION:
            raise InputError(
                "The runs have different commands",
                value=f"a correlation of {significant(correlation, 2)}",
                where=name,
                remedy="Extrapolate runs of one test only, driven by the same command",
            )
        seconds = offset * first.recording.time_step
        if abs(seconds) * first.structure.frequency > _APART_IN_TIME:
            raise InputError(
                "The runs begin at different instants of the ground motion",
                value=f"{significant(seconds, 2)} s apart",
                remedy="Cut their beginnings",
                where=name,
            )


def _largest_correlation(first: Array, second: Array) -> tuple[float, int]:
    """Largest correlation of two histories, and the number of samples by which they are apart there."""
    correlation = cross_correlate(second, first) / max(
        float(np.linalg.norm(first) * np.linalg.norm(second)), 1e-300
    )
    place = int(np.argmax(correlation))
    return float(correlation[place]), place - (first.size - 1)
