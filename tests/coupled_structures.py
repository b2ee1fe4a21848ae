"""Structures and actuators of coupled tests that are nobody's benchmark, for tests and measurements."""

from dataclasses import dataclass

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.simulation.transfer_systems.transfer_function import ActuatorMatrix, TransferFunction
from reliab.structures.frame import Specimen, exact_step, follow_load
from reliab.structures.partition import Partition

_WELL_POSED = 1e12
_MASSLESS = Specimen(stiffness=1.0)  # transfer functions do not depend on it


def ideal_response(partition: Partition, ground: Array, time_step: float) -> Array:
    """Interface displacements of the undivided structure from rest [m], shape (p, n).

    Exact for a ground acceleration that is linear between samples: `ground` [m/s²], shape (n,); `time_step`
    [s].
    """
    gamma, size = partition.interface, partition.size
    inverse = np.linalg.inv(partition.numerical_mass + gamma @ partition.specimen_mass @ gamma.T)
    dynamics = np.zeros((2 * size, 2 * size))
    dynamics[:size, size:] = np.eye(size)
    stiffness = partition.numerical_stiffness + gamma @ partition.specimen_stiffness @ gamma.T
    damping = partition.numerical_damping + gamma @ partition.specimen_damping @ gamma.T
    dynamics[size:, :size], dynamics[size:, size:] = -inverse @ stiffness, -inverse @ damping
    load = np.concatenate([np.zeros(size), -inverse @ partition.mass @ partition.influence])
    transition, early, late = exact_step(dynamics, load[:, np.newaxis], time_step)
    ground = np.ascontiguousarray(ground, dtype=np.float64)
    displacement = follow_load(transition, early[:, 0].copy(), late[:, 0].copy(), ground, size)
    return np.asarray(gamma.T @ displacement)


def lag(gain, corner):
    return TransferFunction(numerator=(gain * corner**2,), denominator=(1.0, 1.4 * corner, corner**2))


def coupled_lags(size, seed):
    generator = np.random.default_rng(seed)
    return tuple(
        tuple(
            lag(1.0 + 0.02 * generator.normal() if i == j else 0.03 * generator.normal(), 1500.0 + 100.0 * j)
            for j in range(size)
        )
        for i in range(size)
    )


def two_storeys():
    """Both storeys of a shear frame are driven."""
    stiffness = np.array([[3e6, -1e6], [-1e6, 1e6]])
    mass = np.diag([1200.0, 900.0])
    specimen = np.array([[1.2e6, -4e5], [-4e5, 4e5]])
    return mass, stiffness, np.eye(2), specimen, np.diag([30.0, 20.0]), np.ones(2), np.eye(2)


def node():
    """A node with two translations and a rotation, on three inclined actuators, below a floor."""
    stiffness = np.array(
        [[4e6, 2e5, 1e5, -1e6], [2e5, 6e6, -3e5, 0.0], [1e5, -3e5, 1.2e6, 1e5], [-1e6, 0.0, 1e5, 1e6]]
    )
    mass = np.diag([2000.0, 2000.0, 150.0, 1500.0])
    specimen = np.array([[1.5e6, 1e5, 5e4], [1e5, 2e6, -1e5], [5e4, -1e5, 4e5]])
    kinematics = np.array([[0.8, 0.6, 0.2], [-0.8, 0.6, 0.2], [0.0, 1.0, -0.3]])
    influence = np.array([1.0, 0.3, 0.0, 1.0])
    return mass, stiffness, np.eye(4)[:, :3], specimen, np.diag([40.0, 40.0, 3.0]), influence, kinematics


def plate():
    """Four actuators at the corners of a plate that moves up, bends, and turns about two axes."""
    generator = np.random.default_rng(7)
    root = generator.normal(size=(4, 4))
    stiffness = 2e6 * np.eye(4) + 2e5 * (root @ root.T)
    mass = np.diag([1500.0, 300.0, 300.0, 100.0])
    specimen = 0.4 * stiffness
    corners = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    kinematics = np.column_stack([np.ones(4), corners, corners.prod(axis=1)])
    return mass, stiffness, np.eye(4), specimen, 0.02 * mass, np.array([1.0, 0.2, 0.1, 0.0]), kinematics


