"""How much of the scatter lies between earthquakes, and how many motions that is worth."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array

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
    _, group, sizes = np.unique(events, return_inverse=True, return_counts=True)
    n, k = values.shape[0], sizes.size
    deviation = values - values.mean(axis=0)
    total = (deviation**2).sum(axis=0)
    if k in (1, n):
        within = np.asarray(total / (n - 1))
        return EventComponents(
            between=np.zeros_like(within), within=within, effective_number=np.full_like(within, n)
        )
    sums = np.zeros((k, *values.shape[1:]))
    np.add.at(sums, group, deviation)
    weights = sizes.reshape(-1, *(1,) * (values.ndim - 1))
    explained = (sums**2 / weights).sum(axis=0)
    within = (total - explained) / (n - k)
    mean_size = (n - (sizes**2).sum() / n) / (k - 1)
    between = np.maximum((explained / (k - 1) - within) / mean_size, 0.0)
    within = np.where(between > 0.0, within, total / (n - 1))
    variance_of_mean = between * (sizes**2).sum() / n**2 + within / n
    varied = variance_of_mean > 0.0  # equal values are worth as many motions as there are
    effective = np.where(varied, (between + within) / np.where(varied, variance_of_mean, 1.0), float(n))
    effective = np.maximum(effective, _FEWEST_EFFECTIVE)
    return EventComponents(
        between=np.asarray(between), within=np.asarray(within), effective_number=np.asarray(effective)
    )
