"""A hybrid test with several actuators under a ground motion, exact where the acceleration is linear.

The computer's part, the actuators and the specimen are one linear system ::

    M_n x'' + C_n x' + K_n x = −M ι a_g − Γ(K_e y_m + C_e y_m' + M_e y_m''),   y_m = T⁻¹H T Γᵀx

Without pure delays it has a state, which is stepped exactly; with them it is solved at every frequency. Both
give the same, and each is the other's oracle.
"""

from dataclasses import dataclass

import numpy as np

from reliab.arrays import Array, Spectrum
from reliab.errors import InputError
from reliab.simulation.transfer_systems import ActuatorMatrix, TransferFunction, gain_and_delay
from reliab.structures import Partition
from reliab.structures.frames import exact_step, follow_load

_WELL_POSED = 1e12


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledResponse:
    """Interface displacements of a hybrid test."""

    command: Array  # command, measured, reference: y_c, y_m and those of the undivided structure [m], (p, n)
    measured: Array
    reference: Array
    time_step: float  # s


def coupled_response(
    partition: Partition, actuators: ActuatorMatrix, ground: Array, time_step: float
) -> CoupledResponse:
    """Simulate a test from rest.

    `ground` [m/s²], shape (n,); `time_step` [s]. Raises InputError where the test is unstable or actuators
    have pure delays.
    """
    whole = partition.with_masses
    dynamics, load, command, measured = hybrid_system(whole, actuators)
    fastest = np.linalg.eigvals(dynamics).real.max()
    if fastest > 0.0:
        raise InputError(
            "The hybrid test must be stable", value=f"a pole at {fastest:.4g} 1/s to the right of the axis"
        )
    followed = _followed(dynamics, load, np.vstack([command, measured]), ground, time_step)
    return CoupledResponse(
        command=followed[: whole.degrees],
        measured=followed[whole.degrees :],
        reference=ideal_response(whole, ground, time_step),
        time_step=time_step,
    )


def ideal_response(partition: Partition, ground: Array, time_step: float) -> Array:
    """Interface displacements of the undivided structure from rest [m], shape (p, n).

    `ground` [m/s²], shape (n,); `time_step` [s].
    """
    perfect = ActuatorMatrix(kinematics=np.eye(partition.degrees), transfer=_perfect(partition.degrees))
    dynamics, load, command, _ = hybrid_system(partition, perfect)
    return _followed(dynamics, load, command, ground, time_step)


def hybrid_system(partition: Partition, actuators: ActuatorMatrix) -> tuple[Array, Array, Array, Array]:
    """Dynamics, load of a unit ground acceleration, and rows of command and measured displacement."""
    a, b, c, d = actuators.state_space()
    gamma, size, order = partition.interface, partition.size, a.shape[0]
    k, damping, m = partition.specimen_stiffness, partition.specimen_damping, partition.specimen_mass
    viscous, stiffness = partition.numerical_damping, partition.numerical_stiffness
    # y_m = C z + D y, y_m' = CA z + CB y + D y', y_m'' = CA² z + CAB y + CB y' + D y''
    of_state = k @ c + damping @ c @ a + m @ c @ a @ a
    of_size = k @ d + damping @ c @ b + m @ c @ a @ b
    of_rate = damping @ d + m @ c @ b
    inertia = partition.numerical_mass + gamma @ (m @ d) @ gamma.T
    if not np.linalg.cond(inertia) < _WELL_POSED:
        raise InputError(
            "The test must have a mass at every degree of freedom",
            value="actuators that jump with the command before a specimen with all of the mass",
            remedy="Leave mass to the computer, or add the poles of the actuators",
        )
    inverse = np.linalg.inv(inertia)
    dynamics = np.zeros((2 * size + order, 2 * size + order))
    dynamics[:size, size : 2 * size] = np.eye(size)
    dynamics[size : 2 * size, :size] = -inverse @ (stiffness + gamma @ of_size @ gamma.T)
    dynamics[size : 2 * size, size : 2 * size] = -inverse @ (viscous + gamma @ of_rate @ gamma.T)
    dynamics[size : 2 * size, 2 * size :] = -inverse @ gamma @ of_state
    dynamics[2 * size :, :size] = b @ gamma.T
    dynamics[2 * size :, 2 * size :] = a
    load = np.zeros(2 * size + order)
    load[size : 2 * size] = -inverse @ partition.mass @ partition.influence
    command = np.hstack([gamma.T, np.zeros((gamma.shape[1], size + order))])
    measured = np.hstack([d @ gamma.T, np.zeros((gamma.shape[1], size)), c])
    return dynamics, load, command, measured


def responses_over_frequency(
    partition: Partition, actuators: ActuatorMatrix, s: Spectrum
) -> tuple[Spectrum, Spectrum]:
    """Command and measured displacement per ground acceleration at s [rad/s], shape (…, p) each [s²]."""
    gamma = partition.interface
    mass, damping, stiffness = (
        partition.numerical_mass,
        partition.numerical_damping,
        partition.numerical_stiffness,
    )
    square = np.asarray(s, dtype=np.complex128)[..., np.newaxis, np.newaxis]
    actuator = actuators.at_interface(s)
    force = gamma @ (partition.impedance(s) @ actuator) @ gamma.T
    dynamic = square**2 * mass + square * damping + stiffness + force
    load = -(partition.mass @ partition.influence).astype(complex)
    moved = np.linalg.solve(dynamic, np.broadcast_to(load[:, np.newaxis], (*dynamic.shape[:-1], 1)))
    command = gamma.T @ moved
    return command[..., 0], (actuator @ command)[..., 0]


def _perfect(degrees: int) -> tuple[tuple[TransferFunction | None, ...], ...]:
    one = gain_and_delay()
    return tuple(tuple(one if i == j else None for j in range(degrees)) for i in range(degrees))


def _followed(dynamics: Array, load: Array, rows: Array, ground: Array, step: float) -> Array:
    transition, early, late = exact_step(dynamics, load[:, np.newaxis], step)
    states = follow_load(
        transition,
        early[:, 0].copy(),
        late[:, 0].copy(),
        np.ascontiguousarray(ground, dtype=np.float64),
        load.size,
    )
    return np.asarray(rows @ states)
