"""A spectrum averaged over bins of about equal width on a logarithmic axis."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def binned(frequency: Array, power: Array, bins: int) -> tuple[Array, Array, Array]:
    """Average a spectrum over bins.

    `frequency` [Hz]; returns [Hz].
    Returns mean frequency [Hz], mean power and number of frequencies of each bin that is not empty.

    >>> centre, mean, count = binned(np.array([1.0, 10.0, 11.0]), np.array([1.0, 2.0, 4.0]), 2)
    >>> centre.tolist(), mean.tolist(), count.tolist()
    ([1.0, 10.5], [1.0, 3.0], [1.0, 2.0])
    """
    edges = np.geomspace(frequency.min() * 0.999, frequency.max() * 1.001, bins + 1)
    place = np.digitize(frequency, edges) - 1
    count = np.bincount(place, minlength=bins).astype(np.float64)
    used = count > 0
    centre = np.bincount(place, frequency, minlength=bins)[used] / count[used]
    mean = np.bincount(place, power, minlength=bins)[used] / count[used]
    return centre, mean, count[used]
