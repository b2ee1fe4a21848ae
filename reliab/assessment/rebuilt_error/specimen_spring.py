"""The specimen's spring, and how late its displacement was recorded against its force.

A linear specimen's force is f = k x + c x'. Where the displacement was recorded late by s against the force,
x(t) = x_r(t + s), the force is k x_r + k s x_r' to first order. Thus c/k is a time, and whether it is a skew
between the two channels, a dashpot in the specimen or a force that comes late (c/k < 0), they cannot tell.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.kernel import Kernel, fit_equation

_CLEAR = 10.0  # standard errors: a stiffness that is less certain is none


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A specimen's spring by its recorded force."""

    # stiffness, stiffness_deviation: k with its standard error, in units of force over metres
    stiffness: float
    stiffness_deviation: float
    # late, late_deviation: c/k with its standard error [s]: time by which the displacement was recorded later
    # than the force
    late: float
    late_deviation: float


def fit_spring(measured: Array, force: Array, kernel: Kernel) -> Spring:
    """Fit k and c to a recorded force.

    `measured` [m].

    >>> time = np.arange(0.0, 30.0, 0.005)
    >>> force = 40.0 * np.sin(6.0 * time) * np.sin(0.1 * time)
    >>> recorded = np.sin(6.0 * (time - 0.002)) * np.sin(0.1 * (time - 0.002))
    >>> spring = fit_spring(recorded, force, Kernel.of_frequency(1.0, 0.005))
    >>> round(spring.stiffness, 2), round(1e3 * spring.late, 3)
    (40.0, 2.0)
    """
    columns = np.stack([kernel.seen(measured, 0), kernel.seen(measured, 1)])
    columns = np.vstack([columns, np.ones(columns.shape[1])])
    (stiffness, damping, _), covariance, _ = fit_equation(columns, kernel.seen(force, 0), kernel)
    follows = stiffness > _CLEAR * np.sqrt(covariance[0, 0])
    return Spring(
        stiffness=float(stiffness),
        stiffness_deviation=float(np.sqrt(covariance[0, 0])),
        late=float(damping / stiffness) if follows else 0.0,
        late_deviation=float(np.sqrt(covariance[1, 1]) / stiffness) if follows else 0.0,
    )
