"""Divisions of the ground motions into those that are learned from and those that are judged.

Motions of one earthquake are alike, so that they are never divided: a motion is judged by what was
learned from other earthquakes only.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class Fold:
    """One division.

    Parameters
    ----------
    name : str
        What is judged.
    learned, judged : numpy.ndarray
        Which motions, boolean, shape (motions,); no motion and no earthquake is both.
    """

    name: str
    learned: NDArray[np.bool_]
    judged: NDArray[np.bool_]


def leave_one_event_out(events: NDArray[np.str_]) -> Iterator[Fold]:
    """Judge each earthquake by all others.

    Parameters
    ----------
    events : array of str, shape (motions,)
        Earthquake of each motion.

    Yields
    ------
    Fold
        One for each earthquake.
    """
    for event in _distinct(events, 2):
        judged = events == event
        yield Fold(name=str(event), learned=~judged, judged=judged)


def k_fold(events: NDArray[np.str_], folds: int, *, seed: int = 0) -> Iterator[Fold]:
    """Divide the earthquakes at random into groups and judge each group by the others.

    Parameters
    ----------
    events : array of str, shape (motions,)
        Earthquake of each motion.
    folds : int
        Number of groups.
    seed : int, optional
        Seed of the division.

    Yields
    ------
    Fold
        One for each group.
    """
    shuffled = np.random.default_rng(seed).permutation(_distinct(events, folds))
    for number, group in enumerate(np.array_split(shuffled, folds), start=1):
        judged = np.isin(events, group)
        yield Fold(name=f"group {number}", learned=~judged, judged=judged)


def random_halves(events: NDArray[np.str_], splits: int, *, seed: int = 0) -> Iterator[Fold]:
    """Learn from a random half of the earthquakes and judge the other, again and again.

    Parameters
    ----------
    events : array of str, shape (motions,)
        Earthquake of each motion.
    splits : int
        Number of divisions.
    seed : int, optional
        Seed of the divisions.

    Yields
    ------
    Fold
        One for each division.
    """
    distinct = _distinct(events, 4)
    rng = np.random.default_rng(seed)
    for number in range(1, splits + 1):
        chosen = rng.permutation(distinct)[: distinct.size // 2]
        learned = np.isin(events, chosen)
        yield Fold(name=f"half {number}", learned=learned, judged=~learned)


def _distinct(events: NDArray[np.str_], fewest: int) -> NDArray[np.str_]:
    distinct = np.unique(events)
    if distinct.size < fewest:
        raise InputError(
            f"This cross-validation needs at least {fewest} earthquakes",
            value=distinct.size,
            remedy="Use more motions, or fewer folds",
        )
    return distinct
