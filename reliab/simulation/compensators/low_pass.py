"""The low-pass filter that adaptive compensators apply to both signals that they compare."""

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.errors import InputError


def butterworth_sections(order: int, cutoff: float, step: float) -> NDArray[np.float64]:
    """Second-order sections of a discrete Butterworth low-pass filter, b₀ b₁ b₂ a₁ a₂ of each.

    `cutoff` [Hz]; `step` [s].

    >>> sections = butterworth_sections(4, 20.0, 1 / 4096)
    >>> sections.size
    10
    """
    if not 0.0 < cutoff < 0.5 / step:
        raise InputError(
            "The filter's cutoff must be positive and below half of the sampling rate",
            value=f"{cutoff} Hz at {1.0 / step:g} Hz",
        )
    sections = scipy.signal.butter(order, cutoff, fs=1.0 / step, output="sos")
    return np.asarray(np.delete(sections, 3, axis=1).ravel())
