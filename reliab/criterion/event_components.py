"""How much of the scatter lies between earthquakes, and how many motions that is worth."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array

_FEWEST_EFFECTIVE = 2.0


@dataclass(frozen=True, kw_only=True, eq=False)
class EventComponents:
    """Components of variance of values over motions, by analysis of variance."""

    # between, within: Variance between earthquakes and between motions of one earthquake
    between: Array
    within: Array
    # Number of independent motions that would leave the mean as uncertain
    effective_number: Array

    @property
    def event_share(self) -> Array:
        """Share of the variance that lies between earthquakes [-], the intraclass correlation."""
        total = self.between + self.within
        return np.asarray(self.between / np.where(total > 0.0, total, 1.0))


def event_components(values: Array, events: NDArray[np.str_]) -> EventComponents:
    """Divide the variance of values between and within earthquakes.

    Unbiased for any numbers of motions in the earthquakes; a negative variance between earthquakes
    counts as none. The share of the *variance of observed event means*, which includes what the
    motions themselves scatter, is larger and no measure of how alike motions of one earthquake are.
    With one earthquake, or one motion from each, the two cannot be separated, and the motions count as
    independent.

    `values` (motions, ...); `events` (motions,).

    Searle, S. R., Casella, G. and McCulloch, C. E. (1992). *Variance components*, section 3.6.

    >>> values = np.array([1.0, 1.2, 3.0, 3.2, 5.0, 5.2])
    >>> components = event_components(values, np.array(["a", "a", "b", "b", "c", "c"]))
    >>> float(components.event_share.round(3)), float(components.effective_number.round(1))
    (0.995, 3.0)
    """
    squares = SumsOfSquares.from_values(values, events)
    n = values.shape[0]
    if not squares.separate:
        inner = np.asarray(squares.total / (n - 1))
        return EventComponents(
            between=np.zeros_like(inner),
            within=inner,
            effective_number=np.full_like(inner, n),
        )
    inner = squares.within / squares.degrees_within
    outer = np.maximum((squares.between / squares.degrees_between - inner) / squares.mean_size, 0.0)
    inner = np.where(outer > 0.0, inner, squares.total / (n - 1))
    variance_of_mean = outer * squares.concentration + inner / n
    varies = variance_of_mean > 0.0  # equal values are worth as many motions as there are
    effective = np.where(varies, (outer + inner) / np.where(varies, variance_of_mean, 1.0), float(n))
    effective = np.maximum(effective, _FEWEST_EFFECTIVE)
    return EventComponents(
        between=np.asarray(outer),
        within=np.asarray(inner),
        effective_number=np.asarray(effective),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class SumsOfSquares:
    """Sums of squares of an analysis of variance by earthquake, of values of shape (motions, ...)."""

    between: Array  # Of the means of earthquakes about the mean of all motions, shape (...)
    within: Array  # Of motions about the means of their earthquakes
    degrees_between: int
    degrees_within: int
    mean_size: float  # Motions of an earthquake, as they count for the variance between earthquakes
    concentration: float  # Part of the variance between earthquakes in that of the mean of all motions

    @classmethod
    def from_values(cls, values: Array, events: NDArray[np.str_]) -> Self:
        """Divide the squares of values by the earthquakes of their motions."""
        _, group, sizes = np.unique(events, return_inverse=True, return_counts=True)
        n, k = values.shape[0], sizes.size
        deviation = values - values.mean(axis=0)
        sums = np.zeros((k, *values.shape[1:]))
        np.add.at(sums, group, deviation)
        between_squares = (sums**2 / sizes.reshape(-1, *(1,) * (values.ndim - 1))).sum(axis=0)
        concentration = float((sizes**2).sum()) / n**2
        return cls(
            between=np.asarray(between_squares),
            within=np.asarray((deviation**2).sum(axis=0) - between_squares),
            degrees_between=k - 1,
            degrees_within=n - k,
            mean_size=n * (1.0 - concentration) / max(k - 1, 1),
            concentration=concentration,
        )

    @property
    def separate(self) -> bool:
        """Whether the two can be told apart: several earthquakes, one of them with several motions."""
        return self.degrees_between > 0 and self.degrees_within > 0

    @property
    def total(self) -> Array:
        """Sum of the squares about the mean of all motions."""
        return np.asarray(self.between + self.within)
