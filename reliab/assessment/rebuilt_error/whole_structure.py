"""The whole structure for the equation of the error: matrices, the interface, and the linear specimen."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.structures import Partition, Structure, with_parts

_MOVES = 1e-6  # of a mode's largest displacement: less at the interface is none


@dataclass(frozen=True, kw_only=True, eq=False)
class WholeStructure:
    """A linear structure, specimen included, M x'' + C x' + K x = −M ι a_g, tested through one interface.

    The actuator moves the interface displacement γᵀx. The specimen's restoring force there is
    k_e y + c_e y' + m_e y'' of that displacement y, and is part of M, C and K.

    >>> two = WholeStructure(
    ...     mass=np.eye(2),
    ...     damping=0.1 * np.eye(2),
    ...     stiffness=np.array([[200.0, -100.0], [-100.0, 100.0]]),
    ...     interface=np.array([1.0, 0.0]),
    ...     specimen_stiffness=100.0,
    ... )
    >>> np.round(two.natural_frequencies, 3)
    array([0.984, 2.575])
    """

    # mass, damping, stiffness: M [kg], C [N·s/m] and K [N/m] of the whole structure, shape (n, n)
    mass: Array
    damping: Array
    stiffness: Array
    interface: Array  # γ, how the degrees of freedom make up the interface displacement [-], shape (n,)
    specimen_stiffness: float  # k_e [N/m]
    specimen_damping: float = 0.0  # c_e [N·s/m]
    specimen_mass: float = 0.0  # m_e [kg]

    def __post_init__(self) -> None:
        size = self.interface.size
        for name in ("mass", "damping", "stiffness"):
            matrix = getattr(self, name)
            if matrix.shape != (size, size) or not np.isfinite(matrix).all():
                raise InputError(
                    f"The {name} matrix must be finite and as large as the interface vector",
                    value=f"shape {matrix.shape} against {size} degrees of freedom",
                    remedy="Give M, C and K of the whole structure, specimen included",
                )
        specimen = (self.specimen_stiffness, self.specimen_damping, self.specimen_mass)
        if not np.isfinite([*self.interface, *specimen]).all():
            raise InputError("Interface and specimen must be finite numbers", value=specimen)
        if not np.linalg.cond(self.mass) < 1.0 / np.finfo(float).eps:
            raise InputError(
                "The mass matrix of the whole structure must not be singular",
                remedy="Condense degrees of freedom without mass",
            )

    @classmethod
    def of_structure(cls, structure: Structure) -> "WholeStructure":
        """Single degree of freedom per unit mass: M = 1, C = 2ξω₀, K = ω₀², k_e = αω₀²."""
        w0 = structure.circular_frequency
        return cls(
            mass=np.eye(1),
            damping=np.array([[2.0 * structure.damping_ratio * w0]]),
            stiffness=np.array([[w0**2]]),
            interface=np.ones(1),
            specimen_stiffness=structure.experimental_fraction * w0**2,
        )

    @classmethod
    def of_partition(cls, partition: Partition) -> "WholeStructure":
        """Take a frame of which one specimen stands in the laboratory."""
        frame, specimen = partition.frame, partition.specimen
        return cls(
            mass=frame.mass,
            damping=frame.damping,
            stiffness=frame.stiffness,
            interface=partition.interface,
            specimen_stiffness=specimen.stiffness,
            specimen_damping=specimen.damping,
            specimen_mass=specimen.mass,
        )

    @property
    def natural_frequencies(self) -> Array:
        """Natural frequencies of the undamped structure [Hz], ascending, shape (n,)."""
        squared = np.linalg.eigvals(np.linalg.solve(self.mass, self.stiffness)).real
        return np.asarray(np.sqrt(np.sort(np.maximum(squared, 0.0))) / (2.0 * np.pi))

    def scaled(
        self, *, frequency: float = 1.0, damping_ratio: float = 1.0, share: float = 1.0
    ) -> "WholeStructure":
        """Structure with all frequencies, damping ratios and the specimen's share multiplied by factors."""
        return replace(
            self,
            damping=self.damping * (frequency * damping_ratio),
            stiffness=self.stiffness * frequency**2,
            specimen_stiffness=self.specimen_stiffness * frequency**2 * share,
            specimen_damping=self.specimen_damping * frequency * share,
            specimen_mass=self.specimen_mass * share,
        )

    def in_kilograms(self, mass: float) -> "WholeStructure":
        """Structure of a single degree of freedom, per unit mass, with a mass [kg]."""
        if not (np.isfinite(mass) and mass > 0.0):
            raise InputError("The mass of the structure must be positive", value=f"{mass} kg")
        return replace(
            self,
            mass=mass * self.mass,
            damping=mass * self.damping,
            stiffness=mass * self.stiffness,
            specimen_stiffness=mass * self.specimen_stiffness,
            specimen_damping=mass * self.specimen_damping,
            specimen_mass=mass * self.specimen_mass,
        )

    @property
    def without_specimen(self) -> "WholeStructure":
        """Numerical substructure: what the computer simulates of the structure."""
        at_interface = np.outer(self.interface, self.interface)
        return replace(
            self,
            mass=self.mass - self.specimen_mass * at_interface,
            damping=self.damping - self.specimen_damping * at_interface,
            stiffness=self.stiffness - self.specimen_stiffness * at_interface,
            specimen_stiffness=0.0,
            specimen_damping=0.0,
            specimen_mass=0.0,
        )

    @property
    def share_at_rest(self) -> float:
        """Share of a constant force at the interface that the specimen bears, k_e γᵀK⁻¹γ [-]."""
        moved = np.linalg.solve(self.stiffness, self.interface)
        return float(self.specimen_stiffness * (self.interface @ moved))

    def with_parts(self, changes: Mapping[str, float]) -> "WholeStructure":
        """Structure whose floors, storeys, modes or specimen are off by relative changes."""
        mass, damping, stiffness = with_parts(self.mass, self.damping, self.stiffness, changes)
        more = changes.get("specimen_stiffness", 0.0)
        at_interface = more * np.outer(self.interface, self.interface)
        return replace(
            self,
            mass=mass + self.specimen_mass * at_interface,
            damping=damping + self.specimen_damping * at_interface,
            stiffness=stiffness + self.specimen_stiffness * at_interface,
            specimen_stiffness=self.specimen_stiffness * (1.0 + more),
            specimen_damping=self.specimen_damping * (1.0 + more),
            specimen_mass=self.specimen_mass * (1.0 + more),
        )

    def receptance(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Displacements of all degrees of freedom under a unit force at the interface.

        `s` [rad/s]; returns [m/N].
        """
        square = s[:, np.newaxis, np.newaxis]
        dynamic = self.mass * square**2 + self.damping * square + self.stiffness
        force = np.broadcast_to(self.interface.astype(np.complex128), (s.size, self.interface.size))
        return np.asarray(np.linalg.solve(dynamic, force[..., np.newaxis])[..., 0])

    def error_transfer(self, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Transfer function from x_c − x_m to the interface's error, γᵀ(M s² + C s + K)⁻¹γ Z(s).

        `s` [rad/s]; returns [-].
        """
        specimen = self.specimen_stiffness + self.specimen_damping * s + self.specimen_mass * s**2
        return np.asarray((self.receptance(s) @ self.interface) * specimen)


def whole_structure(structure: Structure | Partition | WholeStructure) -> WholeStructure:
    """Convert any supported description of a structure to a whole structure."""
    if isinstance(structure, WholeStructure):
        return structure
    if isinstance(structure, Partition):
        return WholeStructure.of_partition(structure)
    return WholeStructure.of_structure(structure)


def first_mode(structure: WholeStructure) -> Array:
    """Shape of the lowest undamped mode that moves the interface by one, shape (n,)."""
    values, vectors = np.linalg.eig(np.linalg.solve(structure.mass, structure.stiffness))
    for place in np.argsort(values.real):
        shape = vectors[:, place].real
        moved = float(structure.interface @ shape)
        if abs(moved) > _MOVES * np.abs(shape).max():
            return np.asarray(shape / moved)
    return np.asarray(structure.interface / float(structure.interface @ structure.interface))
