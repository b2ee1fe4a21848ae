"""Several actuators that move one specimen: kinematics, and a matrix of transfer functions."""

from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array, Spectrum
from reliab.errors import InputError
from reliab.simulation.transfer_systems.transfer_function import TransferFunction
from reliab.structures import Specimen

_WORST_CONDITION = 1e10  # of the kinematics, after rows and columns are scaled
_ANY = Specimen(stiffness=1.0)  # transfer functions do not depend on it


@dataclass(frozen=True, kw_only=True, eq=False)
class ActuatorMatrix:
    """Actuators whose commands are a_c = T y_c of the interface's, and whose motion is a_m = H(s) a_c.

    A second actuator that is carried along by the first:

    >>> lag, none = TransferFunction(numerator=(1.0,), denominator=(0.01, 1.0)), None
    >>> coupled = TransferFunction(numerator=(0.1,), denominator=(0.01, 1.0))
    >>> actuators = ActuatorMatrix(kinematics=np.eye(2), transfer=((lag, none), (coupled, lag)))
    >>> abs(actuators.at_interface(np.array([0j]))[0]).round(2)
    array([[1. , 0. ],
           [0.1, 1. ]])
    """

    kinematics: Array  # T, displacements of the actuators per interface displacement, shape (p, p)
    # H, measured over commanded displacement of actuators, row by row; None where there is no coupling
    transfer: tuple[tuple[TransferFunction | None, ...], ...]

    def __post_init__(self) -> None:
        kinematics = invertible(self.kinematics)
        object.__setattr__(self, "kinematics", kinematics)
        if {len(row) for row in self.transfer} != {kinematics.shape[0]} or len(self.transfer) != len(
            kinematics
        ):
            raise InputError(
                "The matrix of transfer functions needs a row and a column for each actuator",
                value=f"rows of {[len(row) for row in self.transfer]} for {kinematics.shape[0]} actuators",
                remedy="Give 0 where actuators are not coupled",
            )

    @property
    def delayed(self) -> bool:
        """Whether some transfer function has a pure delay."""
        return any(entry is not None and entry.delay > 0.0 for row in self.transfer for entry in row)

    def at_actuators(self, s: Spectrum) -> Spectrum:
        """H at s [rad/s], shape (…, p, p)."""
        s = np.asarray(s, dtype=np.complex128)
        zero = np.zeros_like(s)
        rows = [
            [zero if entry is None else entry.transfer(s, _ANY) for entry in row] for row in self.transfer
        ]
        return np.moveaxis(np.array(rows), (0, 1), (-2, -1))

    def at_interface(self, s: Spectrum) -> Spectrum:
        """Measured over commanded displacement of the interface, T⁻¹HT, at s [rad/s], shape (…, p, p)."""
        return np.asarray(np.linalg.solve(self.kinematics, self.at_actuators(s) @ self.kinematics))

    def state_space(self) -> tuple[Array, Array, Array, Array]:
        """Return A, B, C and D from commanded to measured interface displacements, without pure delays."""
        if self.delayed:
            raise InputError(
                "Actuators with pure delays have no finite state", remedy="Solve them over frequency"
            )
        size = len(self.transfer)
        blocks, commands, outputs = [], [], []
        direct = np.zeros((size, size))
        for i, row in enumerate(self.transfer):
            for j, entry in enumerate(row):
                if entry is None:
                    continue
                plant = entry.plant(_ANY)
                blocks.append(plant.dynamics)
                commands.append(np.outer(plant.command, np.eye(size)[j]))
                outputs.append(np.outer(np.eye(size)[i], plant.displacement))
                direct[i, j] = plant.displacement_of_command
        order = sum(block.shape[0] for block in blocks)
        a = scipy.linalg.block_diag(*blocks) if order else np.zeros((0, 0))
        b = np.vstack([np.zeros((0, size)), *commands]) @ self.kinematics
        c = np.linalg.solve(self.kinematics, np.hstack([np.zeros((size, 0)), *outputs]))
        at_interface = np.linalg.solve(self.kinematics, direct @ self.kinematics)
        return (
            np.asarray(a, dtype=np.float64),
            np.asarray(b),
            np.asarray(c, dtype=np.float64),
            np.asarray(at_interface, dtype=np.float64),
        )


def invertible(kinematics: Array) -> Array:
    """Return the matrix of kinematics, which must be square, finite and not singular."""
    matrix = np.array(kinematics, dtype=np.float64)
    if matrix.ndim != 2 or not np.isfinite(matrix).all():  # noqa: PLR2004
        raise InputError("The kinematics need rows of finite numbers", value=f"shape {matrix.shape}")
    if matrix.shape[0] > matrix.shape[1]:
        raise InputError(
            "There must not be more actuators than degrees of freedom of the specimen: they would work "
            "against each other",
            value=f"{matrix.shape[0]} actuators and {matrix.shape[1]} degrees of freedom",
            remedy="Name all driven degrees of freedom, or leave an actuator out",
        )
    if matrix.shape[0] < matrix.shape[1]:
        raise InputError(
            "Each degree of freedom of the specimen needs an actuator",
            value=f"{matrix.shape[0]} actuators and {matrix.shape[1]} degrees of freedom",
            remedy="Leave out the degrees of freedom that are free, and condense them",
        )
    largest = np.abs(matrix).max(axis=0)
    scaled = matrix / np.where(largest > 0.0, largest, 1.0)
    if not np.linalg.cond(scaled) < _WORST_CONDITION:
        raise InputError(
            "The kinematics must not be singular: the actuators must be able to move every degree of "
            "freedom by itself",
            value=f"rank {np.linalg.matrix_rank(scaled)} of {matrix.shape[0]}",
            remedy="Check the lever arms; one row holds the displacement of one actuator",
        )
    return matrix
