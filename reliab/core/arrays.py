"""Types of the arrays that every room takes and returns, and arrays that nobody may change."""

from typing import Any, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Real numbers in double precision."""

Spectrum: TypeAlias = NDArray[np.complex128]
"""Complex numbers in double precision."""

_AnyArray = TypeVar("_AnyArray", bound=NDArray[Any])


def read_only(array: _AnyArray) -> _AnyArray:
    """View of an array that kernels take as one type, whether its owner may change it or not.

    >>> import numpy as np
    >>> read_only(np.zeros(3)).flags.writeable
    False
    """
    view = array.view()
    view.flags.writeable = False
    return view
