"""Has the rig changed? Gain, delay and noise of each test against their predictions from those before."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.vocabulary import PERCENT
from reliab.rig.learning.circumstances import places_in_day, warmth
from reliab.rig.watching import watch

_LIMITS: Final = {"gain": 1.6, "delay": 1.0, "noise": 1.6}
"""By cause the factor of its limits: the delay is watched most closely."""
CAUSES: Final = tuple(_LIMITS)
FALSE_ALARMS: Final = 0.01
"""Most false alarms a test, of all charts together, where nothing changes."""

_SMALLEST = 1e-5
_REACH = 3.0  # of the logarithm of peak and frequency about their medians
_VARIED = 0.1  # of an effect's circumstance, from which it is learned
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
        return f"noise times {np.exp(self.size):.2f}{doubt}"


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
    effects = known_effects(rows)
    values = {
        "gain": np.array([float(row["A"]) for row in rows]),
        "delay": np.array([float(row["d_ms"]) for row in rows]),
        "noise": np.log(np.maximum([float(row["remainder"]) for row in rows], _SMALLEST)),
    }
    watched = {cause: watch(values[cause], effects, _LIMITS[cause]) for cause in CAUSES}
    changes = [
        Change(
            cause=cause,
            noticed=change.noticed,
            began=change.began,
            size=_size(values[cause], change.since, change.began, change.noticed),
            confirmed=change.confirmed,
        )
        for cause in CAUSES
        for change in watched[cause].changes
    ]
    return DriftChart(
        values=values,
        scores={cause: watched[cause].scores for cause in CAUSES},
        bands={cause: watched[cause].band for cause in CAUSES},
        changes=tuple(sorted(changes, key=lambda change: (change.noticed, change.began))),
    )


def known_effects(rows: Sequence[Mapping[str, Any]]) -> Array:
    """Circumstances of tests that are no change of the rig, shape (tests, effects): each about its median."""
    columns = [
        np.log(np.maximum([float(row["peak_mm"]) for row in rows], _SMALLEST)),
        np.log([float(row.get("f") or 1.0) for row in rows]),
    ]
    if rows and all(row.get("date") for row in rows):
        columns.append(warmth(places_in_day(str(row["date"])[:_DAY] for row in rows)))
    about = [np.clip(column - np.median(column), -_REACH, _REACH) for column in columns if column.size]
    effects = [column for column in about if np.ptp(column) > _VARIED] + _of_specimens(rows)
    return np.stack(effects, axis=1) if effects else np.zeros((len(rows), 0))


def _of_specimens(rows: Sequence[Mapping[str, Any]]) -> list[Array]:
    """One indicator for each of the specimens that had most tests, but the first one."""
    names = [str(row.get("specimen") or "") for row in rows]
    usual = sorted(set(names) - set(names[:1]), key=names.count, reverse=True)[:_MOST_SPECIMENS]
    return [np.array([float(name == specimen) for name in names]) for specimen in usual]


def _size(values: Array, since: int, began: int, noticed: int) -> float:
    return float(np.median(values[began : noticed + 1]) - np.median(values[since:began]))
