"""The structure of the multi-axial benchmark: a three-storey frame of which one bay is tested.

Data from Condori Uribe, Salmeron, Patino, Montoya, Dyke, Silva, Maghareh, Najarian and Montoya (2023),
*Frontiers in Built Environment*, as FermandoisLab/maRTHS-bmk-RoDeAC (MIT) holds them.
"""

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from reliab.core.arrays import Array
from reliab.core.shipped import shipped
from reliab.structures.frame import modal_damping
from reliab.structures.partition import Partition

RATE: Final = 1024.0
"""Sampling rate [Hz]."""

SCALE: Final = 0.4
"""Scale of the ground motions [-]."""

X: Final = (26, 25, 12)
"""Horizontal displacements of the storeys among the 29 degrees of freedom, counted from 0."""

THETA: Final = (20, 21, 2)
"""Rotations of the controlled node (joint 7) and of those above it."""

NEIGHBOUR: Final = 28
"""Rotation at the other end of the tested beam (joint 6)."""

_DRIVEN: Final = (X[0], NEIGHBOUR, THETA[0])
_ON_MASS, _ON_STIFFNESS = 1.2473724, 5.5985399e-4  # Rayleigh damping, 5 % at 13.493 and 165.125 rad/s
_INCH: Final = 0.0254
_MODULUS: Final = 200e9
_BEAM: Final = 0.762
_COLUMN_INERTIA: Final = 2.520 * _INCH**4
_IDEAL_COLUMN, _IDEAL_BEAM_INERTIA, _IDEAL_MASS = 0.635, 0.6132 * _INCH**4, 902.5
_IDEAL_ON_MASS, _IDEAL_ON_STIFFNESS = 2.25591114, 3.29183259e-4
_COLUMN, _BEAM_INERTIA = 0.64135, 4.21372e-7
_SOFTER: Final = 0.7  # of the inertia of the physical frame's columns
_MASSES: Final = (8.454, 0.8904, 0.8904, 0.4091, 0.4091)
_RATIO: Final = 0.05


@dataclass(frozen=True, kw_only=True, eq=False)
class Substructures:
    """Matrices of the benchmark, SI units, of 29 degrees of freedom and of the physical frame's five."""

    mass: Array  # mass, damping, stiffness: Of the reference structure, shape (29, 29)
    damping: Array
    stiffness: Array
    numerical_mass: Array  # numerical_mass, numerical_damping, numerical_stiffness: Left to the computer
    numerical_damping: Array
    numerical_stiffness: Array
    influence: Array  # ι, shape (29,)
    # Of the specimen: forces on x, joints 7 and 6 per (x, θ), their rates and accelerations, shape (3, 2)
    specimen_stiffness: Array
    specimen_damping: Array
    specimen_mass: Array


def ideal_bay() -> Array:
    """K of the idealised bay for x and the rotations of joints 6 and 7 [N/m], shape (3, 3).

    >>> ideal_bay().round().astype(int)[0]
    array([ 4915814, -1560771, -1560771])
    """
    column = _MODULUS * _COLUMN_INERTIA / _IDEAL_COLUMN
    beam = _MODULUS * _IDEAL_BEAM_INERTIA / _BEAM
    sway, turn = 6.0 * column / _IDEAL_COLUMN**2, 3.0 * column / _IDEAL_COLUMN
    own = 3.0 * column + 4.0 * beam
    return np.array([[sway, -turn, -turn], [-turn, own, -2.0 * beam], [-turn, -2.0 * beam, own]])


def physical_frame() -> tuple[Array, Array, Array]:
    """M, C and K of the physical frame for x and the rotations of joints 7, 6 and of the two feet.

    >>> import scipy
    >>> mass, _, stiffness = physical_frame()
    >>> (np.sqrt(scipy.linalg.eigvalsh(stiffness, mass)) / (2.0 * np.pi)).round(1)
    array([ 56.8, 147.6, 175.5, 259.4, 328.1])
    """
    column = _MODULUS * _COLUMN_INERTIA * _SOFTER / _COLUMN
    beam = _MODULUS * _BEAM_INERTIA / _BEAM
    turn = 6.0 * column / _COLUMN
    stiffness = np.diag([24.0 * column / _COLUMN**2, *[4.0 * (column + beam)] * 2, *[4.0 * column] * 2])
    for top, foot in ((1, 3), (2, 4)):
        stiffness[0, [top, foot]] = stiffness[[top, foot], 0] = turn
        stiffness[top, foot] = stiffness[foot, top] = 2.0 * column
    stiffness[1, 2] = stiffness[2, 1] = 2.0 * beam
    mass = np.diag(_MASSES)
    return mass, modal_damping(mass, stiffness, _RATIO), stiffness


