"""The force at the interface of a numerical substructure whose interface moves as commanded.

With coordinates x = γq₁/γᵀγ + Nq₂, in which q₁ = γᵀx is the command and the columns of N are orthogonal to γ,
its equations are, M, C, K and the load ℓ = Mι written in these coordinates ::

    M₂₂q₂'' + C₂₂q₂' + K₂₂q₂ = −ℓ₂a_g − M₂₁q₁'' − C₂₁q₁' − K₂₁q₁
    f = −ℓ₁a_g − (M₁₁q₁'' + C₁₁q₁' + K₁₁q₁) − (M₁₂q₂'' + C₁₂q₂' + K₁₂q₂)

The inner motion q₂ is that of the frame with its interface held, which is stable. It is stepped exactly for
a ground acceleration that is straight between samples, as are loads of a step h. The motion of the interface
is smooth, but for the part −γᵀιa_g of its acceleration: a smooth load u(t) moves the frame as straight lines
through u − δ²u/12 do, up to h⁴, where δ² is the second difference of its samples.
"""

import numpy as np
from scipy.linalg import null_space

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.structures.frame import exact_step
from reliab.structures.partition import Partition


class InnerMotion:
    """Force at the interface of a numerical substructure whose interface moves as commanded.

    `step` [s].
    """

    def __init__(self, partition: Partition, step: float) -> None:
        gamma = partition.direction
        self._ground_to_interface = float(gamma @ partition.frame.influence)
        basis = np.column_stack([gamma / (gamma @ gamma), null_space(gamma[np.newaxis])])
        mass, damping, stiffness = (
            basis.T @ matrix @ basis
            for matrix in (
                partition.numerical_mass,
                partition.numerical_damping,
                partition.numerical_stiffness,
            )
        )
        load = basis.T @ partition.frame.mass @ partition.frame.influence
        inner = gamma.size - 1
        # Rows are equations, columns the inputs a_g, q₁'', q₁', q₁.
        driven = -np.column_stack([load, mass[:, 0], damping[:, 0], stiffness[:, 0]])
        input_matrix = np.linalg.solve(mass[1:, 1:], driven[1:])
        dynamics = np.zeros((2 * inner, 2 * inner))
        dynamics[:inner, inner:] = np.eye(inner)
        dynamics[inner:] = -np.linalg.solve(mass[1:, 1:], np.hstack([stiffness[1:, 1:], damping[1:, 1:]]))
        loads = np.vstack([np.zeros((inner, 4)), input_matrix])
        self._steps = exact_step(dynamics, loads, step)
        coupling = mass[0, 1:]
        self._of_state = -(coupling @ dynamics[inner:] + np.concatenate([stiffness[0, 1:], damping[0, 1:]]))
        self._of_inputs = driven[0] - coupling @ input_matrix

    def force(self, ground: Array, motion: Array) -> Array:
        """Force that balances a ground acceleration and a motion of the command, from rest.

        `ground` [m/s²]; `motion` [m]; returns [N].
        """
        inputs = np.ascontiguousarray(np.stack([ground, motion[2], motion[1], motion[0]], axis=1))
        loads, smooth = inputs.copy(), inputs[:, 1:].copy()
        smooth[:, 0] += self._ground_to_interface * ground
        loads[1:-1, 1:] -= np.diff(smooth, 2, axis=0) / 12.0
        transition, early, late = (np.ascontiguousarray(matrix) for matrix in self._steps)
        return _balance(transition, early, late, self._of_state, self._of_inputs, inputs, loads)


@compiled
def _balance(
    transition: Array,
    early: Array,
    late: Array,
    state_row: Array,
    input_row: Array,
    inputs: Array,
    loads: Array,
) -> Array:
    """Step the inner motion and add up the force at every sample, shape (n,)."""
    states, count = early.shape
    z, z_next = np.zeros(states), np.zeros(states)
    force = np.zeros(inputs.shape[0])
    for k in range(inputs.shape[0]):
        if k > 0:
            for i in range(states):
                total = 0.0
                for j in range(states):
                    total += transition[i, j] * z[j]
                for j in range(count):
                    total += early[i, j] * loads[k - 1, j] + late[i, j] * loads[k, j]
                z_next[i] = total
            z, z_next = z_next, z
        total = 0.0
        for j in range(states):
            total += state_row[j] * z[j]
        for j in range(count):
            total += input_row[j] * inputs[k, j]
        force[k] = total
    return force
