"""A published table of ellipse parameters as measured data: what explains the rows that disagree.

A difference must explain a and b together. With many candidates, some do so by chance. The candidates of a
row are therefore compared with the pairs of all other earthquakes, printed and simulated, too; the share of
these that they explain as well, times the number of explanations that are tried, is the probability that an
explanation is due to chance. Time step and duration belong to a recording: where both of its components
disagree, one value must explain both.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import permutations
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from reliab_studies.paper2017.printed import CLOSE, ONE_HERTZ, TWO_PERCENT

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.progress import Progress, silent
from reliab.core.significant_digits import percent
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.tracking.boundary.curves import Ellipse

from .hidden_difference import Difference, differences, logarithms, simulate_ellipse

LARGEST_CHANCE = 0.05
"""Probability of an explanation by chance from which no name is given."""

NONE_FOUND = "none found"
"""Name for a row that no difference explains."""

_STRUCTURE = Structure(frequency=ONE_HERTZ, damping_ratio=TWO_PERCENT)
_CLOSE_QUANTILE = 0.9
_FEWEST_AGREEING = 5


def audit_table2(
    suite: Sequence[Motion], printed: pd.DataFrame, *, progress: Progress = silent
) -> pd.DataFrame:
    """Find hidden differences between the paper's Table 2 and a simulation of its records.

    `printed`: columns `record`, `a` [-], `b` [ms²] and `error` [ms⁴], for 1 Hz, 2 % damping and 5 % RMS^R.
    Result: one row each of the printed records that the suite has: `record`, `a_printed`, `b_printed`, `a`,
    `b` of our simulation, `error_printed` and `error` of equation (10) [ms⁴], `gap_before` (larger of |ln
    a/a_printed| and |ln b/b_printed|), `agrees` (a and b are within 10 % of the printed numbers),
    `difference` ("", "time step", "duration", "component" or "none found"), `detail`, `a_after`, `b_after`,
    `gap_after`, and `chance`, the probability that an explanation as good is due to chance.
    """
    by_name = {motion.name: motion for motion in suite}
    rows = printed[printed["record"].isin(list(by_name))].reset_index(drop=True)
    motions = [by_name[name] for name in rows["record"]]
    if len(rows) <= _FEWEST_AGREEING:
        raise InputError(
            "The suite must hold records of the table, under its names",
            value=f"{len(rows)} of {len(printed)}",
            remedy="Give the folder of the paper's records with `motions`",
        )
    values = np.log(rows[["a", "b"]].to_numpy(dtype=np.float64))
    ellipses = [simulate_ellipse(motion.acceleration, motion.time_step, _STRUCTURE) for motion in motions]
    table = _Table(motions=motions, printed=values, ellipses=ellipses)
    explanations = []
    for row in range(len(motions)):
        explanations.append(table.explained(row))
        progress(row + 1, len(motions))
    errors = pd.DataFrame({"error_printed": rows["error"], "error": [ellipse.sse for ellipse in ellipses]})
    return pd.concat([pd.DataFrame(explanations), errors], axis="columns")


class _Offer(NamedTuple):
    """An explanation: probability that it is due to chance, what it leaves, which choice of which kind."""

    chance: float
    distance: float
    place: int
    kind: str


@dataclass(frozen=True, kw_only=True, eq=False)
class _Table:
    """Records with the printed logarithms of a and b, shape (rows, 2), and our ellipses."""

    motions: Sequence[Motion]
    printed: Array
    ellipses: Sequence[Ellipse]
    worked_out: dict[int, dict[str, Difference]] = field(default_factory=dict)

    @cached_property
    def ours(self) -> Array:
        """Our logarithms of a and b, shape (rows, 2)."""
        return np.array([logarithms(ellipse) for ellipse in self.ellipses])

    @cached_property
    def agreeing(self) -> NDArray[np.bool_]:
        """Whether a and b of a row are within 10 % of the printed numbers, shape (rows,)."""
        ratios = np.exp(self.ours - self.printed)
        return np.asarray((np.abs(ratios - 1.0) <= CLOSE).all(axis=1))

    @cached_property
    def gaps(self) -> Array:
        """Larger of the differences of ln a and ln b, shape (rows,); infinite where we have no ellipse."""
        return np.asarray(np.nan_to_num(np.abs(self.ours - self.printed).max(axis=1), nan=np.inf))

    @cached_property
    def close(self) -> float:
        """How closely agreeing rows agree; an explanation must fit as closely."""
        agreeing = self.gaps[self.agreeing]
        if agreeing.size < _FEWEST_AGREEING:
            raise InputError(
                f"At least {_FEWEST_AGREEING} rows must agree, to know how closely an explanation must fit",
                value=agreeing.size,
                remedy="Check the records' time steps and units",
            )
        return float(np.quantile(agreeing, _CLOSE_QUANTILE))

    @cached_property
    def steps(self) -> list[float]:
        """Time steps of the records [s], each once to four digits."""
        return sorted({float(f"{motion.time_step:.4g}") for motion in self.motions})

    @cached_property
    def recordings(self) -> list[tuple[int, ...]]:
        """Rows of the components of each recording, known by event, time step and length."""
        rows_of: dict[object, list[int]] = {}
        for row, motion in enumerate(self.motions):
            key = (motion.event, motion.time_step, motion.acceleration.size)
            rows_of.setdefault(key, []).append(row)
        return [tuple(rows) for rows in rows_of.values()]

    def _recording(self, row: int) -> tuple[int, ...]:
        return next(rows for rows in self.recordings if row in rows)

    def explained(self, row: int) -> dict[str, object]:
        """Compare a row and explain it if it disagrees."""
        agrees = bool(self.agreeing[row])
        (a_printed, b_printed), (a, b) = np.exp(self.printed[row]).tolist(), np.exp(self.ours[row]).tolist()
        compared = {"record": self.motions[row].name, "a_printed": a_printed, "b_printed": b_printed}
        compared |= {"a": a, "b": b, "gap_before": float(self.gaps[row]), "agrees": agrees}
        unchanged = {"a_after": a, "b_after": b, "gap_after": float(self.gaps[row])}
        if agrees:
            return compared | {"difference": "", "detail": "", "chance": np.nan} | unchanged
        best = self._best(row)
        if best is None:
            return compared | {"difference": NONE_FOUND, "detail": "", "chance": np.nan} | unchanged
        result = self._result(row, best)
        if best.distance <= self.close and best.chance <= LARGEST_CHANCE:
            return compared | result
        nearest = (
            f"nearest: {best.kind}, {result['detail']}, which leaves {percent(best.distance, decimals=0)}"
        )
        return compared | {"difference": NONE_FOUND, "detail": nearest, "chance": best.chance} | unchanged

    def _best(self, row: int) -> "_Offer | None":
        """Explain a row: with all of its recording that disagrees, unless a component was swapped."""
        together = tuple(member for member in self._recording(row) if not self.agreeing[member])
        kinds = list(self._differences(row))
        tried = [((row,) if kind == "component" else together, kind) for kind in kinds]
        offers = [self._offer(rows, kind, len(tried)) for rows, kind in tried]
        fitting = [offer for offer in offers if offer.distance <= self.close]
        return min(fitting or offers, default=None)

    def _offer(self, rows: tuple[int, ...], kind: str, trials: int) -> "_Offer":
        """Explain rows by a kind of difference; unrelated pairs show how often chance does so."""
        distance, place = self._nearest(rows, kind, self.printed[list(rows)])
        event = self.motions[rows[0]].event
        unrelated = [
            table[list(order)]
            for recording in self.recordings
            if self.motions[recording[0]].event != event
            for order in permutations(recording, len(rows))
            for table in (self.printed, self.ours)
        ]
        hits = sum(self._nearest(rows, kind, pairs)[0] <= distance for pairs in unrelated)
        chance = min(1.0, trials * (1.0 + hits) / (1.0 + len(unrelated)))
        return _Offer(chance=chance, distance=distance, place=place, kind=kind)

    def _result(self, row: int, best: "_Offer") -> dict[str, object]:
        difference = self._differences(row)[best.kind]
        a, b = np.exp(difference.pairs[best.place]).tolist()
        gap = float(difference.distances(self.printed[row])[best.place])
        result = {"difference": best.kind, "detail": difference.details[best.place], "chance": best.chance}
        return result | {"a_after": a, "b_after": b, "gap_after": gap}

    def _differences(self, row: int) -> dict[str, Difference]:
        if row not in self.worked_out:
            siblings = [self.motions[member] for member in self._recording(row) if member != row]
            kinds = differences(self.motions[row], siblings, self.steps, _STRUCTURE)
            self.worked_out[row] = {difference.kind: difference for difference in kinds}
        return self.worked_out[row]

    def _nearest(self, rows: tuple[int, ...], kind: str, pairs: Array) -> tuple[float, int]:
        """Distance and place of the choice that best explains pairs of logarithms, as if of the rows."""
        of_rows = [
            self._differences(row)[kind].distances(pair) for row, pair in zip(rows, pairs, strict=True)
        ]
        distances = np.nan_to_num(np.max(of_rows, axis=0), nan=np.inf)
        place = int(np.argmin(distances))
        return float(distances[place]), place
