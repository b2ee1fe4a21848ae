"""Has the rig changed? Each test against its prediction from those before, and what adds up over tests.

For gain, delay and noise (the logarithm of the remainder) each test is predicted from those since the last
change but the latest five, by a level and a slope over the logarithm of the peak displacement. Its residual
over the spread of such predictions, as a normal score z, hardly depends on those before it where nothing
changes (recursive residuals). Cumulative sums watch z on either side: max(0, S + z − 0.8) beyond 2.8 for a
step of about two spreads, and max(0, S + z − 1/4) beyond 11 for a slow drift, with wider limits where few
tests are known; z counts as 3 at most, so that no single odd test is taken for a change.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from reliab.arrays import Array
from reliab.vocabulary import PERCENT

_LIMITS: Final = {"gain": 1.10, "delay": 0.98, "noise": 1.21}
"""By cause the factor of its limits: the delay is watched most closely."""
CAUSES: Final = tuple(_LIMITS)
FALSE_ALARMS: Final = 0.01
"""Most false alarms a test, of all charts together, where tests scatter normally and nothing changes."""

_WATCHES: Final = tuple((side, *sums) for sums in ((0.8, 2.8), (0.25, 11.0)) for side in (1.0, -1.0))
"""Side, slack and limit of each sum."""
_LARGEST_SCORE = 3.0
_WIDER = 6.0  # tests: limits are wider by this over the number of tests that are known
_WAITING = 5  # tests until one is learned from, lest a change hides in what it is compared with
_FEWEST = 8  # tests from which the next is predicted
_SMALLEST = 1e-5
_WEAK = 1e-4  # precision of the slope before any test
_VARIED = 0.1  # of the logarithm of the peak, from which the slope costs a degree of freedom
_SMALLEST_SQUARE = 1e-18
_NORMAL_95 = 1.645


@dataclass(frozen=True, kw_only=True)
class Change:
    """A change of the rig."""

    cause: str  # One of CAUSES
    noticed: int  # Place of the test at which it was noticed
    began: int  # Place of the first test after it
    size: float  # Of A [-], d [ms], or the logarithm of the remainder

    def __str__(self) -> str:
        """Say what changed, and by how much."""
        if self.cause == "delay":
            return f"delay {self.size:+.2f} ms"
        if self.cause == "gain":
            return f"gain {PERCENT * self.size:+.2f} %"
        return f"noise times {np.exp(self.size):.2f}"


@dataclass(frozen=True, kw_only=True, eq=False)
class DriftChart:
    """All tests against their predictions, in their order."""

    values: Mapping[str, Array]  # By cause
    scores: Mapping[str, Array]  # Normal score of each test; NaN where too few are before it
    bands: Mapping[str, tuple[Array, Array]]  # 90 % interval of each test before it; NaN likewise
    changes: tuple[Change, ...]

    @property
    def segments(self) -> Array:
        """How many changes had begun before each test."""
        count = next(iter(self.values.values())).size
        began = np.sort([change.began for change in self.changes])
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
    peaks = np.log(np.maximum([float(row["peak_mm"]) for row in rows], _SMALLEST))
    peaks = np.clip((peaks - np.median(peaks)) if peaks.size else peaks, -3.0, 3.0)
    values = {
        "gain": np.array([float(row["A"]) for row in rows]),
        "delay": np.array([float(row["d_ms"]) for row in rows]),
        "noise": np.log(np.maximum([float(row["remainder"]) for row in rows], _SMALLEST)),
    }
    scores: dict[str, Array] = {}
    bands: dict[str, tuple[Array, Array]] = {}
    changes: list[Change] = []
    for cause in CAUSES:
        watched = watch(values[cause], peaks, _LIMITS[cause])
        scores[cause], bands[cause] = watched.scores, watched.band
        changes += [
            Change(
                cause=cause, noticed=noticed, began=began, size=_size(values[cause], since, began, noticed)
            )
            for since, began, noticed in watched.changes
        ]
    changes.sort(key=lambda change: (change.noticed, change.began))
    return DriftChart(values=values, scores=scores, bands=bands, changes=tuple(changes))


def _size(values: Array, since: int, began: int, noticed: int) -> float:
    return float(np.median(values[began : noticed + 1]) - np.median(values[since:began]))


@dataclass(frozen=True, kw_only=True, eq=False)
class Watched:
    """One quantity, watched."""

    scores: Array
    band: tuple[Array, Array]
    changes: list[tuple[int, int, int]] = field(default_factory=list)  # Learned since, began, noticed


def watch(values: Array, peaks: Array, caution: float = 1.0) -> Watched:
    """Watch one quantity, over the logarithm of the peak displacement less its median.

    `caution`: factor of the limits.
    """
    unknown = np.full(values.size, np.nan)
    watched = Watched(scores=unknown.copy(), band=(unknown.copy(), unknown.copy()))
    since = 0
    prediction, sums = _Prediction(), _Sums(0)
    for place in range(values.size):
        value, peak = float(values[place]), float(peaks[place])
        score = prediction.score(value, peak)
        if score is not None:
            watched.scores[place] = score
            watched.band[0][place], watched.band[1][place] = prediction.interval(peak)
        began = None if score is None else sums.add(score, place, caution * (1.0 + _WIDER / prediction.count))
        if began is not None:
            began = _most_likely_begin(values, since, max(began - 1, since + 1), place)
            watched.changes.append((since, began, place))
            since = began
            prediction, sums = _Prediction(), _Sums(place + 1)
            for earlier in range(began, place - _WAITING + 1):
                prediction.learn(float(values[earlier]), float(peaks[earlier]))
        elif (earlier := place - _WAITING) >= since:
            prediction.learn(float(values[earlier]), float(peaks[earlier]))
    return watched


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

    def add(self, score: float, place: int, wider: float) -> int | None:
        """Add a test; return where a change began, None where there is none; `wider` times the limits."""
        clipped = min(max(score, -_LARGEST_SCORE), _LARGEST_SCORE)
        began = None
        for index, (side, slack, limit) in enumerate(_WATCHES):
            if self._sums[index] <= 0.0:
                self._left_zero[index] = place
            self._sums[index] = max(0.0, self._sums[index] + side * clipped - slack)
            if self._sums[index] > wider * limit:
                began = max(began or 0, self._left_zero[index])
        return began


class _Prediction:
    """Level and slope, learned test by test; odd tests count as far as three spreads."""

    def __init__(self) -> None:
        self._of_level, self._across, self._of_slope = 1e8, 0.0, 1.0 / _WEAK  # inverse of what is known
        self._level = self._slope = self._squares = 0.0
        self.count = 0
        self._least, self._largest = math.inf, -math.inf

    @property
    def _degrees(self) -> float:
        return self.count - (2.0 if self._largest - self._least > _VARIED else 1.0)

    @property
    def _spread(self) -> float:
        return math.sqrt(max(self._squares / self._degrees, _SMALLEST_SQUARE))

    def score(self, value: float, peak: float) -> float | None:
        """Return the normal score of a test; None where too few are known."""
        if self.count < _FEWEST:
            return None
        degrees, (_, _, leverage) = self._degrees, self._gained(peak)
        student = (value - self._level - self._slope * peak) / (self._spread * math.sqrt(1.0 + leverage))
        # Wallace (1959): the normal score of Student's t
        factor = (8.0 * degrees + 1.0) / (8.0 * degrees + 3.0)
        return math.copysign(factor * math.sqrt(degrees * math.log1p(student**2 / degrees)), student)

    def interval(self, peak: float) -> tuple[float, float]:
        """Return the 90 % interval of a test, by Student's t distribution."""
        degrees, (_, _, leverage) = self._degrees, self._gained(peak)
        longer = _NORMAL_95 * (1.0 + (_NORMAL_95**2 + 1.0) / (4.0 * degrees))
        reach = longer * self._spread * math.sqrt(1.0 + leverage)
        centre = self._level + self._slope * peak
        return centre - reach, centre + reach

    def _gained(self, peak: float) -> tuple[float, float, float]:
        """Return what a test teaches of level and slope, and its leverage."""
        level = self._of_level + self._across * peak
        slope = self._across + self._of_slope * peak
        return level, slope, level + slope * peak

    def learn(self, value: float, peak: float) -> None:
        """Learn from a test."""
        level, slope, leverage = self._gained(peak)
        residual = value - self._level - self._slope * peak
        if self.count >= _FEWEST:
            reach = _LARGEST_SCORE * self._spread * math.sqrt(1.0 + leverage)
            residual = min(max(residual, -reach), reach)
        if self.count:
            self._squares += residual**2 / (1.0 + leverage)
        share = 1.0 / (1.0 + leverage)
        self._level += level * residual * share
        self._slope += slope * residual * share
        self._of_level -= level * level * share
        self._across -= level * slope * share
        self._of_slope -= slope * slope * share
        self.count += 1
        self._least, self._largest = min(self._least, peak), max(self._largest, peak)
