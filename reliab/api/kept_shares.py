"""Sentences on a validation: whether shares are kept, and which motions lie outside of what was learned."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.api.judged_motions import Division
from reliab.criterion import Position, compare_with_scope, magnitudes_of, scope_of
from reliab.significant import percent, significant
from reliab.validation.cross_validation import Fold


def kept_shares(
    rows: Sequence[Mapping[str, Any]], of_side: str = "", whose: str = "the motions"
) -> Iterator[str]:
    """Say of each method and law whether the share that it states is kept, and by which motions.

    >>> rate = {"rate": 0.52, "low": 0.41, "high": 0.63}
    >>> rows = [{"candidate": "power", "confidence": 0.95, "containment": rate}]
    >>> print(*kept_shares(rows))
    power does not keep the share that it states: it protects 52.0 % of the motions where it states 95 %.
    """
    for candidate in dict.fromkeys(row["candidate"] for row in rows):
        judged = [
            (row["containment"], row["confidence"])
            for row in rows
            if row["candidate"] == candidate and row["containment"]["rate"] is not None
        ]
        if not judged:
            continue
        shares = ", ".join(
            f"{percent(rate['rate'], decimals=1)} where it states {percent(stated, decimals=0)}"
            for rate, stated in judged
        )
        first, *others = shares.split(" where", 1)
        yield f"{candidate} {_keeps(judged)}{of_side}: it protects {first} of {whose} where{others[0]}."


def _keeps(judged: Sequence[tuple[Mapping[str, Any], float]]) -> str:
    """Whether shares are kept, as far as their intervals can tell."""
    below = [(rate, stated) for rate, stated in judged if rate["rate"] < stated]
    broken = [
        percent(stated, decimals=0) for rate, stated in below if (rate["high"] or rate["rate"]) < stated
    ]
    if broken:
        at = f" at {', '.join(broken)}" if len(judged) > 1 else ""
        return f"does not keep the share that it states{at}"
    if below:
        return "may keep the share that it states, as far as so few motions can tell"
    return "keeps the share that it states"


_UNITS = {"magnitude": "", "length": " s"}


def sentences_of_outside(ellipses: xr.Dataset, division: Division) -> Iterator[str]:
    """Say of each division which of its motions no promise is made for, by their length and magnitude.

    `ellipses`: of the motions that are judged, with their lengths where they are known.
    """
    learned_from = ellipses if division.learn_from is None else division.learn_from
    known = _quantities(ellipses)
    for name, quantity in product(dict.fromkeys(map(_group, division.folds)), known):
        judged: list[float] = []
        outside: list[float] = []
        ends: list[float] = []
        for fold in division.folds:
            scope = scope_of(learned_from.isel(motion=fold.learned)) if _group(fold) == name else {}
            if quantity in scope and fold.judged.any():
                values = known[quantity][fold.judged].tolist()
                judged += values
                ends += [scope[quantity][0], scope[quantity][-1]]
                outside += [value for value in values if _is_outside(scope, quantity, value)]
        if outside:
            unit = _UNITS[quantity]
            yield (
                f"Outside of the population: {len(outside)} of the {len(judged)} motions of {name}, of "
                f"{quantity} {_range(outside)}{unit}; the motions from which their criterion is learned have "
                f"{_range(ends)}{unit}. The criterion makes no promise for motions outside."
            )


def motions_outside(ellipses: xr.Dataset, division: Division) -> NDArray[np.bool_]:
    """Which motions lie outside of those from which a criterion that judges them is learned, (motions,)."""
    learned_from = ellipses if division.learn_from is None else division.learn_from
    known = _quantities(ellipses)
    outside = np.zeros(ellipses.sizes["motion"], dtype=np.bool_)
    for fold in division.folds:
        scope = scope_of(learned_from.isel(motion=fold.learned))
        for quantity, values in known.items():
            beyond = [_is_outside(scope, quantity, float(value)) for value in values]
            outside |= fold.judged & np.array(beyond, dtype=np.bool_)
    return outside


def _group(fold: Fold) -> str:
    """Name of what a division judges, whichever structures or earthquakes it leaves out beside."""
    return fold.name.partition(", ")[0]


def _is_outside(scope: Mapping[str, Sequence[float]], quantity: str, value: float) -> bool:
    return compare_with_scope(scope, {quantity: value}).position is Position.OUTSIDE


def _quantities(ellipses: xr.Dataset) -> dict[str, np.ndarray]:
    """Length [s] and magnitude of each motion, shape (motions,), as far as they are known."""
    quantities = {}
    if "duration" in ellipses.coords:
        quantities["length"] = ellipses["duration"].values.astype(np.float64)
    if (magnitudes := magnitudes_of(ellipses["event"].values.tolist())) is not None:
        quantities["magnitude"] = np.array(magnitudes)
    return quantities


def _range(values: Sequence[float]) -> str:
    ends = [significant(end(values)) for end in (min, max)]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
