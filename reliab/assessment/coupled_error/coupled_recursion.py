"""The recursion of the error of several interface displacements, exact for inputs linear between samples.

With τ = x_c − x_m, a vector, e = x_c − x_I obeys ::

    M e'' + C e' + K e = Γ(K_e τ + C_e τ' + M_e τ''),   the error is ΓᵀE − τ

Nothing is differentiated: with D = M⁻¹ΓM_e, w = e − Dτ and q the sum of what stands under no derivative ::

    w' = M⁻¹(q − C w + (ΓC_e − C D)τ),   q' = −K w + (ΓK_e − K D)τ

Straight lines between the samples of a smooth τ lack (ωh)²/12 of it, 0.6 % where a period has 24 samples.
That much of its bend, (τ₊ − 2τ + τ₋)/12, is added to the samples that they join.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array
from reliab.compiled import compiled
from reliab.structures import CoupledPartition
from reliab.structures.frames import exact_step
from reliab.threads import one_thread


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledRecursion:
    """Coefficients of w₊ = E w + F₀τ + F₁τ₊ and of the interface's part of e, y = P w + Qτ."""

    transition: Array  # E, shape (2n, 2n)
    early: Array  # early, late: F₀ and F₁, shape (2n, p)
    late: Array
    output: Array  # P, shape (p, 2n)
    feed_through: Array  # Q, shape (p, p)
    static: Array  # State per constant τ under which the structure stands still, shape (2n, p)
    free: Array  # State per displacement and per velocity of the interface, shape (2, 2n, p)
    smooth: bool = True  # Whether τ is smooth between samples; else it is what a computer steps with

    @classmethod
    def of_partition(cls, partition: CoupledPartition, time_step: float) -> "CoupledRecursion":
        """Recursion for a structure all of whose degrees of freedom have mass; `time_step` [s]."""
        mass, damping, stiffness = partition.mass, partition.damping, partition.stiffness
        gamma, size = partition.interface, partition.size
        at_once = np.linalg.solve(mass, gamma @ partition.specimen_mass)
        inverse = np.linalg.inv(mass)
        dynamics = np.block([[-inverse @ damping, inverse], [-stiffness, np.zeros((size, size))]])
        by_rate = gamma @ partition.specimen_damping - damping @ at_once
        by_size = gamma @ partition.specimen_stiffness - stiffness @ at_once
        loads = np.vstack([inverse @ by_rate, by_size])
        with one_thread():
            transition, early, late = exact_step(dynamics, loads, time_step)
        shapes = np.linalg.solve(stiffness, gamma)
        shapes = np.linalg.solve((gamma.T @ shapes).T, shapes.T).T
        return cls(
            transition=np.ascontiguousarray(transition),
            early=np.ascontiguousarray(early),
            late=np.ascontiguousarray(late),
            output=np.ascontiguousarray(np.hstack([gamma.T, np.zeros((gamma.shape[1], size))])),
            feed_through=np.ascontiguousarray(gamma.T @ at_once),
            static=-np.linalg.solve(dynamics, loads),
            free=np.stack(
                [np.vstack([shapes, damping @ shapes]), np.vstack([np.zeros_like(shapes), mass @ shapes])]
            ),
        )

    def respond(self, differences: Array, state: Array | None = None) -> Array:
        """Interface displacements e for a history of τ [m], both of shape (p, n)."""
        start = np.zeros(self.transition.shape[0]) if state is None else state
        inputs = np.ascontiguousarray(differences.T)
        joined = _joined(inputs) if self.smooth else inputs
        moved = _march(self.transition, self.early, self.late, self.output, joined, start.copy())
        return np.asarray((moved + inputs @ self.feed_through.T).T)


def _joined(inputs: Array) -> Array:
    """Return samples whose straight connections move a structure as a smooth history does, shape (n, p)."""
    joined = inputs.copy()
    joined[1:-1] -= np.diff(inputs, 2, axis=0) / 12.0
    return joined


@compiled
def _march(transition: Array, early: Array, late: Array, output: Array, inputs: Array, state: Array) -> Array:
    samples, channels = inputs.shape
    order = state.size
    moved = np.empty(order)
    answer = np.empty((samples, channels))
    for k in range(samples):
        if k > 0:
            for i in range(order):
                total = 0.0
                for j in range(channels):
                    total += early[i, j] * inputs[k - 1, j] + late[i, j] * inputs[k, j]
                for j in range(order):
                    total += transition[i, j] * state[j]
                moved[i] = total
            for i in range(order):
                state[i] = moved[i]
        for i in range(channels):
            total = 0.0
            for j in range(order):
                total += output[i, j] * state[j]
            answer[k, i] = total
    return answer
