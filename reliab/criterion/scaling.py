"""Dimensionless ellipse parameters, in which structures look alike.

Near resonance the error of a test depends on the complex actuator error over the damping alone. To first
order the ellipse is therefore a = α ξ², b = β (ξ/ω₀)², with α and β depending on how long and how
broad-band the motion is, and hardly on the structure.
"""

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.vocabulary import MILLI


def scales(frequency: ArrayLike, damping_ratio: ArrayLike) -> tuple[Array, Array]:
    """Ellipse parameters of a structure for α = β = 1.

    `frequency`, `damping_ratio`: structures [Hz, -], broadcast against each other. Returns ξ² [-] and (ξ/ω₀)²
    [ms²].

    >>> a, b = scales(1.0, 0.02)
    >>> round(float(a), 6), round(float(b), 3)
    (0.0004, 10.132)
    """
    f, xi = np.broadcast_arrays(
        np.asarray(frequency, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
    )
    return xi**2, MILLI**2 * (xi / (2.0 * np.pi * f)) ** 2
