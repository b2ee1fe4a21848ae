"""Which of the motions that are judged lie outside of those from which their criterion was learned."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from reliab.api.judged_motions import Division
from reliab.criterion import Position, compare_with_scope, magnitudes_of, scope_of
from reliab.significant import significant
from reliab.validation.cross_validation import Fold

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
