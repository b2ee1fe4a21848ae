"""Numbers such as -999 that mark missing samples, though nothing in a file says so."""

import numpy as np

from reliab.core.arrays import Array

_USUAL_MARKS = frozenset(
    [*(float("9" * digits) for digits in range(3, 8)), 999.25, 999.9, 999.99, 32767.0, 32768.0]
)
_LARGEST_NUMBER = 1e10  # from which a number marks gaps: 1e20, 9.97e36 of netCDF, 1.7e38 of SMC
_STANDING_OUT = 1.5  # times the largest deviation of the others, from which a usual mark is one
_FAR_OUT = 3.0  # times the largest deviation of the others, from which any repeated number is a mark
_REPEATED = 3  # times that a mark is repeated exactly
_VARIED = 10  # fewest different numbers of a history


def missing_mark(values: Array, *, any_repeated: bool = False) -> float | None:
    """Find the number that marks gaps in a history, shape (n,); None where none does.

    `any_repeated`: whether an outlier of any size that is repeated exactly is a mark.

    >>> history = np.sin(np.arange(100.0))
    >>> history[20:30] = -9999.0
    >>> missing_mark(history)
    -9999.0
    """
    deviations = np.abs(values - np.median(values))
    mark = float(values[deviations.argmax()])
    is_usual = abs(mark) in _USUAL_MARKS or abs(mark) >= _LARGEST_NUMBER
    if not (is_usual or any_repeated):
        return None
    others = deviations[values != mark]
    if not others.size or deviations.max() <= _STANDING_OUT * others.max():
        return None
    is_repeated = values.size - others.size >= _REPEATED and deviations.max() > _FAR_OUT * others.max()
    return mark if (is_usual or is_repeated) and np.unique(values).size >= _VARIED else None
