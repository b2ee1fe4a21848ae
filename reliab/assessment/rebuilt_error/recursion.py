"""The causal recursion of the error: exact for an input that is a straight line between samples.

With z the structure's displacements under γu, the state (z, z') obeys ::

    z' = z',   M z'' + C z' + K z = γ u(t)

and for u linear between samples the state at the next sample is exactly (first-order hold; Franklin, Powell
and Workman, *Digital Control of Dynamic Systems*, 3rd ed., section 6.3.2) ::

    w₊ = E w + F₀u + F₁u₊,      e^[[A, b, 0], [0, 0, 1], [0, 0, 0]]h = [[E, F₀ + F₁, F₁], …]

The error of the displacement form is e = k_e z + c_e z' + m_e z'', that of the force form z itself. Nothing
is differentiated: z'' follows from the equation of motion.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.whole_structure import WholeStructure
from reliab.compiled import compiled
from reliab.threads import one_thread


@dataclass(frozen=True, kw_only=True, eq=False)
class Recursion:
    """Coefficients of w₊ = E w + F₀u + F₁u₊ and of outputs y = P w + q u."""

    decay: Array  # E, shape (2n, 2n)
    early: Array  # early, late: F₀ and F₁, shape (2n,)
    late: Array
    output: Array  # P, shape (outputs, 2n)
    feed_through: Array  # q, shape (outputs,)

    @classmethod
    def of_displacement(
        cls, structure: WholeStructure, time_step: float, *, floors: bool = False
    ) -> "Recursion":
        """Recursion from x_c − x_m to the error, M e'' + C e' + K e = γ Z (x_c − x_m).

        `time_step` [s].
        """
        chosen = np.eye(structure.interface.size) if floors else structure.interface[np.newaxis]
        size = structure.interface.size
        a, b = _state_space(structure)
        rows = structure.specimen_stiffness * np.eye(size, 2 * size)
        rows += structure.specimen_damping * np.eye(size, 2 * size, size)
        rows += structure.specimen_mass * a[size:]
        return cls._held(a, b, time_step, chosen @ rows, structure.specimen_mass * (chosen @ b[size:]))

    @classmethod
    def of_force(cls, structure: WholeStructure, time_step: float, *, floors: bool = False) -> "Recursion":
        """Recursion from a wrong force at the interface to the error, M e'' + C e' + K e = γ u.

        Parameters and result as for `of_displacement`.
        """
        size = structure.interface.size
        chosen = np.eye(size) if floors else structure.interface[np.newaxis]
        a, b = _state_space(structure)
        return cls._held(a, b, time_step, chosen @ np.eye(size, 2 * size), np.zeros(chosen.shape[0]))

    @classmethod
    def of_ground(cls, structure: WholeStructure, influence: Array, time_step: float) -> "Recursion":
        """Recursion from a ground acceleration to all displacements of the undisturbed structure.

        M x'' + C x' + K x = −M ι a_g; `influence`: ι [-], shape (n,); `time_step` [s].
        """
        a, _ = _state_space(structure)
        size = structure.interface.size
        b = np.concatenate([np.zeros(size), -influence])
        return cls._held(a, b, time_step, np.eye(size, 2 * size), np.zeros(size))

    @classmethod
    def _held(cls, a: Array, b: Array, step: float, output: Array, feed_through: Array) -> "Recursion":
        order = b.size
        joint = np.zeros((*a.shape[:-2], order + 2, order + 2))
        joint[..., :order, :order], joint[..., :order, order] = a * step, b * step
        joint[..., order, order + 1] = 1.0
        with one_thread():
            exponential = scipy.linalg.expm(joint)
        late = exponential[..., :order, order + 1]
        return cls(
            decay=np.ascontiguousarray(exponential[..., :order, :order]),
            early=exponential[..., :order, order] - late,
            late=np.ascontiguousarray(late),
            output=np.ascontiguousarray(output),
            feed_through=feed_through,
        )

    @classmethod
    def of_scaled(
        cls,
        structure: WholeStructure,
        time_step: float,
        *,
        frequency: Array,
        damping_ratio: Array,
        share: Array,
    ) -> "Recursion":
        """Recursions of `of_displacement` for many structures at once, with a first axis of draws.

        `time_step` [s]; the factors of :meth:`WholeStructure.scaled` [-], shape (draws,).
        """
        size, draws = structure.interface.size, frequency.size
        below = -np.linalg.solve(structure.mass, np.hstack([structure.stiffness, structure.damping]))
        moved = np.linalg.solve(structure.mass, structure.interface)
        factors = np.repeat(np.stack([frequency**2, frequency * damping_ratio], axis=1), size, axis=1)
        a = np.zeros((draws, 2 * size, 2 * size))
        a[:, :size] = np.eye(size, 2 * size, size)
        a[:, size:] = below * factors[:, np.newaxis]
        b = np.concatenate([np.zeros(size), moved])
        late_mass = structure.specimen_mass * share
        rows = np.zeros((draws, size, 2 * size))
        rows += (structure.specimen_stiffness * frequency**2 * share)[:, None, None] * np.eye(size, 2 * size)
        rows += (structure.specimen_damping * frequency * share)[:, None, None] * np.eye(size, 2 * size, size)
        rows += late_mass[:, None, None] * a[:, size:]
        return cls._held(
            a, b, time_step, structure.interface @ rows, late_mass * float(structure.interface @ moved)
        )

    @classmethod
    def of_structures(cls, structures: Sequence[WholeStructure], time_step: float) -> "Recursion":
        """Recursions of `of_displacement` for structures that differ by more than factors."""
        each = [cls.of_displacement(structure, time_step) for structure in structures]
        return cls(
            decay=np.stack([one.decay for one in each]),
            early=np.stack([one.early for one in each]),
            late=np.stack([one.late for one in each]),
            output=np.stack([one.output[0] for one in each]),
            feed_through=np.stack([one.feed_through[0] for one in each]),
        )

    @property
    def order(self) -> int:
        """Length 2n of the state."""
        return int(self.early.shape[-1])


def equilibrium(structure: WholeStructure, difference: float) -> Array:
    """State in which the structure stands under a constant x_c − x_m.

    `difference` [m].
    """
    size = structure.interface.size
    state = np.zeros(2 * size)
    if difference:
        state[:size] = difference * np.linalg.solve(structure.stiffness, structure.interface)
    return state


def _state_space(structure: WholeStructure) -> tuple[Array, Array]:
    size = structure.interface.size
    below = -np.linalg.solve(structure.mass, np.hstack([structure.stiffness, structure.damping]))
    a = np.vstack([np.eye(size, 2 * size, size), below])
    b = np.concatenate([np.zeros(size), np.linalg.solve(structure.mass, structure.interface)])
    return a, b


def respond(recursion: Recursion, values: Array, state: Array | None = None) -> Array:
    """Run the recursion over a whole input.

    A constant difference moves the undisturbed structure to its own share of it:

    >>> from reliab.structures.structure import Structure
    >>> half = Structure(frequency=1.0, damping_ratio=0.2, experimental_fraction=0.5)
    >>> recursion = Recursion.of_displacement(WholeStructure.of_structure(half), 0.01)
    >>> round(float(respond(recursion, np.ones(2000))[0, -1]), 6)
    0.5
    """
    held = np.zeros(recursion.order) if state is None else state
    return np.asarray(
        march(
            recursion.decay,
            recursion.early,
            recursion.late,
            recursion.output,
            recursion.feed_through,
            np.ascontiguousarray(values, dtype=np.float64),
            held,
        )
    )


@compiled
def march(
    decay: Array, early: Array, late: Array, output: Array, feed_through: Array, values: Array, state: Array
) -> Array:
    """Return outputs, shape (outputs, n); `state` belongs to the first and then to the last sample."""
    order, outputs = state.size, output.shape[0]
    answer = np.empty((outputs, values.size))
    moved = np.empty(order)
    for i in range(values.size):
        if i > 0:
            advance(decay, early, late, values[i - 1], values[i], state, moved)
        for row in range(outputs):
            total = feed_through[row] * values[i]
            for column in range(order):
                total += output[row, column] * state[column]
            answer[row, i] = total
    return answer


@compiled
def advance(
    decay: Array, early: Array, late: Array, before: float, now: float, state: Array, scratch: Array
) -> None:
    """Move the state by one step, in place."""
    for row in range(state.size):
        total = early[row] * before + late[row] * now
        for column in range(state.size):
            total += decay[row, column] * state[column]
        scratch[row] = total
    for row in range(state.size):
        state[row] = scratch[row]
