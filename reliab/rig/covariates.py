"""Under what a test is performed: numbers, groups whose tests are alike, and its place in time."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array

NEW = ""
"""A group of which nothing is known: its tests are like no others."""

_LENGTHS = (4.0, 40.0)
"""Tests over which the level of a rig wanders, quickly and slowly."""
_WARM = 3.0
"""Tests of a day after which a rig is warm."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Covariates:
    """Covariates of several tests, in the order of rows."""

    numbers: Mapping[str, Array] = field(default_factory=dict)  # Covariates by name
    groups: Mapping[str, NDArray[np.str_]] = field(default_factory=dict)  # Names by kind of group
    place: Array | None = None  # Place in the order of tests; None where their order means nothing

    def __len__(self) -> int:
        """Count the tests."""
        numbers = [*self.numbers.values(), *(() if self.place is None else (self.place,))]
        return max((len(values) for values in (*numbers, *self.groups.values())), default=0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Kernels:
    """How alike tests are in each respect: what learned tests span, and how other tests relate to them."""

    training: Covariates
    centres: Mapping[str, tuple[float, float]]  # Centre and spread of each covariate that varies
    respects: tuple[str, ...]

    @classmethod
    def among(cls, learned: Covariates, count: int) -> "Kernels":
        """Find in which respects tests differ so that something can be learned of it."""
        centres = {
            name: (float(np.mean(values)), float(np.std(values)))
            for name, values in learned.numbers.items()
            if np.ptp(values) > 1e-9 * (1.0 + np.abs(values).max())
        }
        respects = [f"covariate {name}" for name in centres]
        for kind, names in learned.groups.items():
            sizes = np.unique(names[names != NEW], return_counts=True)[1]
            if sizes.size > 1 and (sizes > 1).any():
                respects.append(kind)
        if learned.place is not None and count > 2 * _LENGTHS[0]:
            respects += [f"time {length:g}" for length in _LENGTHS if count > 2 * length]
        return cls(training=learned, centres=centres, respects=tuple(respects))

    def among_learned(self) -> Array:
        """One matrix for each respect, shape (respects, learned, learned)."""
        return self.covariances(self.training)

    def covariances(self, targets: Covariates) -> Array:
        """One matrix for each respect, shape (respects, others, learned)."""
        matrices = np.zeros((len(self.respects), len(targets), len(self.training)))
        for matrix, respect in zip(matrices, self.respects, strict=True):
            matrix[:] = self._is_shared(respect, targets, self.training)
        return matrices

    def prior_variances(self, targets: Covariates) -> list[Array]:
        """Kernel of each other test with itself, shape (others,) for each respect."""
        units = np.ones(len(targets))
        return [
            1.0 + self._standard(respect, targets) ** 2 if respect.startswith("covariate ") else units
            for respect in self.respects
        ]

    def _is_shared(self, respect: str, targets: Covariates, training: Covariates) -> Array:
        kind, _, name = respect.partition(" ")
        if kind == "covariate":
            here, there = self._standard(respect, targets)[:, None], self._standard(respect, training)
            return np.asarray(here * there + np.exp(-0.5 * (here - there) ** 2))
        if kind == "time" and targets.place is not None and training.place is not None:
            return np.asarray(np.exp(-np.abs(targets.place[:, None] - training.place) / float(name)))
        names = targets.groups[kind][:, None]
        return np.asarray((names == training.groups[kind]) & (names != NEW), dtype=np.float64)

    def _standard(self, respect: str, covariates: Covariates) -> Array:
        name = respect.removeprefix("covariate ")
        centre, spread = self.centres[name]
        return np.asarray(np.clip((covariates.numbers[name] - centre) / spread, -4.0, 4.0))


def warmth(places_in_day: Array) -> Array:
    """How cold a rig still is at the first, second, … test of a day.

    >>> warmth(np.array([0.0, 3.0])).round(2)
    array([1.  , 0.37])
    """
    return np.asarray(np.exp(-places_in_day / _WARM))


def places_in_day(days: Iterable[str]) -> Array:
    """How many tests of the same day were before each test.

    >>> places_in_day(["2026-03-01", "2026-03-01", "2026-03-02"])
    array([0., 1., 0.])
    """
    counts: dict[str, int] = {}
    places = []
    for day in days:
        places.append(counts.get(day, 0))
        counts[day] = places[-1] + 1
    return np.array(places, dtype=np.float64)
