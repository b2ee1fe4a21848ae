"""Values that stand for several samples: those of a slower clock in the rows of a faster one."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array

_FEWEST: Final = 50  # changes from which the clock of a channel is known
_CLEAR: Final = 4.0  # smallest changes of a change that no rounding makes after a repeated value
_SHARE: Final = 0.75  # of the clear changes, before which a value was repeated
_LONGEST: Final = 0.1  # s that a value stands; what stands longer is a step of the test
_MOST_PHASES: Final = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class Hold:
    """The samples at which a channel takes a new value."""

    places: NDArray[np.intp]  # shape (k,)
    length: float  # samples that a value stands, on average
    # samples by which a value came on average before the row that shows it first, where the clocks have no
    # whole ratio
    lateness: float


def find_hold(values: Array, time_step: float) -> Hold | None:
    """Find that a history, shape (n,), holds each value for several samples; None where it does not.

    Rounding repeats values only where the history hardly moves, and the next change is small.

    >>> time = np.arange(4000) / 1000.0
    >>> hold = find_hold(np.repeat(np.sin(6.0 * time[::8]), 8), 1e-3)
    >>> (hold.length, hold.places[:3].tolist()), find_hold(np.sin(6.0 * time).round(2), 1e-3)
    ((8.0, [0, 8, 16]), None)
    """
    sizes = np.abs(np.diff(values))
    changes = np.flatnonzero(sizes) + 1
    if changes.size < _FEWEST:
        return None
    clear = sizes[changes - 1] >= _CLEAR * sizes[changes - 1].min()
    lengths = np.diff(changes, prepend=0)[clear]
    if lengths.size < _FEWEST or (lengths > 1).mean() < _SHARE:
        return None
    usual = round(float(np.median(lengths)))
    if usual * time_step > _LONGEST:
        return None
    length = float(lengths[lengths <= usual + 1].mean())
    phases = Fraction(length).limit_denominator(_MOST_PHASES).denominator
    bounds = np.concatenate([[0], changes, [values.size]])
    samples = np.arange(values.size)
    stretch = np.searchsorted(bounds, samples, side="right")
    samples_in_stretch, remaining = samples - bounds[stretch - 1], bounds[stretch] - samples
    is_new = (samples_in_stretch == 0) | (
        (samples_in_stretch % usual == 0) & (remaining >= usual)
    )  # a value may come again
    return Hold(places=np.flatnonzero(is_new), length=length, lateness=0.5 * (1.0 - 1.0 / phases))
