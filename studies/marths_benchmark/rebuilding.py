"""The error of a test of the benchmark, rebuilt from its displacements as its computer steps them.

The computer integrates by Newmark's method and differentiates what it measures backwards. A test errs by
e = U − U_I at the computer's degrees of freedom, and its specimen feels u = Se − τ too much, with S those of
the node and τ = x_c − x_m. What the computer does to both tests is linear ::

    e₊ = −K₊⁻¹(K₀e + K₋e₋) + B(f₊ + 2f + f₋),   f = K_e u + C_e(u − u₋)/h + M_e(u − 2u₋ + u₋₋)/h²

so that the error follows from τ to rounding. Exact steps of the structure that the benchmark stands for
leave what its computer does otherwise: some 10⁻⁴ of the error, and 5·10⁻³ of errors of some thousandths.
"""

from functools import cache
from itertools import pairwise

import numpy as np

from reliab.arrays import Array
from reliab.assessment.budget import ordinary_equipment, sizes_of_unknown, tolerances_of
from reliab.assessment.coupled_error import CoupledError, rebuild_coupled
from reliab.assessment.rebuilt_error import Recursion, Tolerances

from .loop import newmark
from .structure import NEIGHBOUR, RATE, THETA, X, benchmark_partition, substructures, to_node

_SIGNS = np.array([-1.0, 1.0, 1.0])  # with which the forces push x and the joints 7 and 6


def rebuilt_error(target: Array, measured: Array, draws: int, *, ordinary: bool = False) -> CoupledError:
    """Rebuild the error of x and θ from displacements of the actuators [mm], shape (2, n).

    Everything but the noise is exact, as in the simulation, or as `ordinary` equipment leaves it.
    """
    return rebuild_coupled(
        to_node(target),
        to_node(measured),
        1.0 / RATE,
        benchmark_partition(),
        recursion=own_recursion(),
        sensor_offsets=None if ordinary else np.zeros(2),
        tolerances=_of_ordinary_equipment() if ordinary else None,
        draws=draws,
    )


@cache
def _of_ordinary_equipment() -> Tolerances:
    lowest = benchmark_partition().lowest_mode
    return tolerances_of(sizes_of_unknown({}, lowest, ordinary_equipment(), 1.0 / RATE))


@cache
def own_recursion() -> Recursion:
    """Recursion of x and θ at 1024 Hz, for a test from rest."""
    later, now, before, _ = newmark()
    size = len(later)
    stiffness, damping, mass = _specimen()
    pushes = later[:, [X[0], THETA[0], NEIGHBOUR]] * _SIGNS
    node = np.zeros((2, size))
    node[0, X[0]], node[1, THETA[0]] = 1.0, -1.0
    e, e_before, u, u_before, f, f_before = _places(2 * [size] + 2 * [2] + 2 * [3])
    rows = np.eye(f_before.stop)
    # with u₊ = closed(S free − τ₊): what the state alone moves and pushes
    felt = mass @ rows[u_before] - (damping + 2.0 * mass) @ rows[u]
    free = pushes @ (felt + 2.0 * rows[f] + rows[f_before]) - now @ rows[e] - before @ rows[e_before]
    at_once = stiffness + damping + mass
    closed = np.linalg.inv(np.eye(2) - node @ pushes @ at_once)
    of_state, of_difference = closed @ node @ free, -closed
    transition, late = np.zeros_like(rows), np.zeros((len(rows), 2))
    for place, held in ((e_before, e), (u_before, u), (f_before, f)):
        transition[place] = rows[held]
    transition[u], late[u] = of_state, of_difference
    transition[f], late[f] = felt + at_once @ of_state, at_once @ of_difference
    transition[e], late[e] = free + pushes @ at_once @ of_state, pushes @ at_once @ of_difference
    return Recursion(
        transition=transition,
        early=np.zeros_like(late),
        late=late,
        output=node @ rows[e],
        feed_through=np.zeros((2, 2)),
        static=np.asarray(np.linalg.solve(np.eye(len(rows)) - transition, late), dtype=np.float64),
    )


def _specimen() -> tuple[Array, Array, Array]:
    """Return forces per displacement and per its first two backward differences [N/m], shape (3, 2) each."""
    parts = substructures()
    return parts.specimen_stiffness, parts.specimen_damping * RATE, parts.specimen_mass * RATE**2


def _places(sizes: list[int]) -> list[slice]:
    ends = np.cumsum([0, *sizes]).tolist()
    return [slice(first, last) for first, last in pairwise(ends)]
