"""Transfer functions of a structure between its interface, its specimen and the ground.

With M, C, K of the whole structure, Γ of its interface and Z = K_e + C_e s + M_e s² of its specimen ::

    H = Γᵀ (M s² + C s + K)⁻¹ Γ        interface displacements by forces there
    h = Γᵀ (M s² + C s + K)⁻¹ M ι      interface displacements by −(ground acceleration)

Both are sums over the structure's poles, which costs less than a system of equations at every frequency.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.structures.partition import Partition

_WORST_CONDITION = 1e10  # of the eigenvectors, beyond which poles are too close together to be told apart


class Frequencies(Protocol):
    """Complex frequencies at which responses are evaluated."""

    @property
    def s(self) -> Spectrum:
        """Complex frequencies [rad/s], shape (K,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureResponse:
    """Transfer functions at complex frequencies."""

    compliance: Spectrum  # H [m/N], shape (K, p, p)
    ground: Spectrum  # h [s²], shape (K, p)
    impedance: Spectrum  # Z [N/m], shape (K, p, p)

    @cached_property
    def stiffness(self) -> Spectrum:
        """Forces at the interface by its displacements, H⁻¹ [N/m], shape (K, p, p)."""
        single = self.compliance.shape[-1] == 1
        return np.asarray(1.0 / self.compliance if single else np.linalg.inv(self.compliance))

    @cached_property
    def ground_load(self) -> Spectrum:
        """Forces at the interface that hold it against unit ground accelerations, H⁻¹h [kg], shape (K, p)."""
        return np.asarray((self.stiffness @ self.ground[..., np.newaxis])[..., 0])


@lru_cache(maxsize=8)  # most quantities of a test change its channels alone
def respond(partition: Partition, frequencies: Frequencies) -> StructureResponse:
    """Evaluate the transfer functions of a structure."""
    s = frequencies.s
    impedance = partition.impedance(s)
    if partition.size == 1:
        mass, damping, stiffness = (
            float(m[0, 0]) for m in (partition.mass, partition.damping, partition.stiffness)
        )
        gamma = float(partition.interface[0, 0])
        dynamic = 1.0 / (mass * s**2 + damping * s + stiffness)
        return StructureResponse(
            compliance=(gamma**2 * dynamic)[:, np.newaxis, np.newaxis],
            ground=(gamma * mass * float(partition.influence[0]) * dynamic)[:, np.newaxis],
            impedance=impedance,
        )
    full_structure = partition.nonsingular_form
    inputs = np.column_stack([full_structure.interface, full_structure.mass @ full_structure.influence])
    answers = _respond_by_poles(full_structure, s, full_structure.interface.T, inputs)
    return StructureResponse(
        compliance=answers[..., :-1], ground=np.ascontiguousarray(answers[..., -1]), impedance=impedance
    )


def apply_at_interface(matrices: Spectrum, values: Spectrum) -> Spectrum:
    """Return matrices · values at each frequency, shape (p, K).

    `matrices` has shape (K, p, p), `values` (p, K): impedances give the forces [N] of displacements [m],
    compliances the displacements of forces.
    """
    if matrices.shape[-1] == 1:
        return np.asarray(matrices[:, 0].T * values)
    return np.asarray((matrices @ values.T[..., np.newaxis])[..., 0].T)


def _respond_by_poles(structure: Partition, s: Spectrum, outputs: Array, inputs: Array) -> Spectrum:
    """Return outputs (M s² + C s + K)⁻¹ inputs, shape (K, outputs, inputs)."""
    size = structure.size
    inverse = np.linalg.inv(structure.mass)
    system = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-inverse @ structure.stiffness, -inverse @ structure.damping],
        ]
    )
    poles, shapes = scipy.linalg.eig(system)
    if np.linalg.cond(shapes) > _WORST_CONDITION:
        frequencies = s[:, np.newaxis, np.newaxis]
        return np.asarray(
            outputs
            @ np.linalg.solve(
                frequencies**2 * structure.mass + frequencies * structure.damping + structure.stiffness,
                inputs,
            )
        )
    driven = np.linalg.solve(shapes, np.vstack([np.zeros_like(inputs), inverse @ inputs]))
    output_shapes = outputs @ shapes[:size]
    residues = np.einsum("om,mi->moi", output_shapes, driven)
    answers = 1.0 / (s[:, np.newaxis] - poles) @ residues.reshape(len(poles), -1)
    return np.asarray(answers.reshape(len(s), *residues.shape[1:]))