@cache
def substructures() -> Substructures:
    """Matrices of the reference structure, of the computer's part and of the specimen."""
    mass, stiffness = (
        np.loadtxt(shipped("datasets", f"marths_benchmark/{name}_reference_29.csv"), delimiter=",")
        for name in ("M", "K")
    )
    damping = _ON_MASS * mass + _ON_STIFFNESS * stiffness
    bay, place = ideal_bay(), np.ix_(_DRIVEN, _DRIVEN)
    its_mass = np.diag([_IDEAL_MASS, 0.0, 0.0])
    left = [matrix.copy() for matrix in (mass, damping, stiffness)]
    left[0][place] -= its_mass
    left[1][place] -= _IDEAL_ON_MASS * its_mass + _IDEAL_ON_STIFFNESS * bay
    left[2][place] -= bay
    influence = np.zeros(len(mass))
    influence[list(X)] = 1.0
    forces = _condense_forces()
    return Substructures(
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        numerical_mass=left[0],
        numerical_damping=left[1],
        numerical_stiffness=left[2],
        influence=influence,
        specimen_mass=forces[0],
        specimen_damping=forces[1],
        specimen_stiffness=forces[2],
    )


def _condense_forces() -> tuple[Array, ...]:
    """Return forces on x, joints 7 and 6 of the physical frame whose other rotations follow by statics."""
    matrices = physical_frame()
    stiffness = matrices[2]
    shapes = np.vstack([np.eye(2), -np.linalg.solve(stiffness[2:, 2:], stiffness[2:, :2])])
    return tuple(matrix[:3] @ shapes for matrix in matrices)


def benchmark_partition() -> Partition:
    """Describe the benchmark as the structure by which `reliab assess` judges a test: interface x and θ.

    The specimen is the physical frame with its inner rotations condensed out, and θ = −U of joint 7.
    """
    parts = substructures()
    matrices = physical_frame()
    stiffness = matrices[2]
    shapes = np.vstack([np.eye(2), -np.linalg.solve(stiffness[2:, 2:], stiffness[2:, :2])])
    mass, damping, stiffness = (shapes.T @ matrix @ shapes for matrix in matrices)
    interface = np.zeros((len(parts.mass), 2))
    interface[X[0], 0], interface[THETA[0], 1] = 1.0, -1.0
    return Partition(
        mass=parts.numerical_mass + interface @ mass @ interface.T,
        damping=parts.numerical_damping + interface @ damping @ interface.T,
        stiffness=parts.numerical_stiffness + interface @ stiffness @ interface.T,
        interface=interface,
        specimen_stiffness=stiffness,
        specimen_damping=damping,
        specimen_mass=mass,
        influence=parts.influence,
        names=("x", "theta"),
    )


ARM: Final = math.hypot(0.26670, 0.127)
"""Distance of the actuators' pins from the controlled node [m]."""

ANGLE: Final = math.radians(25.4633)
"""Angle of the second actuator's pin; the first one has the opposite [rad]."""


def to_actuators(x: Array, theta: Array) -> Array:
    """Displacements of both actuators [mm] for x [m] and θ [rad], shape (2, n).

    >>> moved = to_actuators(np.array([0.01]), np.array([0.002]))
    >>> [float(history[0].round(6)) for history in to_node(moved)]
    [0.01, 0.002]
    """
    angles = np.array([[-ANGLE], [ANGLE]])
    return np.asarray(1e3 * (x + ARM * (np.cos(theta + angles) - np.cos(angles))))


def to_node(actuators: Array) -> Array:
    """X [m] and θ [rad] of the node for displacements of the actuators [mm], shape (2, n)."""
    first, second = 1e-3 * actuators
    theta = np.arcsin((first - second) / (2.0 * ARM * math.sin(ANGLE)))
    return np.stack([first + ARM * (math.cos(ANGLE) - np.cos(theta - ANGLE)), theta])


def small_kinematics() -> Array:
    """Displacements of both actuators per x and θ where rotations are small [-], shape (2, 2)."""
    lever = ARM * math.sin(ANGLE)
    return np.array([[1.0, lever], [1.0, -lever]])
