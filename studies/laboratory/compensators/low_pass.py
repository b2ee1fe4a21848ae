"""The low-pass filter that adaptive compensators apply to the two signals that they compare."""

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.effects.kernel import Numbers


def butterworth_sections(order: int, cutoff: float, step: float) -> Array:
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


SECTIONS = 2
"""Second-order sections of the filter: one of order four."""


@compiled
def filter_two(
    sent: float, measured: float, state: Numbers, memory: int, coefficients: Numbers, first: int
) -> tuple[float, float]:
    """Filter the command that was sent and the measurement alike, so that both are delayed equally.

    `sent`, `measured` [m]; returns [m].
    """
    u, y = sent, measured
    for section in range(SECTIONS):
        at, place = first + 5 * section, memory + 2 * section
        b0, b1, b2 = coefficients[at], coefficients[at + 1], coefficients[at + 2]
        a1, a2 = coefficients[at + 3], coefficients[at + 4]
        filtered = b0 * u + state[place]
        state[place] = b1 * u - a1 * filtered + state[place + 1]
        state[place + 1] = b2 * u - a2 * filtered
        u = filtered
        filtered = b0 * y + state[place + 4]
        state[place + 4] = b1 * y - a1 * filtered + state[place + 5]
        state[place + 5] = b2 * y - a2 * filtered
        y = filtered
    return u, y
