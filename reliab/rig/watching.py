"""One quantity of a rig, watched test by test: each against its prediction, and what adds up over tests.

Each test is predicted from those before it but the latest five, by a level and by effects of circumstances
(peak displacement, frequency, warmth, specimen). Its residual over the spread of such predictions hardly
depends on those before it where nothing changes (recursive residuals). It becomes a normal score z by
Student's t distribution and then by the distribution of the scores before it, so that odd tests and skewed
scatter are counted as often as they come. Cumulative sums watch z on either side: max(0, S + z − 0.7) for a
step of about two spreads, and max(0, S + z − 1/4) for a slow drift; z counts as 3 at most, so that no single
odd test is taken for a change. When a sum passes its limit a change is noticed. The five tests after it
confirm it, and then the level is learned anew, while spread and effects stay; or they do not, and all stays.
"""

import math
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import scipy

from reliab.arrays import Array

_WATCHES: Final = tuple((side, *sums) for sums in ((0.7, 3.1), (0.25, 12.0)) for side in (1.0, -1.0))
"""Side, slack and limit of each sum."""
_LARGEST_SCORE = 3.0
_WIDER = 6.0  # tests: limits are wider by this over the number of tests that are known
_WAITING = 5  # tests until one is learned from, lest a change hides in what it is compared with
_CONFIRMED = 1.0  # mean score of the tests after a change, on its side, that confirms it
_FEWEST = 8  # tests from which the next is predicted
_UNKNOWN = 1e8  # variance of a level of which nothing is known, in squared spreads
_EFFECT = 16.0  # variance of an effect before any test, likewise
_SMALLEST_SQUARE = 1e-18
_REMEMBERED = 300  # tests over which the spread is learned
_AS_MANY = 150.0  # scores that the normal distribution counts as
_SMOOTH = 0.3  # by which the distribution of the scores is smoothed
_NORMAL_95 = 1.645


@dataclass(frozen=True, kw_only=True)
class Noticed:
    """A change of one quantity, by places of tests."""

    since: int  # First test of those that it was compared with
    began: int
    noticed: int
    confirmed: bool  # By the tests after it, or these are still to come


@dataclass(frozen=True, kw_only=True, eq=False)
class Watched:
    """One quantity, watched."""

    scores: Array  # NaN where too few tests are before it
    band: tuple[Array, Array]
    changes: list[Noticed] = field(default_factory=list)


def watch(values: Array, effects: Array, caution: float = 1.0) -> Watched:
    """Watch one quantity.

    `effects`, shape (tests, effects): circumstances on which it may depend; `caution`, factor of the limits.
    """
    return _Watch(values, effects, caution).whole()


class _Watch:
    """State of a watch."""

    def __init__(self, values: Array, effects: Array, caution: float) -> None:
        self._values = values
        self._rows = np.column_stack([np.ones(values.size), effects])
        self._caution = caution
        unknown = np.full(values.size, np.nan)
        self._watched = Watched(scores=unknown.copy(), band=(unknown.copy(), unknown.copy()))
        self._prediction, self._sums = _Prediction(self._rows.shape[1]), _Sums(0)
        self._since = self._learned = 0
        self._pending: tuple[int, int, float] | None = None  # Began, noticed, side

    def whole(self) -> Watched:
        """Watch all tests in their order."""
        for place in range(self._values.size):
            self._compare(place)
            self._add(place)
            self._confirm(place)
            if self._pending is None:
                self._learn(place)
        self._settle(confirmed=True)
        return self._watched

    def _compare(self, place: int) -> None:
        predicted = self._prediction.predict(self._rows[place])
        if predicted is None:
            return
        centre, spread, degrees = predicted
        self._watched.scores[place] = self._prediction.score((self._values[place] - centre) / spread, degrees)
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
        passed = self._sums.add(score, place, limit)
        if passed is None:
            return
        self._sums = _Sums(place + 1)
        earliest, side = passed
        if self._pending is None or self._pending[2] != side:
            self._settle(confirmed=False)
            began = _most_likely_begin(self._values, self._since, max(earliest - 1, self._since + 1), place)
            self._pending = (began, place, side)

    def _confirm(self, place: int) -> None:
        """Decide whether a change is one, from the tests after it."""
        if self._pending is None or place < self._pending[1] + _WAITING:
            return
        began, noticed, side = self._pending
        confirmed = side * float(np.mean(self._watched.scores[noticed + 1 : place + 1])) > _CONFIRMED
        self._settle(confirmed=confirmed)
        if confirmed:
            self._since = self._learned = began
            self._sums = _Sums(place + 1)
            self._prediction.forget_level()

    def _settle(self, *, confirmed: bool) -> None:
        """Note a change that was noticed."""
        if self._pending is None:
            return
        began, noticed, _ = self._pending
        self._watched.changes.append(
            Noticed(since=self._since, began=began, noticed=noticed, confirmed=confirmed)
        )
        self._pending = None

    def _learn(self, place: int) -> None:
        for earlier in range(self._learned, place - _WAITING + 1):
            score = float(self._watched.scores[earlier])
            self._prediction.learn(float(self._values[earlier]), self._rows[earlier], score)
        self._learned = max(self._learned, place - _WAITING + 1)


