"""One step of a linear system: exact for an input linear in the step, or as classical Runge-Kutta takes it."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

Array = NDArray[np.float64]


def exact_step(dynamics: Array, loads: Array, step: float) -> tuple[Array, Array, Array]:
    """Transition over a step and the effect of loads that are linear in it.

    Parameters
    ----------
    dynamics : numpy.ndarray
        A [1/s], shape (n, n).
    loads : numpy.ndarray
        Directions of the loads, shape (n, m).
    step : float
        Step [s].

    Returns
    -------
    transition, early, late : numpy.ndarray
        e^(Ah), and the effects of the loads' values at the begin and the end of the step, shapes (n, n) and
        twice (n, m).

    Examples
    --------
    >>> transition, early, late = exact_step(np.array([[0.0]]), np.array([[1.0]]), 0.5)
    >>> transition[0, 0], early[0, 0], late[0, 0]
    (1.0, 0.25, 0.25)
    """
    n, m = loads.shape
    system = np.zeros((n + 2 * m, n + 2 * m))
    system[:n, :n] = dynamics * step
    system[:n, n : n + m] = loads * step
    system[n : n + m, n + m :] = np.eye(m)
    flow = expm(system)
    late = flow[:n, n + m :]
    return flow[:n, :n], flow[:n, n : n + m] - late, late


def runge_kutta_step(dynamics: Array, loads: Array, step: float) -> tuple[Array, Array, Array, Array]:
    """Transition of the classical Runge-Kutta method, and the effects of loads at begin, middle and end."""
    n = dynamics.shape[0]
    a = step * dynamics
    eye = np.eye(n)
    k1 = a
    k2 = a @ (eye + 0.5 * k1)
    k3 = a @ (eye + 0.5 * k2)
    k4 = a @ (eye + k3)
    transition = eye + (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0
    early = (eye + a + 0.5 * a @ a + 0.25 * a @ a @ a) / 6.0
    middle = (4.0 * eye + 2.0 * a + 0.5 * a @ a) / 6.0
    late = eye / 6.0
    b = step * loads
    return transition, early @ b, middle @ b, late @ b
