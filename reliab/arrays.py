"""Types of the arrays that every room takes and returns."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""Real numbers in double precision."""

Spectrum: TypeAlias = NDArray[np.complex128]
"""Complex numbers in double precision."""
