"""Structures and actuators of coupled tests that are nobody's benchmark, for tests and measurements."""

import numpy as np

from reliab.simulation.transfer_systems import ActuatorMatrix, TransferFunction
from reliab.structures import Partition


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