def described(structure):
    mass, stiffness, interface, specimen, specimen_mass, influence, kinematics = structure()
    partition = Partition(
        mass=mass,
        damping=1.5 * mass + 3e-4 * stiffness,
        stiffness=stiffness,
        interface=interface,
        specimen_stiffness=specimen,
        specimen_damping=1e-4 * specimen,
        specimen_mass=specimen_mass,
        influence=influence,
    )
    actuators = ActuatorMatrix(kinematics=kinematics, transfer=coupled_lags(len(kinematics), 3))
    return partition, actuators


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
    complete = partition.nonsingular_form
    dynamics, load, command, measured = hybrid_system(complete, actuators)
    fastest = np.linalg.eigvals(dynamics).real.max()
    if fastest > 0.0:
        raise InputError(
            "hybrid test is unstable even without delay",
            value=f"a pole at {fastest:.4g} 1/s to the right of the axis",
        )
    displacements = _follow(dynamics, load, np.vstack([command, measured]), ground, time_step)
    return CoupledResponse(
        command=displacements[: complete.degrees],
        measured=displacements[complete.degrees :],
        reference=ideal_response(complete, ground, time_step),
        time_step=time_step,
    )


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
    actuator = actuators.interface_transfer(s)
    force = gamma @ (partition.impedance(s) @ actuator) @ gamma.T
    dynamic = square**2 * mass + square * damping + stiffness + force
    load = -(partition.mass @ partition.influence).astype(complex)
    displacement = np.linalg.solve(dynamic, np.broadcast_to(load[:, np.newaxis], (*dynamic.shape[:-1], 1)))
    command = gamma.T @ displacement
    return command[..., 0], (actuator @ command)[..., 0]


def hybrid_system(partition: Partition, actuators: ActuatorMatrix) -> tuple[Array, Array, Array, Array]:
    """Dynamics, load of a unit ground acceleration, and rows of command and measured displacement."""
    a, b, c, d = state_space(actuators)
    gamma, size, order = partition.interface, partition.size, a.shape[0]
    k, damping, m = partition.specimen_stiffness, partition.specimen_damping, partition.specimen_mass
    viscous, stiffness = partition.numerical_damping, partition.numerical_stiffness
    # y_m = C z + D y, y_m' = CA z + CB y + D y', y_m'' = CA² z + CAB y + CB y' + D y''
    state_force = k @ c + damping @ c @ a + m @ c @ a @ a
    displacement_force = k @ d + damping @ c @ b + m @ c @ a @ b
    velocity_force = damping @ d + m @ c @ b
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
    dynamics[size : 2 * size, :size] = -inverse @ (stiffness + gamma @ displacement_force @ gamma.T)
    dynamics[size : 2 * size, size : 2 * size] = -inverse @ (viscous + gamma @ velocity_force @ gamma.T)
    dynamics[size : 2 * size, 2 * size :] = -inverse @ gamma @ state_force
    dynamics[2 * size :, :size] = b @ gamma.T
    dynamics[2 * size :, 2 * size :] = a
    load = np.zeros(2 * size + order)
    load[size : 2 * size] = -inverse @ partition.mass @ partition.influence
    command = np.hstack([gamma.T, np.zeros((gamma.shape[1], size + order))])
    measured = np.hstack([d @ gamma.T, np.zeros((gamma.shape[1], size)), c])
    return dynamics, load, command, measured


def state_space(actuators: ActuatorMatrix) -> tuple[Array, Array, Array, Array]:
    """Return A, B, C and D from commanded to measured interface displacements, without pure delays."""
    if any(entry is not None and entry.delay > 0.0 for row in actuators.transfer for entry in row):
        raise InputError(
            "Actuators with pure delays have no finite state", remedy="Solve them over frequency"
        )
    size = len(actuators.transfer)
    blocks, commands, outputs = [], [], []
    direct = np.zeros((size, size))
    for i, row in enumerate(actuators.transfer):
        for j, entry in enumerate(row):
            if entry is None:
                continue
            plant = entry.plant(_MASSLESS)
            blocks.append(plant.dynamics)
            commands.append(np.outer(plant.command, np.eye(size)[j]))
            outputs.append(np.outer(np.eye(size)[i], plant.displacement))
            direct[i, j] = plant.displacement_of_command
    order = sum(block.shape[0] for block in blocks)
    a = scipy.linalg.block_diag(*blocks) if order else np.zeros((0, 0))
    b = np.vstack([np.zeros((0, size)), *commands]) @ actuators.kinematics
    c = np.linalg.solve(actuators.kinematics, np.hstack([np.zeros((size, 0)), *outputs]))
    interface_gain = np.linalg.solve(actuators.kinematics, direct @ actuators.kinematics)
    return (
        np.asarray(a, dtype=np.float64),
        np.asarray(b),
        np.asarray(c, dtype=np.float64),
        np.asarray(interface_gain, dtype=np.float64),
    )


def _follow(dynamics: Array, load: Array, rows: Array, ground: Array, step: float) -> Array:
    transition, early, late = exact_step(dynamics, load[:, np.newaxis], step)
    states = follow_load(
        transition,
        early[:, 0].copy(),
        late[:, 0].copy(),
        np.ascontiguousarray(ground, dtype=np.float64),
        load.size,
    )
    return np.asarray(rows @ states)
