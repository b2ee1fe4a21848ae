"""A structure whose specimen is driven at one degree of freedom, or at several at once.

The actuators impose the interface displacements y = Γᵀx, and the specimen answers with the forces
K_e y + C_e y' + M_e y''. They belong to the structure's matrices, so that the computer keeps M − ΓM_eΓᵀ and
so on. One degree of freedom is the case of a Γ of one column::

    M_n x'' + C_n x' + K_n x = −M ι a_g − Γ f_e

A degree of freedom without mass follows the others by statics: where no actuator drives it, it is condensed
out (Guyan 1965, AIAA Journal 3, 380), else it takes a mass that moves by itself far above any test.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.arrays import Array, Spectrum
from reliab.errors import InputError
from reliab.significant import significant
from reliab.structures.frames.frame import (
    require_positive_definite,
    require_positive_semidefinite,
    square_matrix,
)
from reliab.structures.partition import Partition
from reliab.structures.parts_of_structure import with_parts
from reliab.structures.structure import Structure

_NO_MASS = 1e-12  # of the largest mass
_QUASI_STATIC = 2.0 * math.pi * 2000.0  # rad/s, of a driven degree of freedom without mass
_SINGULAR = 1e-10  # of the largest singular value
_SAME_SPECIMEN = 1e-6
_FEW = 6  # degrees of freedom that are too few to be reduced
_LEAST_SHARE = 1e-6
_MOVES = 1e-6  # of a mode's largest displacement: less at the interface is none


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledPartition:
    """A structure of which a specimen of one degree of freedom or several stands in the laboratory.

    Of one, Γ may be a vector and the specimen's matrices numbers. Two floors of a shear frame, both driven,
    whose lower storey is the specimen:

    >>> stiffness = np.array([[3e6, -1e6], [-1e6, 1e6]])
    >>> partition = CoupledPartition(
    ...     mass=1000.0 * np.eye(2), damping=1e-4 * stiffness, stiffness=stiffness, interface=np.eye(2),
    ...     specimen_stiffness=np.diag([2e6, 0.0]), names=("first", "second"))
    >>> partition.natural_frequencies.round(2)
    array([3.85, 9.3 ])
    """

    # mass, damping, stiffness: Symmetric M [kg], C [N·s/m] and K [N/m] of the whole structure, specimen
    # included, shape (n, n); a degree of freedom may be without mass; rotations have kg·m² and N·m
    mass: Array
    damping: Array
    stiffness: Array
    interface: Array  # Γ, how the degrees of freedom make up each interface displacement [-], shape (n, p)
    specimen_stiffness: Array  # K_e [N/m], shape (p, p)
    specimen_damping: Array = None  # type: ignore[assignment]  # C_e [N·s/m], shape (p, p); none by default
    specimen_mass: Array = None  # type: ignore[assignment]  # M_e [kg], shape (p, p); none by default
    influence: Array = None  # type: ignore[assignment]  # ι [-], shape (n,); ones by default
    names: tuple[str, ...] = ()  # Names of the interface displacements; "1" to "p" by default

    def __post_init__(self) -> None:
        for field in ("mass", "damping", "stiffness"):
            object.__setattr__(self, field, square_matrix(getattr(self, field), f"{field} matrix"))
        interface = np.array(self.interface, dtype=np.float64)
        interface = interface[:, np.newaxis] if interface.ndim == 1 else interface
        size = self.mass.shape[0]
        if self.damping.shape != (size, size) or self.stiffness.shape != (size, size):
            raise InputError(
                "Mass, damping and stiffness matrices must be of one size",
                value=f"{size}, {self.damping.shape[0]} and {self.stiffness.shape[0]} rows",
                remedy="Give one row and column for each degree of freedom",
            )
        if interface.ndim != 2 or interface.shape[0] != size or not np.isfinite(interface).all():  # noqa: PLR2004
            raise InputError(
                f"The interface needs {size} rows of finite numbers", value=f"shape {interface.shape}"
            )
        object.__setattr__(self, "interface", interface)
        self._check_interface()
        self._complete()
        self._check_substructure()

    def _check_interface(self) -> None:
        degrees = self.interface.shape[1]
        sizes = np.linalg.svd(self.interface, compute_uv=False)
        if degrees > self.interface.shape[0] or sizes.min() <= _SINGULAR * sizes.max():
            raise InputError(
                "The displacements of an interface must not depend on each other",
                value=f"{degrees} displacements of rank {int((sizes > _SINGULAR * sizes.max()).sum())}",
                remedy="Name each driven degree of freedom once",
            )
        names = tuple(self.names) or tuple(str(place + 1) for place in range(degrees))
        if len(names) != degrees or len(set(names)) != degrees:
            raise InputError(
                f"The {degrees} interface displacements need as many different names", value=list(names)
            )
        object.__setattr__(self, "names", names)

    def _complete(self) -> None:
        degrees = self.interface.shape[1]
        for field in ("specimen_stiffness", "specimen_damping", "specimen_mass"):
            values = getattr(self, field)
            values = np.zeros((degrees, degrees)) if values is None else np.atleast_2d(values)
            matrix = square_matrix(values, f"{field.replace('_', ' ')} matrix")
            if matrix.shape != (degrees, degrees):
                raise InputError(
                    f"The {field.replace('_', ' ')} matrix needs a row and a column for each of the "
                    f"{degrees} degrees of freedom of the specimen",
                    value=f"shape {matrix.shape}",
                    remedy="Give the matrix of the driven degrees of freedom, or name as many",
                )
            object.__setattr__(self, field, matrix)
        influence = np.ones(self.size) if self.influence is None else np.array(self.influence, dtype=float)
        if influence.shape != (self.size,) or not np.isfinite(influence).all():
            raise InputError(
                f"The influence vector needs {self.size} finite numbers", value=influence.tolist()
            )
        object.__setattr__(self, "influence", influence)

    def _check_substructure(self) -> None:
        if not any(matrix.any() for matrix in self._specimen):
            raise InputError("A specimen needs stiffness, damping or mass", value="none")
        require_positive_semidefinite(self.mass, "mass matrix", "Masses must not be negative")
        require_positive_definite(
            self.stiffness, "stiffness matrix", "A structure that can move without a force is not supported"
        )
        require_positive_semidefinite(self.damping, "damping matrix", "Damping must not feed energy in")
        for name, matrix in (
            ("mass", self.numerical(self.mass, self.specimen_mass)),
            ("stiffness", self.numerical(self.stiffness, self.specimen_stiffness)),
            ("damping", self.numerical(self.damping, self.specimen_damping)),
        ):
            lowest = float(np.linalg.eigvalsh(matrix)[0])
            if lowest < -_SAME_SPECIMEN * np.abs(getattr(self, name)).max():
                raise InputError(
                    f"The specimen must be part of the frame: what is left to the computer must not have a "
                    f"negative {name}",
                    value=f"the eigenvalue {significant(lowest)} of its {name} matrix",
                    remedy="Give the frame's matrices with the specimen in them, or state "
                    "part_of_structure = false",
                )

    @classmethod
    def of_partition(cls, partition: Partition) -> "CoupledPartition":
        """Take a frame with one actuator, whose specimen may be nonlinear alone."""
        frame, specimen = partition.frame, partition.specimen
        return cls._unchecked(
            mass=frame.mass,
            damping=frame.damping,
            stiffness=frame.stiffness,
            interface=partition.interface[:, np.newaxis],
            specimen_stiffness=np.array([[specimen.stiffness]]),
            specimen_damping=np.array([[specimen.damping]]),
            specimen_mass=np.array([[specimen.mass]]),
            influence=frame.influence,
            names=("1",),
        )

    @classmethod
    def of_structure(cls, structure: Structure, mass: float = 1.0) -> "CoupledPartition":
        """Take one degree of freedom of a mass [kg]: M = m, C = 2ξω₀m, K = ω₀²m, K_e = αω₀²m."""
        if not (math.isfinite(mass) and mass > 0.0):
            raise InputError("The mass of the structure must be positive", value=f"{mass} kg")
        w0 = structure.circular_frequency
        return cls._unchecked(
            mass=np.array([[mass]]),
            damping=np.array([[2.0 * structure.damping_ratio * w0 * mass]]),
            stiffness=np.array([[w0**2 * mass]]),
            interface=np.ones((1, 1)),
            specimen_stiffness=np.array([[structure.experimental_fraction * w0**2 * mass]]),
            specimen_damping=np.zeros((1, 1)),
            specimen_mass=np.zeros((1, 1)),
            influence=np.ones(1),
            names=("1",),
        )

    @classmethod
    def _unchecked(cls, **values: Any) -> "CoupledPartition":  # noqa: ANN401 - arrays and names
        """Make one of values that somebody else has checked."""
        partition = object.__new__(cls)
        partition.__dict__.update(values)
        return partition

    def changed(self, **values: Array) -> "CoupledPartition":
        """Return the structure with other matrices, which are not checked: a draw may be what no frame is."""
        return self._unchecked(**{field.name: getattr(self, field.name) for field in fields(self)} | values)

    @property
    def size(self) -> int:
        """Number n of degrees of freedom of the structure."""
        return int(self.mass.shape[-1])

    @property
    def degrees(self) -> int:
        """Number p of interface displacements."""
        return int(self.interface.shape[1])

    @property
    def _specimen(self) -> tuple[Array, Array, Array]:
        return self.specimen_stiffness, self.specimen_damping, self.specimen_mass

    def numerical(self, whole: Array, specimen: Array) -> Array:
        """Matrix of what is left to the computer, from those of the whole and of the specimen."""
        return np.asarray(whole - self.interface @ specimen @ self.interface.T)

    def impedance(self, s: Spectrum) -> Spectrum:
        """Specimen's forces over its displacements, K_e + C_e s + M_e s² [N/m], shape (…, p, p)."""
        s = np.asarray(s)[..., np.newaxis, np.newaxis]
        return np.asarray(self.specimen_stiffness + s * (self.specimen_damping + s * self.specimen_mass))

    @cached_property
    def with_masses(self) -> "CoupledPartition":
        """The same structure without degrees of freedom that have no mass."""
        bare = np.abs(self.mass).max(axis=1) <= _NO_MASS * np.abs(self.mass).max()
        driven = self.interface.any(axis=1)
        if not bare.any():
            return self
        followed = bare & ~driven
        reduced = self.projected(_static_shapes(self.stiffness, followed)) if followed.any() else self
        light = (bare & driven)[~followed]
        added = np.where(light, np.diag(reduced.stiffness) / _QUASI_STATIC**2, 0.0)
        return reduced.changed(mass=reduced.mass + np.diag(added))

    def projected(self, shapes: Array) -> "CoupledPartition":
        """Confine the structure to shapes of motion, in columns, shape (n, shapes)."""
        return self.changed(
            mass=shapes.T @ self.mass @ shapes,
            damping=shapes.T @ self.damping @ shapes,
            stiffness=shapes.T @ self.stiffness @ shapes,
            interface=shapes.T @ self.interface,
            # ι moves with the ground: M ι is what counts
            influence=np.asarray(
                np.linalg.lstsq(
                    shapes.T @ self.mass @ shapes, shapes.T @ self.mass @ self.influence, rcond=None
                )[0],
                dtype=np.float64,
            ),
        )

    def below(self, highest: float) -> "CoupledPartition":
        """Reduce the structure by modes above a frequency [Hz], which follow by statics and inertia.

        The shapes that are kept are the modes below and K⁻¹Γ, K⁻¹MK⁻¹Γ, so that statics at the interface
        and its first correction are exact.
        """
        whole = self.with_masses
        squares, modes = scipy.linalg.eigh(whole.stiffness, whole.mass)
        slow = modes[:, squares <= (2.0 * math.pi * highest) ** 2]
        if whole.size <= _FEW or slow.shape[1] + 2 * self.degrees >= whole.size:
            return whole
        static = np.linalg.solve(whole.stiffness, whole.interface)
        inertial = np.linalg.solve(whole.stiffness, whole.mass @ static)
        return whole.projected(_mass_orthonormal(np.hstack([slow, static, inertial]), whole.mass))

    @cached_property
    def natural_frequencies(self) -> Array:
        """Natural frequencies of the undamped structure [Hz], ascending."""
        whole = self.with_masses
        squares = scipy.linalg.eigh(whole.stiffness, whole.mass, eigvals_only=True)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * math.pi))

    @cached_property
    def modes(self) -> tuple[Array, Array, Array]:
        """Frequency [Hz], damping ratio [-] and interface displacements [1/√kg] of each mode.

        Shapes (modes,), (modes,) and (p, modes).
        """
        whole = self.with_masses
        squares, shapes = scipy.linalg.eigh(whole.stiffness, whole.mass)
        omega = np.sqrt(np.maximum(squares, 0.0))
        damping = np.einsum("di,de,ei->i", shapes, whole.damping, shapes)
        return omega / (2.0 * math.pi), damping / (2.0 * omega), whole.interface.T @ shapes

    @property
    def mode_shares(self) -> Array:
        """Specimen's share of the stiffness of each mode [-], shape (modes,)."""
        frequency, _, moved = self.modes
        stiffness = np.einsum("pm,pq,qm->m", moved, self.specimen_stiffness, moved)
        return np.asarray(stiffness / (2.0 * np.pi * frequency) ** 2)

    @property
    def static_transfer(self) -> Array:
        """Interface displacements by which a constant x_c − x_m moves the structure, ΓᵀK⁻¹ΓK_e [-]."""
        moved = np.linalg.solve(self.stiffness, self.interface @ self.specimen_stiffness)
        return np.asarray(self.interface.T @ moved)

    def shares_at_sensors(self, carry: Array) -> Array:
        """Share by which an offset that the loop feels at each sensor moves its command back [-], shape (p,).

        `carry`: interface displacements per unit at each sensor [-], shape (p, p).
        """
        shares = np.diag(np.linalg.solve(carry, self.static_transfer @ carry))
        return np.asarray(np.clip(shares, _LEAST_SHARE, 1.0))

    def with_parts(self, changes: Mapping[str, float]) -> "CoupledPartition":
        """Structure whose floors, storeys, modes or specimen are off by relative changes."""
        of_modes = any(name.startswith("mode") for name in changes)
        whole, more = self.with_masses if of_modes else self, changes.get("specimen_stiffness", 0.0)
        changed = with_parts(whole.mass, whole.damping, whole.stiffness, changes)
        return whole.changed(**_matrices(changed, whole._specimen))._with_specimen(1.0 + more)  # noqa: SLF001

    @property
    def without_specimen(self) -> "CoupledPartition":
        """Numerical substructure: what the computer simulates of the structure."""
        return self._with_specimen(0.0)

    def _with_specimen(self, factor: float) -> "CoupledPartition":
        """Structure with the specimen multiplied by a factor."""
        whole = zip((self.mass, self.damping, self.stiffness), reversed(self._specimen), strict=True)
        return self.changed(
            **_matrices(
                [self.numerical(matrix, (1.0 - factor) * part) for matrix, part in whole],
                [factor * part for part in self._specimen],
            )
        )

    def scaled(
        self,
        *,
        frequency: float | Array = 1.0,
        damping_ratio: float | Array = 1.0,
        share: float | Array = 1.0,
    ) -> "CoupledPartition":
        """Structure with all frequencies, damping ratios and the specimen multiplied by factors.

        Factors of many draws, shape (draws,), give its matrices a first axis of draws.
        """
        f, ratio, part = (
            np.asarray(one)[..., np.newaxis, np.newaxis] for one in (frequency, damping_ratio, share)
        )
        return self.changed(
            damping=self.damping * (f * ratio),
            stiffness=self.stiffness * f**2,
            specimen_stiffness=self.specimen_stiffness * (f**2 * part),
            specimen_damping=self.specimen_damping * (f * part),
            specimen_mass=self.specimen_mass * part,
        )

    @property
    def first_mode(self) -> Array:
        """Shape of the lowest undamped mode that moves the interface, at most by one, shape (n,)."""
        for shape in scipy.linalg.eigh(self.stiffness, self.mass)[1].T:
            moved = max(self.interface.T @ shape, key=abs)
            if abs(moved) > _MOVES * np.abs(shape).max():
                return np.asarray(shape / moved)
        interface = self.interface[:, 0]
        return np.asarray(interface / float(interface @ interface))

    @property
    def shapes_of_interface(self) -> Array:
        """Shapes in which interface displacements are one, shape (n, p): of one alone, the lowest mode."""
        if self.degrees == 1:
            return self.first_mode[:, np.newaxis]
        moved = np.linalg.solve(self.stiffness, self.interface)
        return np.asarray(np.linalg.solve((self.interface.T @ moved).T, moved.T).T)

    def error_transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from x_c − x_m to the interface's error, Γᵀ(M s² + C s + K)⁻¹Γ Z(s).

        `s` [rad/s]; returns [-], shape (…, p, p).
        """
        at = np.asarray(s)[..., np.newaxis, np.newaxis]
        dynamic = at**2 * self.mass + at * self.damping + self.stiffness
        return np.asarray(self.interface.T @ np.linalg.solve(dynamic, self.interface @ self.impedance(s)))


def _matrices(whole: Iterable[Array], specimen: Iterable[Array]) -> dict[str, Array]:
    """Name M, C and K of a structure, and K_e, C_e and M_e of its specimen."""
    of_specimen = ("specimen_stiffness", "specimen_damping", "specimen_mass")
    names = ("mass", "damping", "stiffness", *of_specimen)
    return dict(zip(names, (*whole, *specimen), strict=True))


def condensed(stiffness: Array, matrices: tuple[Array, ...], retained: int) -> tuple[Array, ...]:
    """Condense matrices of a specimen statically to its first degrees of freedom."""
    followed = np.arange(stiffness.shape[0]) >= retained
    shapes = _static_shapes(stiffness, followed)
    return tuple(shapes.T @ matrix @ shapes for matrix in matrices)


def _static_shapes(stiffness: Array, followed: NDArray[np.bool_]) -> Array:
    """Shapes of the structure when the remaining degrees of freedom move by one each."""
    moving = ~followed
    shapes = np.zeros((stiffness.shape[0], int(moving.sum())))
    shapes[moving] = np.eye(shapes.shape[1])
    shapes[followed] = -np.linalg.solve(
        stiffness[np.ix_(followed, followed)], stiffness[np.ix_(followed, moving)]
    )
    return shapes


def _mass_orthonormal(shapes: Array, mass: Array) -> Array:
    """Basis of the same motions, of unit mass each, without those that depend on others."""
    scaled = shapes / np.sqrt(np.einsum("di,de,ei->i", shapes, mass, shapes))
    values, vectors = np.linalg.eigh(scaled.T @ mass @ scaled)
    independent = values > _SINGULAR * values.max()
    return np.asarray(scaled @ vectors[:, independent] / np.sqrt(values[independent]))


def whole_structure(structure: Structure | Partition | CoupledPartition) -> CoupledPartition:
    """Convert any description of a structure with a specimen to its matrices."""
    if isinstance(structure, CoupledPartition):
        return structure
    if isinstance(structure, Partition):
        return CoupledPartition.of_partition(structure)
    return CoupledPartition.of_structure(structure)