def _most_likely_begin(values: Array, since: int, earliest: int, noticed: int) -> int:
    """First test of a change, so that those from it on stray most from those before."""
    before = float(np.median(values[since:earliest]))
    strayed = np.cumsum((values[earliest : noticed + 1] - before)[::-1])[::-1]
    return earliest + int(np.argmax(strayed**2 / np.arange(strayed.size, 0, -1)))


class _Sums:
    """Cumulative sums on either side, quick and slow."""

    def __init__(self, place: int) -> None:
        self._sums = [0.0] * len(_WATCHES)
        self._left_zero = [place] * len(_WATCHES)

    def add(self, score: float, place: int, wider: float) -> tuple[int, float] | None:
        """Add a test; where a change began and its side, None where there is none; `wider`: of the limits."""
        clipped = min(max(score, -_LARGEST_SCORE), _LARGEST_SCORE)
        passed = None
        for index, (side, slack, limit) in enumerate(_WATCHES):
            if self._sums[index] <= 0.0:
                self._left_zero[index] = place
            self._sums[index] = max(0.0, self._sums[index] + side * clipped - slack)
            if self._sums[index] > wider * limit:
                passed = max(passed or (0, side), (self._left_zero[index], side))
        return passed


class _Prediction:
    """Level and effects, learned test by test; odd tests count as far as three spreads."""

    def __init__(self, size: int) -> None:
        self._known = np.zeros(size)
        self._unsure = np.diag([_UNKNOWN, *[_EFFECT] * (size - 1)])  # covariance, in squared spreads
        self._squares = self._degrees = 0.0
        self._scores: list[float] = []
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
        known = np.array(self._scores[-_REMEMBERED:])
        beyond = float(scipy.special.ndtr(side * (normal - known) / _SMOOTH).sum()) if known.size else 0.0
        share = (beyond + _AS_MANY * float(scipy.special.ndtr(side * normal))) / (known.size + _AS_MANY)
        return side * float(scipy.special.ndtri(max(share, 1e-12)))

    def forget_level(self) -> None:
        """Forget the level; the spread and the effects stay known."""
        self._unsure[0], self._unsure[:, 0] = 0.0, 0.0
        self._unsure[0, 0] = _UNKNOWN
        self.count = 0

    def learn(self, value: float, row: Array, score: float) -> None:
        """Learn from a test, and from its score where it had one."""
        gained = self._unsure @ row
        leverage = float(row @ gained)
        residual = value - float(row @ self._known)
        if self.count:
            if self._degrees >= _FEWEST - 1:
                reach = _LARGEST_SCORE * self._spread * math.sqrt(1.0 + leverage)
                residual = min(max(residual, -reach), reach)
            # where effects are unsure, a residual says the less of the spread
            says = min((1.0 + 1.0 / self.count) / (1.0 + leverage), 1.0)
            kept = min(1.0, _REMEMBERED / (self._degrees + says))
            self._squares = kept * (self._squares + residual**2 / (1.0 + leverage))
            self._degrees = kept * (self._degrees + says)
        self._known += gained * residual / (1.0 + leverage)
        self._unsure -= np.outer(gained, gained) / (1.0 + leverage)
        self.count += 1
        if not math.isnan(score) and abs(score) < math.inf:
            self._scores.append(score)
