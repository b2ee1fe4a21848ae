"""Divisions of the ground motions into those that are learned from and those that are judged.

Motions of one earthquake are similar, so that they are never divided: a motion is judged only by criteria
learned from other earthquakes. `SCHEMES` lists the divisions by the names that studies and commands use.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.errors import InputError
from reliab.criterion.scope import magnitudes_of, regions_of


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """One division."""

    name: str  # What is judged
    # learned, judged: Which motions, boolean, shape (motions,); no earthquake is both. Where another suite is
    # learned from, the first is about the motions of that suite
    learned: NDArray[np.bool_]
    judged: NDArray[np.bool_]
    # A dimension, "f" or "xi", and its value that is judged but not learned from; by default all structures
    # are learned from and judged
    left_out: tuple[str, float] | None = None

    def judges(self, frequency: float, damping_ratio: float) -> bool:
        """Whether a structure [Hz, -] is judged."""
        if self.left_out is None:
            return True
        dimension, value = self.left_out
        return value == (frequency if dimension == "f" else damping_ratio)


def leave_one_event_out(events: NDArray[np.str_]) -> Iterator[Fold]:
    """Judge each earthquake by all others.

    `events` (motions,).
    """
    for event in _distinct(events, 2):
        is_judged = events == event
        yield Fold(name=str(event), learned=~is_judged, judged=is_judged)


def k_fold(events: NDArray[np.str_], folds: int, *, seed: int = 0) -> Iterator[Fold]:
    """Divide the earthquakes at random into groups and judge each group by the others.

    `events` (motions,).
    """
    random_order = np.random.default_rng(seed).permutation(_distinct(events, folds))
    for number, group in enumerate(np.array_split(random_order, folds), start=1):
        is_judged = np.isin(events, group)
        yield Fold(name=f"group {number}", learned=~is_judged, judged=is_judged)


def random_halves(events: NDArray[np.str_], splits: int, *, seed: int = 0) -> Iterator[Fold]:
    """Learn from a random half of the earthquakes and judge the other, again and again.

    `events` (motions,).
    """
    distinct = _distinct(events, 4)
    rng = np.random.default_rng(seed)
    for number in range(1, splits + 1):
        training_events = rng.permutation(distinct)[: distinct.size // 2]
        is_learned = np.isin(events, training_events)
        yield Fold(name=f"half {number}", learned=is_learned, judged=~is_learned)


def leave_structures_out(folds: Iterable[Fold], dimension: str, values: Sequence[float]) -> Iterator[Fold]:
    """Leave out one frequency, or one damping ratio, in addition to the motions of each fold."""
    for fold in folds:
        for value in values:
            yield replace(fold, name=f"{fold.name}, {dimension} = {value:g}", left_out=(dimension, value))


def transfer(
    sets: NDArray[np.str_], events: NDArray[np.str_], *, learned: Sequence[str], judged: Sequence[str]
) -> Iterator[Fold]:
    """Learn from some sets of motions and judge others, never by motions of the same earthquake.

    `sets`, `events` (motions,).
    """
    unknown = sorted({*learned, *judged} - set(sets.tolist()))
    if unknown:
        raise InputError(
            "The motions have no such set",
            value=unknown[0],
            remedy=f"Choose among {', '.join(choices)}"
            if (choices := sorted(set(sets.tolist()) - {""}))
            else "State sets in the column set of a catalogue",
        )
    is_training, these = np.isin(sets, learned), np.isin(sets, judged)
    shared = np.isin(events, events[is_training])
    if (these & ~shared).any():
        yield Fold(name="other earthquakes", learned=is_training, judged=these & ~shared)
    for event in np.unique(events[these & shared]):
        is_event = events == event
        yield Fold(name=str(event), learned=is_training & ~is_event, judged=these & is_event)


def from_another(training_names: Sequence[str | None], events: NDArray[np.str_]) -> Iterator[Fold]:
    """Learn from another suite and judge all motions of this one, never by motions of the same earthquake.

    `events` (motions of the other suite,).
    """
    names = np.array([name or "" for name in training_names], dtype=np.str_)
    for name in np.unique(names):
        is_learned = events != name if name else np.ones(events.size, dtype=np.bool_)
        yield Fold(name=str(name) or "other earthquakes", learned=is_learned, judged=names == name)


def _distinct(events: NDArray[np.str_], fewest: int) -> NDArray[np.str_]:
    distinct = np.unique(events)
    if distinct.size < fewest:
        raise InputError(
            f"Too few earthquakes: this cross-validation needs {fewest}",
            value=distinct.size,
            remedy="Use more motions, or fewer folds",
        )
    return distinct


GROUPS: Final = 5
"""Groups of earthquakes of the scheme k_fold."""

SPLITS: Final = 20
"""Divisions of the scheme random_halves."""

SCHEMES: Final[Mapping[str, Callable[[NDArray[np.str_]], Iterator[Fold]]]] = {
    "leave_one_event_out": leave_one_event_out,
    "k_fold": lambda events: k_fold(events, GROUPS),
    "random_halves": lambda events: random_halves(events, SPLITS),
}
"""Every scheme by its name; each takes the earthquakes of the motions."""


GROUP_SCHEMES: Final = ("region", "magnitude", "length")
"""Schemes that leave out whole groups of motions."""

_MAGNITUDES: Final = (6.6, 7.0, 7.3)  # between classes
_LENGTHS: Final = (25.0, 40.0, 60.0)  # [s]


def leave_groups_out(groups: NDArray[np.str_], events: NDArray[np.str_]) -> Iterator[Fold]:
    """Judge each group of motions by the others, never by motions of the same earthquake.

    `groups`, `events` (motions,).
    """
    names = _distinct(groups, 2).tolist()
    for name in names:
        other_names = [other_name for other_name in names if other_name != name]
        for fold in transfer(groups, events, learned=other_names, judged=[name]):
            if fold.learned.any():
                yield replace(fold, name=f"{name}, {fold.name}")


def _groups(scheme: str, events: NDArray[np.str_], lengths: NDArray[np.float64] | None) -> NDArray[np.str_]:
    """Region, class of magnitude or class of length of each motion."""
    names = events.tolist()
    if scheme == "length" and lengths is not None:
        return _classes(lengths, _LENGTHS, " s")
    magnitudes, regions = magnitudes_of(names), regions_of(names)
    if scheme == "length" or magnitudes is None or regions is None:
        raise InputError(
            f"The {scheme} of some motions is not known",
            value="motions without lengths" if scheme == "length" else ", ".join(sorted(set(names))[:3]),
            remedy="Choose leave_one_event_out, or judge real_suite, whose earthquakes are known",
        )
    if scheme == "region":
        return np.array(regions, dtype=np.str_)
    return _classes(np.array(magnitudes), _MAGNITUDES, "")


def _classes(values: NDArray[np.float64], edges: Sequence[float], unit: str) -> NDArray[np.str_]:
    """Names of the classes between edges; a value on an edge belongs below it."""
    inner = [f"{low:g} to {high:g}{unit}" for low, high in pairwise(edges)]
    names = [f"up to {edges[0]:g}{unit}", *inner, f"above {edges[-1]:g}{unit}"]
    return np.array(names, dtype=np.str_)[np.digitize(values, edges, right=True)]


def folds_of(scheme: str, events: NDArray[np.str_], lengths: NDArray[np.float64] | None = None) -> list[Fold]:
    """Divide motions.

    `events` (motions,), `lengths` [s] (motions,), which the scheme length needs.

    >>> len(folds_of("leave_one_event_out", np.array(["K", "K", "L", "M"])))
    3
    """
    if scheme in GROUP_SCHEMES:
        return list(leave_groups_out(_groups(scheme, events, lengths), events))
    if scheme not in SCHEMES:
        raise InputError(
            "Unknown scheme",
            value=scheme,
            remedy=f"Choose among {', '.join((*SCHEMES, *GROUP_SCHEMES))}",
        )
    return list(SCHEMES[scheme](events))
