"""The causal recursion of the error: exact for inputs that are straight lines between samples.

With τ = x_c − x_m, one number or one for each interface displacement, e = x_c − x_I obeys ::

    M e'' + C e' + K e = Γ(K_e τ + C_e τ' + M_e τ''),   the error is Γᵀe − τ

Nothing is differentiated: with D = M⁻¹ΓM_e, w = e − Dτ and r the sum of what stands under no derivative ::

    w' = r − M⁻¹C w + M⁻¹(ΓC_e − C D)τ,   r' = −M⁻¹K w + M⁻¹(ΓK_e − K D)τ

A force at the interface, a specimen's slip or a ground acceleration only have other loads. For inputs u
linear between samples the state at the next sample is exactly (first-order hold; Franklin, Powell and
Workman, *Digital Control of Dynamic Systems*, 3rd ed., section 6.3.2) ::

    w₊ = E w + F₀u + F₁u₊,      e^[[A, B, 0], [0, 0, 1], [0, 0, 0]]h = [[E, F₀ + F₁, F₁], …]

Straight lines between the samples of a smooth τ lack (ωh)²/12 of it, 0.6 % where a period has 24 samples.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from reliab.core.arrays import Array, read_only
from reliab.core.compiled import compiled
from reliab.core.threads import one_thread
from reliab.structures.partition import Partition


@dataclass(frozen=True, kw_only=True, eq=False)
class Recursion:
    """Coefficients of w₊ = E w + F₀u + F₁u₊ and of outputs y = P w + Q u, for p inputs."""

    transition: Array  # E, shape (2n, 2n)
    early: Array  # early, late: F₀ and F₁, shape (2n, p)
    late: Array
    output: Array  # P, shape (outputs, 2n)
    feed_through: Array  # Q, shape (outputs, p)
    # State per constant input under which the structure stands still, shape (2n, p); NaN where no stiffness
    # holds it
    static: Array

    @cached_property
    def matrices(self) -> tuple[Array, Array, Array, Array, Array]:
        """E, F₀, F₁, P and Q, of one type for compiled kernels."""
        output_matrices = read_only(self.output), read_only(self.feed_through)
        return read_only(self.transition), read_only(self.early), read_only(self.late), *output_matrices

    @classmethod
    def from_displacement(cls, structure: Partition, time_step: float, *, slips: bool = False) -> "Recursion":
        """Recursion from x_c − x_m to the error of the interface.

        `time_step` [s]; `slips`: whether displacements that the specimen's stiffness has lost are further
        inputs, as many.
        """
        gamma = structure.interface
        direct = np.linalg.solve(structure.mass, gamma @ structure.specimen_mass)
        rate_loads = gamma @ structure.specimen_damping - structure.damping @ direct
        displacement_loads = gamma @ structure.specimen_stiffness - structure.stiffness @ direct
        feed_through = gamma.T @ direct
        if slips:
            slip_loads = gamma @ structure.specimen_stiffness
            rate_loads = np.hstack([rate_loads, np.zeros_like(slip_loads)])
            displacement_loads = np.hstack([displacement_loads, slip_loads])
            feed_through = np.hstack([feed_through, np.zeros_like(feed_through)])
        return cls._discretize(structure, rate_loads, displacement_loads, time_step, gamma.T, feed_through)

    @classmethod
    def from_force(cls, structure: Partition, time_step: float) -> "Recursion":
        """Recursion from a wrong force at the interface to the error, M e'' + C e' + K e = Γ u.

        Parameters and result as for `of_displacement`.
        """
        gamma = structure.interface
        no_feed_through = np.zeros((structure.degrees, structure.degrees))
        return cls._discretize(structure, np.zeros_like(gamma), gamma, time_step, gamma.T, no_feed_through)

    @classmethod
    def _discretize(
        cls,
        structure: Partition,
        rate_loads: Array,
        displacement_loads: Array,
        step: float,
        rows: Array,
        feed_through: Array,
    ) -> "Recursion":
        size, inputs = displacement_loads.shape
        joint_rows = np.hstack([structure.damping, structure.stiffness, rate_loads, displacement_loads])
        accelerations: Array = np.asarray(np.linalg.solve(structure.mass, joint_rows), dtype=np.float64)
        viscous, elastic, rate_inputs, displacement_inputs = np.split(
            accelerations, [size, 2 * size, 2 * size + inputs], axis=1
        )
        order = 2 * size
        joint = np.zeros((order + 2 * inputs, order + 2 * inputs))
        joint[:size, :size], joint[size:order, :size] = -step * viscous, -step * elastic
        joint[:size, size:order] = step * np.eye(size)
        joint[:size, order : order + inputs] = step * rate_inputs
        joint[size:order, order : order + inputs] = step * displacement_inputs
        joint[order : order + inputs, order + inputs :] = np.eye(inputs)
        with one_thread():
            exponential = scipy.linalg.expm(joint)
        late = exponential[:order, order + inputs :]
        still = _still(elastic, displacement_inputs)
        return cls(
            transition=np.ascontiguousarray(exponential[:order, :order]),
            early=np.ascontiguousarray(exponential[:order, order : order + inputs] - late),
            late=np.ascontiguousarray(late),
            output=np.ascontiguousarray(np.hstack([rows, np.zeros_like(rows)])),  # one layout, one kernel
            feed_through=np.ascontiguousarray(feed_through),
            static=np.vstack([still, viscous @ still - rate_inputs]),
        )

    @property
    def order(self) -> int:
        """Length 2n of the state."""
        return int(self.transition.shape[-1])


def _still(elastic: Array, loads: Array) -> Array:
    """Displacements under constant loads."""
    try:
        return np.asarray(np.linalg.solve(elastic, loads))
    except np.linalg.LinAlgError:
        return np.full_like(loads, np.nan)


def respond(recursion: Recursion, values: Array, state: Array | None = None) -> Array:
    """Run the recursion over a whole input, shape (n,) or (p, n); returns outputs, shape (outputs, n).

    A constant difference moves the undisturbed structure to its own share of it:

    >>> from reliab.structures.structure import Structure
    >>> half = Structure(frequency=1.0, damping_ratio=0.2, experimental_fraction=0.5)
    >>> recursion = Recursion.from_displacement(Partition.from_structure(half), 0.01)
    >>> round(float(respond(recursion, np.ones(2000))[0, -1]), 6)
    0.5
    """
    inputs = np.ascontiguousarray(np.atleast_2d(values), dtype=np.float64)
    initial_state = np.zeros(recursion.order) if state is None else np.array(state, dtype=np.float64)
    return run_on(recursion, inputs, initial_state)


def run_on(recursion: Recursion, inputs: Array, state: Array) -> Array:
    """Run the recursion from the state at the first input, shape (p, n), to that at the last, in place."""
    return np.asarray(march(*recursion.matrices, (0,) * len(inputs), inputs, state))


@compiled
def march(
    transition: Array,
    early: Array,
    late: Array,
    output: Array,
    feed_through: Array,
    actuators: tuple[int, ...],
    inputs: Array,
    state: Array,
) -> Array:
    """Return outputs, shape (outputs, n); `state` belongs to the first and then to the last sample."""
    answer = np.empty((output.shape[0], inputs.shape[1]))
    scratch = np.empty(state.size)
    for i in range(inputs.shape[1]):
        if i > 0:
            advance(actuators, transition, early, late, inputs, i, state, scratch)
        for row in range(output.shape[0]):
            total = 0.0
            for channel in range(len(actuators)):
                total += feed_through[row, channel] * inputs[channel, i]
            for column in range(state.size):
                total += output[row, column] * state[column]
            answer[row, i] = total
    return answer


@compiled
def advance(
    actuators: tuple[int, ...],
    transition: Array,
    early: Array,
    late: Array,
    inputs: Array,
    now: int,
    state: Array,
    scratch: Array,
) -> None:
    """Move the state by one step, to a sample of the inputs, shape (p, n), in place.

    `actuators`: any p numbers, whose count is known when the kernel is compiled.
    """
    for row in range(state.size):
        total = 0.0
        for channel in range(len(actuators)):
            total += early[row, channel] * inputs[channel, now - 1]
            total += late[row, channel] * inputs[channel, now]
        for column in range(state.size):
            total += transition[row, column] * state[column]
        scratch[row] = total
    for row in range(state.size):
        state[row] = scratch[row]
