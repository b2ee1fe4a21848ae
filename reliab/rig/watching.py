"""One quantity of a rig, watched test by test: each against its prediction, and what adds up over tests.

Each test is predicted from those before it but the latest five, by a level and by effects of covariates
(peak displacement, frequency, warmth, specimen). Its residual over the spread of such predictions hardly
depends on those before it where nothing changes (recursive residuals). It becomes a normal score z by
Student's t distribution and then by the distribution of the ordinary scores before it, so that skewed scatter
is counted as often as it comes. Cumulative
sums watch z on either side: what speaks for a step of 1.4 spreads or far more, and max(0, S + z − 1/4) for a
slow drift, where z counts as 3 at most; no single odd test is taken for a change. When a sum passes its limit
a change is noticed. The five tests after it confirm it, and then the level is learned anew, while spread and
effects stay; or they do not, and all stays.

Odd tests are a share of their own, learned from a rig's own tests. A score z of an ordinary test is standard
normal, that of an odd one follows Student's t distribution of two degrees of freedom, five times as wide.
After a step an ordinary test is normal about it, or, where the step is far larger than supposed, anywhere on
its side. What a test says for a step is the logarithm of the ratio of its densities after it and before (Page
1954); a test far off says the less the more odd tests there are.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.vocabulary import PERCENT
from reliab.rig.covariates import places_in_day, warmth

_WIDE: Final = 5.0  # spread of odd tests
_PRIOR_COUNTS: Final = (0.25, 25.0)  # odd tests, of so many, that are supposed before any is seen
_FAR: Final = 0.1  # share of the steps that are far larger than supposed
_LARGEST_EVIDENCE: Final = 2.5  # that one test says, lest a single one is taken for a change
_ROUNDS: Final = 16
_CAUTIOUS: Final = 8  # first rounds, in which no test is taken for odd, but those far off count less
_NEAR: Final = 1.5  # spreads, within which a test counts wholly in them

_SIDES: Final = (1.0, -1.0)
_STEP: Final = 1.4  # spreads, of the step that is watched for
_LIMIT_OF_STEP: Final = 4.3
_SLACK: Final = 0.25
_LIMIT_OF_DRIFT: Final = 12.0
_LARGEST_SCORE = 3.0
_WIDER = 6.0  # tests: limits are wider by this over the number of tests that are known
_WAITING = 5  # tests until one is learned from, lest a change hides in what it is compared with
_CONFIRMING_SCORE = 1.0  # median score of the tests after a change, on its side, that confirms it
_FEWEST = 8  # tests from which the next is predicted
_SORTED_AT = frozenset(8 * 2**power for power in range(6))  # tests, when odd ones are told apart anew
_UNKNOWN = 1e8  # variance of a level of which nothing is known, in squared spreads
_EFFECT = 64.0  # variance of an effect before any test, likewise
_SMALLEST_SQUARE = 1e-18
_MEMORY_LENGTH = 300  # tests over which the spread, and the share of odd ones, is learned
_PRIOR_SCORES = 150.0  # scores that the normal distribution counts as
_SMOOTH = 0.3  # by which the distribution of the scores is smoothed
_NORMAL_95 = 1.645


def odd_density(score: float) -> float:
    """Density of the score of an odd test."""
    return float((1.0 + 0.5 * (score / _WIDE) ** 2) ** -1.5) / (2.0 * math.sqrt(2.0) * _WIDE)


def _normal_density(score: float) -> float:
    return math.exp(-0.5 * score * score) / math.sqrt(2.0 * math.pi)


@dataclass
class OddTests:
    """How many of the tests so far were odd."""

    odd: float = 0.0
    tests: float = 0.0

    @property
    def share(self) -> float:
        """Share of odd tests."""
        return (self.odd + _PRIOR_COUNTS[0]) / (self.tests + _PRIOR_COUNTS[1])

    def ordinary(self, score: float) -> float:
        """Probability that a test is an ordinary one."""
        ordinary = (1.0 - self.share) * _normal_density(score)
        return ordinary / (ordinary + self.share * odd_density(score))

    def learn(self, ordinary: float) -> None:
        """Count a test that is ordinary with some probability."""
        memory = min(1.0, _MEMORY_LENGTH / (self.tests + 1.0))
        self.odd = memory * (self.odd + 1.0 - ordinary)
        self.tests = memory * (self.tests + 1.0)

    def evidence(self, score: float, step: float) -> float:
        """Logarithm of how much more probable a score is after a step, on its side, than before it."""
        far = 2.0 * odd_density(score) * (score * step > 0.0)
        density_after = (1.0 - _FAR) * _normal_density(score - step) + _FAR * far
        odd = self.share * odd_density(score)
        density_before = (1.0 - self.share) * _normal_density(score) + odd
        return min(math.log(((1.0 - self.share) * density_after + odd) / density_before), _LARGEST_EVIDENCE)


@dataclass(frozen=True, kw_only=True, eq=False)
class OrdinaryTests:
    """Level and effects of ordinary tests, and which ones are."""

    effects: Array  # The level first
    unsure: Array  # Covariance of `effects`, in squared spreads
    spread: float
    ordinary: Array  # Probability of each test


def ordinary_tests(values: Array, rows: Array, unsure: Array) -> OrdinaryTests:
    """Tell ordinary tests from odd ones by expectation and maximisation.

    `rows`, shape (tests, effects): what each depends on, the level first; `unsure`: covariance before them.
    """
    effects: Array = np.zeros(rows.shape[1])
    effects[0] = np.median(values)
    spread = 1.4826 * float(np.median(np.abs(values - effects[0]))) or float(values.std()) or 1.0
    odd, prior = OddTests(), np.linalg.inv(unsure)
    for turn in range(_ROUNDS):
        scores = (values - rows @ effects) / spread
        ordinary = np.minimum(1.0, _NEAR / np.maximum(np.abs(scores), _NEAR))
        if turn >= _CAUTIOUS:
            ordinary = np.array([odd.ordinary(score) for score in scores.tolist()])
        odd = OddTests(odd=float((1.0 - ordinary).sum()), tests=float(values.size))
        precision = prior + rows.T @ (ordinary[:, None] * rows)
        effects = np.asarray(np.linalg.solve(precision, rows.T @ (ordinary * values)))
        residuals = values - rows @ effects
        degrees = float(np.trace(np.linalg.solve(precision, precision - prior)))
        squares = float(ordinary @ residuals**2)
        spread = math.sqrt(max(squares / max(float(ordinary.sum()) - degrees, 1.0), 1e-18))
    return OrdinaryTests(
        effects=effects, unsure=np.asarray(np.linalg.inv(precision)), spread=spread, ordinary=ordinary
    )


@dataclass(frozen=True, kw_only=True)
class DetectedChange:
    """A change of one quantity, by places of tests."""

    since: int  # First test of those that it was compared with
    began: int
    detection_place: int
    is_confirmed: bool  # By the tests after it, or these are still to come


@dataclass(frozen=True, kw_only=True, eq=False)
class MonitoredQuantity:
    """One quantity, watched."""

    scores: Array  # NaN where too few tests are before it
    band: tuple[Array, Array]
    changes: list[DetectedChange] = field(default_factory=list)


def watch(values: Array, effects: Array, caution: float = 1.0) -> MonitoredQuantity:
    """Watch one quantity.

    `effects`, shape (tests, effects): covariates on which it may depend; `caution`, factor of the
    limits and of what confirms a change.
    """
    return _Watch(values, effects, caution).finish()


class _Watch:
    """State of a watch."""

    def __init__(self, values: Array, effects: Array, caution: float) -> None:
        self._values = values
        self._rows = np.column_stack([np.ones(values.size), effects])
        self._caution = caution
        unknown = np.full(values.size, np.nan)
        self._watched = MonitoredQuantity(scores=unknown.copy(), band=(unknown.copy(), unknown.copy()))
        self._prediction, self._sums = _Prediction(self._rows.shape[1]), _Sums(0)
        self._since = self._learned = 0
        self._pending: tuple[int, int, float] | None = None  # Began, noticed, side

    def finish(self) -> MonitoredQuantity:
        """Watch all tests in their order."""
        for place in range(self._values.size):
            self._compare(place)
            self._add(place)
            self._confirm(place)
            if self._pending is None:
                self._learn(place)
        self._settle(is_confirmed=True)
        return self._watched

    def _compare(self, place: int) -> None:
        prediction = self._prediction.predict(self._rows[place])
        if prediction is None:
            return
        centre, spread, degrees = prediction
        residual = float(self._values[place] - centre)
        self._watched.scores[place] = self._prediction.score(residual / spread, degrees)
        longer = _NORMAL_95 * (1.0 + (_NORMAL_95**2 + 1.0) / (4.0 * degrees))
        self._watched.band[0][place], self._watched.band[1][place] = (
            centre - longer * spread,
            centre + longer * spread,
        )

    def _add(self, place: int) -> None:
        """Add a test to the sums; one that passes its limit on another side than before is a change."""
        score = float(self._watched.scores[place])
        if math.isnan(score):
            return
        limit = self._caution * (1.0 + _WIDER / self._prediction.count)
        crossed_sum = self._sums.add(score, place, limit, self._prediction.odd)
        if crossed_sum is None:
            return
        self._sums = _Sums(place + 1)
        earliest, side = crossed_sum
        if self._pending is None or self._pending[2] != side:
            self._settle(is_confirmed=False)
            began = _most_likely_begin(self._values, self._since, max(earliest - 1, self._since + 1), place)
            self._pending = (began, place, side)

    def _confirm(self, place: int) -> None:
        """Decide whether a change is one, from the tests after it."""
        if self._pending is None or place < self._pending[1] + _WAITING:
            return
        began, detection_place, side = self._pending
        score_after = side * float(np.median(self._watched.scores[detection_place + 1 : place + 1]))
        is_confirmed = score_after > self._caution * _CONFIRMING_SCORE
        self._settle(is_confirmed=is_confirmed)
        if is_confirmed:
            self._since = self._learned = began
            self._sums = _Sums(place + 1)
            self._prediction.forget_level()

    def _settle(self, *, is_confirmed: bool) -> None:
        """Note a change that was noticed."""
        if self._pending is None:
            return
        began, place, _ = self._pending
        self._watched.changes.append(
            DetectedChange(since=self._since, began=began, detection_place=place, is_confirmed=is_confirmed)
        )
        self._pending = None

    def _learn(self, place: int) -> None:
        for earlier in range(self._learned, place - _WAITING + 1):
            score = float(self._watched.scores[earlier])
            self._prediction.learn(float(self._values[earlier]), self._rows[earlier], score)
            if self._since == 0 and earlier + 1 in _SORTED_AT:
                self._prediction.sort(self._values[: earlier + 1], self._rows[: earlier + 1])
        self._learned = max(self._learned, place - _WAITING + 1)


def _most_likely_begin(values: Array, since: int, earliest: int, detection_place: int) -> int:
    """First test of a change, so that those from it on stray most from those before."""
    level_before = float(np.median(values[since:earliest]))
    cumulative_deviation = np.cumsum((values[earliest : detection_place + 1] - level_before)[::-1])[::-1]
    return earliest + int(np.argmax(cumulative_deviation**2 / np.arange(cumulative_deviation.size, 0, -1)))


class _Sums:
    """Cumulative sums on either side, for a step and for a drift."""

    def __init__(self, place: int) -> None:
        self._step, self._drift = (dict.fromkeys(_SIDES, 0.0) for _ in range(2))
        self._left_zero = {(side, kind): place for side in _SIDES for kind in ("step", "drift")}

    def add(self, score: float, place: int, wider: float, odd: OddTests) -> tuple[int, float] | None:
        """Add a test; where a change began and its side, None where there is none; `wider`: of the limits."""
        clipped_score = min(max(score, -_LARGEST_SCORE), _LARGEST_SCORE)
        crossed_sum = None
        for side in _SIDES:
            says = {"step": odd.evidence(score, side * _STEP), "drift": side * clipped_score - _SLACK}
            for kind, sums, limit in (
                ("step", self._step, _LIMIT_OF_STEP),
                ("drift", self._drift, _LIMIT_OF_DRIFT),
            ):
                if sums[side] <= 0.0:
                    self._left_zero[side, kind] = place
                sums[side] = max(0.0, sums[side] + says[kind])
                if sums[side] > wider * limit:
                    crossed_sum = max(crossed_sum or (0, side), (self._left_zero[side, kind], side))
        return crossed_sum


class _Prediction:
    """Level and effects, learned test by test; odd tests count as far as three spreads."""

    def __init__(self, size: int) -> None:
        self._known = np.zeros(size)
        self._unsure = np.diag([_UNKNOWN, *[_EFFECT] * (size - 1)])  # covariance, in squared spreads
        self._squares = self._degrees = 0.0
        self._scores: list[float] = []
        self._ordinary: list[float] = []  # Probability of each score that its test is no odd one
        self.odd = OddTests()
        self.count = 0  # Tests since the level was forgotten

    def predict(self, row: Array) -> tuple[float, float, float] | None:
        """Centre, spread and degrees of freedom of a test; None where too few are known."""
        if self._degrees < _FEWEST - 1 or self.count == 0:
            return None
        leverage = float(row @ self._unsure @ row)
        return float(row @ self._known), self._spread * math.sqrt(1.0 + leverage), self._degrees

    @property
    def _spread(self) -> float:
        return math.sqrt(max(self._squares / self._degrees, _SMALLEST_SQUARE))

    def score(self, student: float, degrees: float) -> float:
        """Return the normal score of a residual over its spread."""
        # Wallace (1959): the normal score of Student's t
        factor = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0)
        normal = math.copysign(factor * math.sqrt(degrees * math.log1p(student**2 / degrees)), student)
        side = -math.copysign(1.0, normal)
        scores, ordinary = (np.array(history[-_MEMORY_LENGTH:]) for history in (self._scores, self._ordinary))
        tail = float(ordinary @ scipy.special.ndtr(side * (normal - scores) / _SMOOTH))
        share = (tail + _PRIOR_SCORES * float(scipy.special.ndtr(side * normal))) / (
            ordinary.sum() + _PRIOR_SCORES
        )
        return side * float(scipy.special.ndtri(max(share, 1e-12)))

    def forget_level(self) -> None:
        """Forget the level; the spread and the effects stay known."""
        self._unsure[0], self._unsure[:, 0] = 0.0, 0.0
        self._unsure[0, 0] = _UNKNOWN
        self.count = 0

    def sort(self, values: Array, rows: Array) -> None:
        """Learn all tests anew, odd ones told from ordinary ones."""
        unsure = np.diag([_UNKNOWN, *[_EFFECT] * (self._known.size - 1)])
        is_ordinary = ordinary_tests(values, rows, unsure)
        self._known, self._unsure = is_ordinary.effects, is_ordinary.unsure
        ordinary = float(is_ordinary.ordinary.sum())
        self._degrees *= ordinary / max(self.odd.tests - self.odd.odd, ordinary)
        self._squares = self._degrees * is_ordinary.spread**2
        self.odd = OddTests(odd=values.size - ordinary, tests=float(values.size))

    def learn(self, value: float, row: Array, score: float) -> None:
        """Learn from a test, and from its score where it had one."""
        gain = self._unsure @ row
        leverage = float(row @ gain)
        residual = value - float(row @ self._known)
        ordinary = 1.0
        if self.count:
            if self._degrees >= _FEWEST - 1:
                spread = self._spread * math.sqrt(1.0 + leverage)
                ordinary = self.odd.ordinary(residual / spread if math.isnan(score) else score)
                reach = _LARGEST_SCORE * spread
                residual = min(max(residual, -reach), reach)
            # where effects are unsure, a residual says the less of the spread
            says = ordinary * min((1.0 + 1.0 / self.count) / (1.0 + leverage), 1.0)
            forgetting = min(1.0, _MEMORY_LENGTH / (self._degrees + says))
            self._squares = forgetting * (self._squares + ordinary * residual**2 / (1.0 + leverage))
            self._degrees = forgetting * (self._degrees + says)
        self.odd.learn(ordinary)
        self._known += gain * residual / (1.0 + leverage)
        self._unsure -= np.outer(gain, gain) / (1.0 + leverage)
        self.count += 1
        if not math.isnan(score) and abs(score) < math.inf:
            self._scores.append(score)
            self._ordinary.append(ordinary)


_LIMITS: Final = {"gain": 1.6, "delay": 1.0, "noise": 1.6}
"""By cause the factor of its limits: the delay is watched most closely."""
CAUSES: Final = tuple(_LIMITS)
FALSE_ALARMS: Final = 0.01
"""Most false alarms a test, of all charts together, where nothing changes."""

_SMALLEST = 1e-5
_REACH = 3.0  # of the logarithm of peak and frequency about their medians
_LEAST_SPREAD = 0.1  # of an effect's circumstance, from which it is learned
_MOST_SPECIMENS = 12
_DAY = 10  # characters of a date


@dataclass(frozen=True, kw_only=True)
class Change:
    """A change of the rig."""

    cause: str  # One of CAUSES
    noticed: int  # Place of the test at which it was noticed
    began: int  # Place of the first test after it
    size: float  # Of A [-], d [ms], or the logarithm of the remainder
    confirmed: bool  # By the tests after it was noticed, or these are still to come

    def __str__(self) -> str:
        """Say what changed, and by how much."""
        doubt = "" if self.confirmed else ", not confirmed by the next tests"
        if self.cause == "delay":
            return f"delay {self.size:+.2f} ms{doubt}"
        if self.cause == "gain":
            return f"gain {PERCENT * self.size:+.2f} %{doubt}"
        return f"noise {np.exp(self.size):.2f} times as large{doubt}"


@dataclass(frozen=True, kw_only=True, eq=False)
class DriftChart:
    """All tests against their predictions, in their order."""

    values: Mapping[str, Array]  # By cause
    scores: Mapping[str, Array]  # Normal score of each test; NaN where too few are before it
    bands: Mapping[str, tuple[Array, Array]]  # 90 % interval of each test before it; NaN likewise
    changes: tuple[Change, ...]

    @property
    def segments(self) -> Array:
        """How many changes had begun before each test, without those that were not confirmed."""
        count = next(iter(self.values.values())).size
        began = np.sort([change.began for change in self.changes if change.confirmed])
        return np.searchsorted(began, np.arange(count), side="right").astype(np.float64)

    @property
    def flags(self) -> list[str]:
        """What was noticed at each test; empty at most."""
        texts = [""] * next(iter(self.values.values())).size
        for change in self.changes:
            texts[change.noticed] = "; ".join(filter(None, [texts[change.noticed], str(change)]))
        return texts


def drift_chart(rows: Sequence[Mapping[str, Any]]) -> DriftChart:
    """Watch the tests of a rig in their order."""
    effects = read_effects(rows)
    values = {
        "gain": np.array([float(row["A"]) for row in rows]),
        "delay": np.array([float(row["d_ms"]) for row in rows]),
        "noise": np.log(np.maximum([float(row["remainder"]) for row in rows], _SMALLEST)),
    }
    quantities = {cause: watch(values[cause], effects, _LIMITS[cause]) for cause in CAUSES}
    changes = [
        Change(
            cause=cause,
            noticed=change.detection_place,
            began=change.began,
            size=_size(values[cause], change.since, change.began, change.detection_place),
            confirmed=change.is_confirmed,
        )
        for cause in CAUSES
        for change in quantities[cause].changes
    ]
    return DriftChart(
        values=values,
        scores={cause: quantities[cause].scores for cause in CAUSES},
        bands={cause: quantities[cause].band for cause in CAUSES},
        changes=tuple(sorted(changes, key=lambda change: (change.noticed, change.began))),
    )


def read_effects(rows: Sequence[Mapping[str, Any]]) -> Array:
    """Circumstances of tests that are no change of the rig, shape (tests, effects): each about its median."""
    columns = [
        np.log(np.maximum([float(row["peak_mm"]) for row in rows], _SMALLEST)),
        np.log([float(row.get("f") or 1.0) for row in rows]),
    ]
    if rows and all(row.get("date") for row in rows):
        columns.append(warmth(places_in_day(str(row["date"])[:_DAY] for row in rows)))
    about = [np.clip(column - np.median(column), -_REACH, _REACH) for column in columns if column.size]
    effects = [column for column in about if np.ptp(column) > _LEAST_SPREAD] + _specimen_indicators(rows)
    return np.stack(effects, axis=1) if effects else np.zeros((len(rows), 0))


def _specimen_indicators(rows: Sequence[Mapping[str, Any]]) -> list[Array]:
    """One indicator for each of the specimens that had most tests, but the first one."""
    names = [str(row.get("specimen") or "") for row in rows]
    usual = sorted(set(names) - set(names[:1]), key=names.count, reverse=True)[:_MOST_SPECIMENS]
    return [np.array([float(name == specimen) for name in names]) for specimen in usual]


def _size(values: Array, since: int, began: int, detection_place: int) -> float:
    return float(np.median(values[began : detection_place + 1]) - np.median(values[since:began]))
