"""The next test of a rig: amplitude, delay, remainder and error with their intervals, before it is done."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Final

import numpy as np

from reliab.assessment.default_criterion import typical_ellipse
from reliab.core.arrays import Array
from reliab.core.plain_values import PlainResult
from reliab.core.significant_digits import significant
from reliab.core.vocabulary import MILLI
from reliab.rig.covariates import Covariates
from reliab.rig.learned import FittedQuantity
from reliab.rig.memory import Memory, NextTest
from reliab.rig.rig_folder import RigTable
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import first_order_ellipse

DRAWS: Final = 1000


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictedDraws:
    """Drawn tests, each an array of one shape."""

    amplitude: Array
    delay_ms: Array
    remainder: Array
    ratio: Array  # Error over what amplitude, delay and remainder explain

    def errors(self, a_values: Array, b_values: Array) -> Array:
        """Errors by the parameters a [-] and b [ms²] of ellipses over the squared error."""
        squares = ((self.amplitude - 1.0) ** 2 + self.remainder**2) / a_values + self.delay_ms**2 / b_values
        return np.sqrt(squares) * self.ratio


def learn_tracking(memory: Memory, coming: NextTest) -> dict[str, FittedQuantity]:
    """Learn amplitude, delay and remainder."""
    return {
        "A": memory.learn(memory.amplitude, coming),
        "d_ms": memory.learn(memory.delay, coming),
        "remainder": memory.learn(memory.log_remainder, coming),
    }


def learn_tests(memory: Memory, coming: NextTest) -> dict[str, FittedQuantity]:
    """Learn what tests are drawn from: their tracking, and what this does not explain of their errors."""
    return {**learn_tracking(memory, coming), "ratio": memory.learn(_log_ratio(memory), coming)}


def draw_tests(
    memory: Memory, fits: dict[str, FittedQuantity], coming: NextTest, structure: Structure
) -> PredictedDraws:
    """Draw coming tests from what was learned.

    The residuals of one test are drawn together, so that what goes together in the tests goes together in the
    draws; with few tests they are longer, as in Student's t distribution.
    """
    targets = memory.covariates_of(coming, structure)
    rng = np.random.default_rng(0)
    count = len(memory.table)
    places = rng.integers(count, size=DRAWS)
    longer = np.sqrt((count - 1.0) / rng.chisquare(count - 1.0, DRAWS))
    draws = {}
    for name, quantity in fits.items():
        mean, deviation = quantity.predict(targets)
        draws[name] = mean[0] + deviation[0] * longer * quantity.left_out.residuals[places]
    return PredictedDraws(
        amplitude=draws["A"],
        delay_ms=draws["d_ms"],
        remainder=np.exp(np.minimum(draws["remainder"], 5.0)),
        ratio=np.exp(np.clip(draws["ratio"], -20.0, 20.0)),
    )


def _log_ratio(memory: Memory) -> Array:
    """Logarithm of each test's error over what its gain, delay and remainder explain of it."""
    a_values, b_values = memory.table.numbers("own_a"), memory.table.numbers("own_b_ms2")
    known_tests = PredictedDraws(
        amplitude=memory.amplitude,
        delay_ms=memory.delay,
        remainder=np.exp(memory.log_remainder),
        ratio=np.ones(a_values.size),
    )
    ratio = memory.log_error - np.log(np.maximum(known_tests.errors(a_values, b_values), 1e-10))
    return np.where(np.isfinite(ratio), ratio, 0.0)


