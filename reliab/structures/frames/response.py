"""Exact response of an undivided linear structure to a ground motion that is linear between samples."""

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.compiled import compiled
from reliab.structures.frames.frame import Frame


def exact_step(dynamics: Array, loads: Array, step: float) -> tuple[Array, Array, Array]:
    """Transition over a step and the effect of loads that are linear in it.

    `step` [s].
    Returns `transition, early, late`: e^(Ah), and the effects of the loads' values at the begin and the end
    of the step, shapes (n, n) and twice (n, m).

    >>> transition, early, late = exact_step(np.array([[0.0]]), np.array([[1.0]]), 0.5)
    >>> float(transition[0, 0]), float(early[0, 0]), float(late[0, 0])
    (1.0, 0.25, 0.25)
    """
    n, m = loads.shape
    system = np.zeros((n + 2 * m, n + 2 * m))
    system[:n, :n] = dynamics * step
    system[:n, n : n + m] = loads * step
    system[n : n + m, n + m :] = np.eye(m)
    flow = scipy.linalg.expm(system)
    late = flow[:n, n + m :]
    return flow[:n, :n].copy(), flow[:n, n : n + m] - late, late


def undivided_response(frame: Frame, ground: Array, step: float) -> Array:
    """Exact displacements of the undivided linear structure [m], shape (degrees of freedom, samples).

    `ground` [m/s²]; `step` [s].
    """
    loads = np.concatenate([np.zeros(frame.size), -frame.influence])[:, np.newaxis]
    transition, early, late = exact_step(frame.state_matrix, loads, step)
    return follow_load(transition, early[:, 0].copy(), late[:, 0].copy(), ground, frame.size)


@compiled
def follow_load(transition: Array, early: Array, late: Array, ground: Array, shown: int) -> Array:
    """First states of a linear system under a load that is linear in every step, shape (shown, samples)."""
    states, samples = transition.shape[0], ground.size
    z, z_next = np.zeros(states), np.zeros(states)
    moved = np.zeros((shown, samples))
    for k in range(samples - 1):
        for i in range(states):
            total = early[i] * ground[k] + late[i] * ground[k + 1]
            for j in range(states):
                total += transition[i, j] * z[j]
            z_next[i] = total
        for i in range(states):
            z[i] = z_next[i]
        for i in range(shown):
            moved[i, k + 1] = z[i]
    return moved
