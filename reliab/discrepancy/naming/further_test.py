"""The error to expect of a model on a further test of the same kind."""

import numpy as np
from scipy import stats

from reliab.discrepancy.fitting.left_out import LeftOut
from reliab.discrepancy.result.gap import FurtherError

_FEWEST = 3
_TAILS = 0.05


def expected_error(errors: LeftOut) -> FurtherError | None:
    """Interval of the error on a further test, from those on tests that were left out.

    The logarithms of the errors are taken for draws from one normal distribution, of which the further test
    is another draw; the interval is Student's prediction interval.

    >>> whole, every = np.full(3, 100.0), np.ones(3, dtype=bool)
    >>> errors = LeftOut(energies=np.array([1.0, 4.0, 2.0]), signals=whole, units=np.ones(3), foretold=every)
    >>> further = expected_error(errors)
    >>> round(further.value, 3), round(further.low, 3), round(further.high, 3)
    (0.141, 0.044, 0.455)
    """
    logarithms = 0.5 * np.log(np.maximum(errors.energies, 1e-300) / np.maximum(errors.signals, 1e-300))
    count = logarithms.size
    if count < _FEWEST:
        return None
    spread = float(logarithms.std(ddof=1)) * np.sqrt(1.0 + 1.0 / count)
    reach = float(stats.t.isf(_TAILS, count - 1)) * spread
    middle = float(logarithms.mean())
    low, high = np.exp(middle - reach), np.exp(middle + reach)
    return FurtherError(value=float(np.exp(middle)), low=float(low), high=float(high), tests=count)