LEVEL: Final = 0.9
_ENDS: Final = (0.05, 0.5, 0.95)
_NAMES: Final = ("low", "median", "high")
_TOLERANCE: Final = 1e-9
_LARGEST_R_HAT: Final = 1.2
_WORDS: Final = {"d_ms": "d", "rms": "error", "ratio": "error relative to that from A, d and remainder"}
_LARGEST_PROBABILITY: Final = 0.99
"""As for a test: higher ones were not validated."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Prediction(PlainResult):
    """What is predicted of the next test."""

    keys: ClassVar[Mapping[str, str]] = {
        **{name: name for name in ("tests", "earthquakes", "threshold", "interval_level")},
        **{name: f"intervals.{name}" for name in ("A", "d_ms", "remainder", "rms")},
        **{name: name for name in ("probability", "drivers", "driver", "basis", "log_scores", "better")},
        **{name: name for name in ("sampling", "notes")},
    }
    interval_level = LEVEL

    tests: int
    earthquakes: int
    threshold: float
    intervals: Mapping[str, Mapping[str, float]]  # Of "A", "d_ms", "remainder" and "rms"
    probability: float  # That the error stays below the threshold
    drivers: Mapping[str, float]  # Share of amplitude, delay and remainder in the squared error
    basis: str  # From what the error follows
    fits: Mapping[str, FittedQuantity]
    notes: tuple[str, ...]

    @property
    def driver(self) -> str:
        """Which of amplitude, delay and remainder has the largest share in the squared error."""
        return max(self.drivers, key=lambda name: self.drivers[name])

    @property
    def sampling(self) -> dict[str, dict[str, float]]:
        """Convergence of the sampled variances of each quantity."""
        return {
            name: {
                "r_hat": quantity.variances.r_hat,
                "effective_size": quantity.variances.effective_size,
            }
            for name, quantity in self.fits.items()
        }

    @property
    def better(self) -> str:
        """Which of model and baselines predicts left-out earthquakes best, by the sum of mean log scores."""
        totals = self.log_scores
        return max(totals, key=lambda name: float("-inf") if totals[name] is None else totals[name] or 0.0)

    @property
    def log_scores(self) -> dict[str, float | None]:
        """Mean log score on left-out earthquakes, summed over the quantities."""
        scores: dict[str, list[float | None]] = {}
        for quantity in self.fits.values():
            scores.setdefault("hierarchical model", []).append(quantity.log_score)
            for name, score in quantity.scores_of_baselines.items():
                scores.setdefault(name, []).append(score)
        return {name: _sum_of_known(values) for name, values in scores.items()}

    @property
    def has_converged(self) -> bool:
        """Whether the draws of all quantities agree between their batches."""
        return not _rhat_of_unconverged(self.fits)


def _sum_of_known(values: list[float | None]) -> float | None:
    finite = [value for value in values if value is not None]
    return sum(finite) if len(finite) == len(values) else None


def predict_next(
    table: RigTable, structure: Structure | None, coming: NextTest, *, threshold: float, frame: str = ""
) -> Prediction:
    """Predict a test under a ground motion that nobody knows yet; `frame` in place of a structure."""
    memory = Memory.from_table(table, frame)
    fits = learn_tracking(memory, coming)
    scales = np.zeros(len(memory.table)) if structure is None else memory.log_scales()
    scale = 0.0 if structure is None else memory.log_scale(structure)
    fits["rms"] = memory.learn(memory.log_error - scales, coming)
    targets = memory.covariates_of(coming, structure)
    quantiles = np.exp(scale + fits["rms"].quantiles(targets, _ENDS)[:, 0])
    probability = float(fits["rms"].cumulative(targets, float(np.log(threshold)) - scale)[0])
    assumed_structure = Structure(frequency=1.0, damping_ratio=0.02) if structure is None else structure
    return Prediction(
        **_counts(memory),
        threshold=threshold,
        intervals={**_tracking_intervals(fits, targets), "rms": _interval(quantiles)},
        probability=_cap_probability(probability),
        drivers=_shares(memory.contributions(typical_ellipse(assumed_structure))),
        basis="the errors of the rig's own tests, scaled to this structure by the ellipses of real_suite"
        if np.ptp([*scales, scale]) > _TOLERANCE
        else "the errors of the rig's own tests",
        fits=fits,
        notes=_notes(memory, coming, structure, fits),
    )


def predict_under_motion(
    table: RigTable, structure: Structure, coming: NextTest, excitation: Excitation, *, threshold: float
) -> Prediction:
    """Predict a test under a known ground motion: the loop is simulated with actuators that are drawn."""
    loop = Loop(excitation=excitation, structure=structure)
    still = loop.deviation(loop.cells(gain=[1.0], delay=[0.0]))
    coming = replace(coming, peak=MILLI * still.ideal_peak)
    memory = Memory.from_table(table)
    fits = learn_tests(memory, coming)
    draws = draw_tests(memory, fits, coming, structure)
    targets = memory.covariates_of(coming, structure)
    ellipse = first_order_ellipse(excitation, structure)
    if memory.diverging:  # as loops with such gains and delays would, but these tests did not
        errors = draws.errors(np.asarray(ellipse.amplitude), np.asarray(ellipse.delay))
        basis = (
            "the ellipse of this motion with actuators drawn from the posterior (a loop that was simulated "
            "with the delays of the rig's tests would diverge, which these tests did not)"
        )
    else:
        gains = np.maximum(draws.amplitude, 1e-3)
        deviation = loop.deviation(loop.cells(gain=gains, delay=draws.delay_ms / MILLI))
        loop_errors = np.sqrt(np.maximum(deviation.mean_square, 0.0)) / still.ideal_peak
        loop_errors = np.where(np.isfinite(loop_errors), loop_errors, 1e6)
        errors = np.sqrt(loop_errors**2 + draws.remainder**2 / ellipse.amplitude) * draws.ratio
        basis = "the loop simulated under this motion with actuators drawn from the posterior"
    return _summarise_draws(
        memory,
        fits,
        targets,
        errors,
        threshold=threshold,
        ellipse=(ellipse.amplitude, ellipse.delay),
        basis=basis,
        notes=_notes(memory, coming, structure, fits),
    )


def predict_under_suite(
    table: RigTable,
    structure: Structure,
    coming: NextTest,
    ellipses: tuple[Array, Array],
    *,
    threshold: float,
    suite: str,
) -> Prediction:
    """Predict a test under any motion of a suite, by a and b of its motions over the squared error."""
    memory = Memory.from_table(table)
    fits = learn_tests(memory, coming)
    draws = draw_tests(memory, fits, coming, structure)
    targets = memory.covariates_of(coming, structure)
    places = np.random.default_rng(1).integers(ellipses[0].size, size=DRAWS)
    return _summarise_draws(
        memory,
        fits,
        targets,
        draws.errors(ellipses[0][places], ellipses[1][places]),
        threshold=threshold,
        ellipse=(float(np.median(ellipses[0])), float(np.median(ellipses[1]))),
        basis=f"the ellipses of the motions of {suite} with actuators drawn from the posterior",
        notes=_notes(memory, coming, structure, fits),
    )


def _summarise_draws(
    memory: Memory,
    fits: dict[str, FittedQuantity],
    targets: Covariates,
    errors: Array,
    *,
    threshold: float,
    ellipse: tuple[float, float],
    basis: str,
    notes: tuple[str, ...],
) -> Prediction:
    """Put drawn errors into a prediction."""
    return Prediction(
        **_counts(memory),
        threshold=threshold,
        intervals={
            **_tracking_intervals(fits, targets),
            "rms": _interval(np.quantile(np.minimum(errors, 1e6), _ENDS)),
        },
        probability=_cap_probability(float((errors <= threshold).mean())),
        drivers=_shares(memory.contributions(ellipse)),
        basis=basis,
        fits=fits,
        notes=notes,
    )


def _counts(memory: Memory) -> dict[str, Any]:
    return {"tests": len(memory.table), "earthquakes": len(set(memory.events.tolist()))}


def _tracking_intervals(
    fits: Mapping[str, FittedQuantity], targets: Covariates
) -> dict[str, dict[str, float]]:
    quantiles = {name: fits[name].quantiles(targets, _ENDS)[:, 0] for name in ("A", "d_ms", "remainder")}
    quantiles["remainder"] = np.exp(quantiles["remainder"])
    return {name: _interval(values) for name, values in quantiles.items()}


def _interval(quantiles: Array) -> dict[str, float]:
    return dict(zip(_NAMES, np.sort(quantiles).tolist(), strict=True))


def _cap_probability(probability: float) -> float:
    return float(np.clip(probability, 1.0 - _LARGEST_PROBABILITY, _LARGEST_PROBABILITY))


def _shares(contributions: Mapping[str, float]) -> dict[str, float]:
    total = sum(contributions.values()) or 1.0
    return {name: value / total for name, value in contributions.items()}


def _rhat_of_unconverged(fits: Mapping[str, FittedQuantity]) -> dict[str, float]:
    """R-hat of quantities whose draws differ between batches."""
    sizes = {name: quantity.variances.r_hat for name, quantity in fits.items()}
    return {name: size for name, size in sizes.items() if not size <= _LARGEST_R_HAT}


def _notes(
    memory: Memory, coming: NextTest, structure: Structure | None, fits: Mapping[str, FittedQuantity]
) -> tuple[str, ...]:
    """Say what to know before relying on it."""
    notes = []
    if unconverged_rhat := _rhat_of_unconverged(fits):
        sizes = ", ".join(f"{_WORDS.get(name, name)} {size:.2f}" for name, size in unconverged_rhat.items())
        notes.append(
            f"The posterior's draws have not converged (R-hat, which is 1 after convergence: {sizes}), so "
            "that intervals and probability are not to be relied on."
        )
    frequencies = memory.table.numbers("f")
    if structure is not None and not (
        0.99 * frequencies.min() <= structure.frequency <= 1.01 * frequencies.max()
    ):
        ends = dict.fromkeys(significant(end, 3) for end in (frequencies.min(), frequencies.max()))
        notes.append(f"The rig's tests are of structures of {' to '.join(ends)} Hz.")
    if not memory.is_ordered:
        notes.append("Dates are not stated for all tests, so that nothing is learned from their order.")
    if not any(memory.table.texts("event")):
        notes.append("Earthquakes are not stated; every test counts as one of a separate earthquake.")
    peaks = memory.table.numbers("peak_mm")
    if coming.peak is not None and not peaks.min() <= coming.peak <= peaks.max():
        notes.append(
            f"The response to this motion peaks at {significant(coming.peak, 3)} mm, those of the rig's "
            f"tests at {significant(peaks.min(), 3)} to {significant(peaks.max(), 3)} mm."
        )
    return tuple(notes)
