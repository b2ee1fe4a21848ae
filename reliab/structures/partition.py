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

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import require_physical
from reliab.effects.effect import Effect, Role
from reliab.structures.frame import (
    Frame,
    Specimen,
    influence_vector,
    massless,
    matrices_of_one_size,
    require_positive_definite,
    require_positive_semidefinite,
    square_matrix,
    static_shapes,
)
from reliab.structures.parts_of_structure import change_matrices
from reliab.structures.structure import Structure

_QUASI_STATIC = 2.0 * math.pi * 2000.0  # rad/s, of a driven degree of freedom without mass
_SINGULAR = 1e-10  # of the largest singular value
_SAME_SPECIMEN = 1e-6
_LEAST_SHARE = 1e-6


@dataclass(frozen=True, kw_only=True, eq=False)
class Partition:
    """A structure of which a specimen of one degree of freedom or several stands in the laboratory.

    Of one, Γ may be a vector and the specimen's matrices numbers. Two floors of a shear frame, both driven,
    whose lower storey is the specimen:

    >>> stiffness = np.array([[3e6, -1e6], [-1e6, 1e6]])
    >>> partition = Partition(
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
    degrees_of_freedom: tuple[str, ...] = ()  # Names of those of the structure; "1" to "n" by default
    effects: tuple[Effect, ...] = ()  # What one driven specimen does beyond its matrices, all on its force

    def __post_init__(self) -> None:
        for field, matrix in matrices_of_one_size(self.mass, self.damping, self.stiffness).items():
            object.__setattr__(self, field, matrix)
        self._check_interface()
        self._complete()
        for effect in self.effects:
            if effect.role is not Role.FORCE:
                raise InputError(
                    "An effect of the frame's specimen must act on its force",
                    value=effect.name,
                    remedy="Put effects of actuators and sensors into the laboratory",
                )
        self._check_substructure()

    def _check_interface(self) -> None:
        interface = np.array(self.interface, dtype=np.float64)
        interface = interface[:, np.newaxis] if interface.ndim == 1 else interface
        rows, degrees = interface.shape
        if rows != self.size or not np.isfinite(interface).all() or not interface.any(axis=0).all():
            raise InputError(
                f"Each displacement of the interface needs {self.size} finite numbers that are not all zero",
                value=interface.T.tolist(),
                remedy="Give the weight of each degree of freedom in what an actuator imposes",
            )
        sizes = np.linalg.svd(interface, compute_uv=False)
        if degrees > rows or sizes.min() <= _SINGULAR * sizes.max():
            raise InputError(
                "The displacements of an interface must not depend on each other",
                value=f"{degrees} displacements of rank {int((sizes > _SINGULAR * sizes.max()).sum())}",
                remedy="Name each driven degree of freedom once",
            )
        interface.setflags(write=False)
        object.__setattr__(self, "interface", interface)
        self._name("names", degrees, "interface displacements")
        self._name("degrees_of_freedom", rows, "degrees of freedom")

    def _name(self, field: str, number: int, description: str) -> None:
        names = tuple(getattr(self, field)) or tuple(str(place + 1) for place in range(number))
        if len(names) != number or len(set(names)) != number:
            rule = f"The {number} {description} need as many different names"
            raise InputError(rule, value=list(names), remedy="Give each a name of its own")
        object.__setattr__(self, field, names)

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
        object.__setattr__(self, "influence", influence_vector(self.influence, self.size))

    def _check_substructure(self) -> None:
        if not any(matrix.any() for matrix in self._specimen) and not self.effects:
            raise InputError("The specimen has neither stiffness nor damping nor mass", remedy="State one")
        require_positive_semidefinite(self.mass, "mass matrix", "Masses must not be negative")
        require_positive_definite(
            self.stiffness, "stiffness matrix", "A structure that can move without a force is not supported"
        )
        require_positive_semidefinite(self.damping, "damping matrix", "Damping must not feed energy in")
        if self.degrees == 1:
            self._require_mass_left()
        for name in ("mass", "stiffness", "damping"):
            lowest = float(np.linalg.eigvalsh(getattr(self, f"numerical_{name}"))[0])
            if lowest < -_SAME_SPECIMEN * np.abs(getattr(self, name)).max():
                raise InputError(
                    f"The specimen must be part of the frame: what is left to the computer must not have a "
                    f"negative {name}",
                    value=f"the eigenvalue {significant(lowest)} of its {name} matrix",
                    remedy="Give the frame's matrices with the specimen in them, or state "
                    "part_of_structure = false",
                )

    def _require_mass_left(self) -> None:
        """Refuse one actuator that drives all of the mass: the computer's part divides by what is left."""
        regular = self.nonsingular_form
        interface_mass = 1.0 / float(regular.direction @ np.linalg.solve(regular.mass, regular.direction))
        if self.specimen.mass >= interface_mass:
            raise InputError(
                "The specimen's mass must be smaller than the mass that moves at the interface, "
                f"which is {interface_mass:g} kg",
                value=f"{self.specimen.mass:g} kg",
                remedy="The frame's mass matrix includes the specimen; raise it or take a lighter specimen",
            )

    @classmethod
    def from_frame(
        cls, frame: Frame, interface: Array, specimen: Specimen, effects: tuple[Effect, ...] = ()
    ) -> "Partition":
        """Take a frame with a specimen in it that one actuator drives; `interface`: γ [-], shape (n,).

        A frame of one degree of freedom whose whole spring is tested is the paper's structure:

        >>> from reliab.structures.structure import Structure
        >>> frame = Frame.from_structure(Structure(frequency=1.0, damping_ratio=0.02), mass=1000.0)
        >>> partition = Partition.from_frame(frame, np.ones(1), Specimen(stiffness=39478.4176))
        >>> partition.stiffness_shares.round(6)
        array([1.])
        """
        return cls(
            mass=frame.mass,
            damping=frame.damping,
            stiffness=frame.stiffness,
            interface=interface,
            specimen_stiffness=specimen.stiffness,  # type: ignore[arg-type]  # made an array there
            specimen_damping=specimen.damping,  # type: ignore[arg-type]
            specimen_mass=specimen.mass,  # type: ignore[arg-type]
            influence=frame.influence,
            degrees_of_freedom=frame.names,
            effects=effects,
        )

    @classmethod
    def from_structure(cls, structure: Structure, mass: float = 1.0) -> "Partition":
        """Take one degree of freedom of a mass [kg]: M = m, C = 2ξω₀m, K = ω₀²m, K_e = αω₀²m."""
        require_physical("mass", mass, label="mass of the structure")
        w0 = structure.circular_frequency
        return cls._construct(
            mass=np.array([[mass]]),
            damping=np.array([[2.0 * structure.damping_ratio * w0 * mass]]),
            stiffness=np.array([[w0**2 * mass]]),
            interface=np.ones((1, 1)),
            specimen_stiffness=np.array([[structure.experimental_fraction * w0**2 * mass]]),
            specimen_damping=np.zeros((1, 1)),
            specimen_mass=np.zeros((1, 1)),
            influence=np.ones(1),
            names=("1",),
            degrees_of_freedom=("1",),
            effects=(),
        )

    @classmethod
    def _construct(cls, **values: Any) -> "Partition":  # noqa: ANN401 - arrays and names
        """Make one of values that somebody else has checked."""
        partition = object.__new__(cls)
        partition.__dict__.update(values)
        return partition

    def replace_values(self, **values: Any) -> "Partition":  # noqa: ANN401 - arrays and names
        """Return the structure with other matrices, which are not checked: a draw may be what no frame is."""
        return self._construct(**{field.name: getattr(self, field.name) for field in fields(self)} | values)

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

    @property
    def direction(self) -> Array:
        """γ of the one actuator [-], shape (n,)."""
        self._require_one()
        return self.interface[:, 0]

    @property
    def specimen(self) -> Specimen:
        """Linear part of the specimen of one actuator."""
        self._require_one()
        stiffness, damping, mass = (float(matrix[0, 0]) for matrix in self._specimen)
        return Specimen(stiffness=stiffness, damping=damping, mass=mass)

    def _require_one(self) -> None:
        if self.degrees != 1:
            raise InputError(
                "The specimen of this frame must be driven at one degree of freedom",
                value=", ".join(self.names),
                remedy="Describe one driven degree of freedom",
            )

    @cached_property
    def frame(self) -> Frame:
        """The whole structure, of which every degree of freedom has a mass."""
        return Frame(
            mass=self.mass,
            damping=self.damping,
            stiffness=self.stiffness,
            influence=self.influence,
            names=self.degrees_of_freedom,
        )

    def _subtract_specimen(self, matrix: Array, specimen: Array) -> Array:
        return np.asarray(matrix - self.interface @ specimen @ self.interface.T)

    @property
    def numerical_mass(self) -> Array:
        """M_n [kg], shape (n, n)."""
        return self._subtract_specimen(self.mass, self.specimen_mass)

    @property
    def numerical_damping(self) -> Array:
        """C_n [N·s/m], shape (n, n)."""
        return self._subtract_specimen(self.damping, self.specimen_damping)

    @property
    def numerical_stiffness(self) -> Array:
        """K_n [N/m], shape (n, n)."""
        return self._subtract_specimen(self.stiffness, self.specimen_stiffness)

    def impedance(self, s: Spectrum) -> Spectrum:
        """Specimen's forces over its displacements, K_e + C_e s + M_e s² [N/m], shape (…, p, p)."""
        s = np.asarray(s)[..., np.newaxis, np.newaxis]
        return np.asarray(self.specimen_stiffness + s * (self.specimen_damping + s * self.specimen_mass))

    @cached_property
    def nonsingular_form(self) -> "Partition":
        """The same structure without degrees of freedom that have no mass."""
        is_massless = massless(self.mass)
        driven = self.interface.any(axis=1)
        if not is_massless.any():
            return self
        is_condensed = is_massless & ~driven
        regular = self.project(static_shapes(self.stiffness, is_condensed)) if is_condensed.any() else self
        light = (is_massless & driven)[~is_condensed]
        driven_mass = np.where(light, np.diag(regular.stiffness) / _QUASI_STATIC**2, 0.0)
        return regular.replace_values(mass=regular.mass + np.diag(driven_mass))

    def project(self, shapes: Array) -> "Partition":
        """Confine the structure to shapes of motion, in columns, shape (n, shapes)."""
        mass = shapes.T @ self.mass @ shapes
        # ι moves with the ground: M ι is what counts
        influence = np.linalg.lstsq(mass, shapes.T @ self.mass @ self.influence, rcond=None)[0]
        return self.replace_values(
            mass=mass,
            damping=shapes.T @ self.damping @ shapes,
            stiffness=shapes.T @ self.stiffness @ shapes,
            interface=shapes.T @ self.interface,
            degrees_of_freedom=(),
            influence=np.asarray(influence, dtype=np.float64),
        )

    @cached_property
    def natural_frequencies(self) -> Array:
        """Natural frequencies of the undamped structure [Hz], ascending."""
        regular = self.nonsingular_form
        squares = scipy.linalg.eigh(regular.stiffness, regular.mass, eigvals_only=True)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * math.pi))

    @cached_property
    def modes(self) -> tuple[Array, Array, Array]:
        """Frequency [Hz], damping ratio [-] and interface displacements [1/√kg] of each mode.

        Shapes (modes,), (modes,) and (p, modes).
        """
        regular = self.nonsingular_form
        squares, shapes = scipy.linalg.eigh(regular.stiffness, regular.mass)
        omega = np.sqrt(np.maximum(squares, 0.0))
        damping = np.einsum("di,de,ei->i", shapes, regular.damping, shapes)
        return omega / (2.0 * math.pi), damping / (2.0 * omega), regular.interface.T @ shapes

    @property
    def lowest_mode(self) -> Structure:
        """Lowest mode, whose share of the specimen stands for that of the structure."""
        frequency, ratio, share = (float(values[0]) for values in (*self.modes[:2], self.stiffness_shares))
        share = float(np.clip(share, _LEAST_SHARE, 1.0))
        return Structure(frequency=frequency, damping_ratio=ratio, experimental_fraction=share)

    @property
    def stiffness_shares(self) -> Array:
        """Specimen's share of the stiffness of each mode, φᵀΓK_eΓᵀφ/ω² [-], shape (modes,)."""
        frequency, _, interface_shapes = self.modes
        stiffness = np.einsum("pm,pq,qm->m", interface_shapes, self.specimen_stiffness, interface_shapes)
        return np.asarray(stiffness / (2.0 * math.pi * frequency) ** 2)

    @property
    def impedance_shares(self) -> Spectrum:
        """Force of the specimen in each mode over that of the mode's spring, φᵀΓZ(iω)Γᵀφ/ω² [-].

        Its real part is the share of the stiffness less that of the mass, its imaginary part 2ζ times that
        of the damping; for a spring it is α_i.
        """
        frequency, _, interface_shapes = self.modes
        omega = 2.0 * math.pi * frequency
        forces = self.impedance((1j * omega).astype(np.complex128))
        modal_forces = [
            shape @ force @ shape for shape, force in zip(interface_shapes.T, forces, strict=True)
        ]
        return np.asarray(modal_forces / omega**2)

    @property
    def static_transfer(self) -> Array:
        """Interface displacements by which a constant x_c − x_m moves the structure, ΓᵀK⁻¹ΓK_e [-]."""
        displacement = np.linalg.solve(self.stiffness, self.interface @ self.specimen_stiffness)
        return np.asarray(self.interface.T @ displacement)

    def shares_at_sensors(self, carry: Array) -> Array:
        """Share by which an offset that the loop feels at each sensor moves its command back [-], shape (p,).

        `carry`: interface displacements per unit at each sensor [-], shape (p, p).
        """
        shares = np.diag(np.linalg.solve(carry, self.static_transfer @ carry))
        return np.asarray(np.clip(shares, _LEAST_SHARE, 1.0))

    def change_parts(self, changes: Mapping[str, float]) -> "Partition":
        """Structure whose floors, storeys, modes or specimen are off by relative changes."""
        has_modes = any(name.startswith("mode") for name in changes)
        regular = self.nonsingular_form if has_modes else self
        matrices = change_matrices(regular.mass, regular.damping, regular.stiffness, changes)
        partition = regular.replace_values(**_matrices(matrices, regular._specimen))  # noqa: SLF001
        return partition._scale_specimen(1.0 + changes.get("specimen_stiffness", 0.0))  # noqa: SLF001

    @property
    def numerical_substructure(self) -> "Partition":
        """Numerical substructure: what the computer simulates of the structure."""
        return self._scale_specimen(0.0)

    def _scale_specimen(self, factor: float) -> "Partition":
        """Structure with the specimen multiplied by a factor."""
        pairs = zip((self.mass, self.damping, self.stiffness), reversed(self._specimen), strict=True)
        return self.replace_values(
            **_matrices(
                [self._subtract_specimen(matrix, (1.0 - factor) * part) for matrix, part in pairs],
                [factor * part for part in self._specimen],
            )
        )

    def scale(
        self,
        *,
        frequency: float = 1.0,
        damping_ratio: float = 1.0,
        share: float = 1.0,
    ) -> "Partition":
        """Structure with all frequencies, damping ratios and the specimen multiplied by factors."""
        return self.replace_values(
            damping=self.damping * (frequency * damping_ratio),
            stiffness=self.stiffness * frequency**2,
            specimen_stiffness=self.specimen_stiffness * (frequency**2 * share),
            specimen_damping=self.specimen_damping * (frequency * share),
            specimen_mass=self.specimen_mass * share,
        )

    def error_transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from x_c − x_m to the interface's error, Γᵀ(M s² + C s + K)⁻¹Γ Z(s).

        `s` [rad/s]; returns [-], shape (…, p, p).
        """
        s_matrix = np.asarray(s)[..., np.newaxis, np.newaxis]
        dynamic = s_matrix**2 * self.mass + s_matrix * self.damping + self.stiffness
        return np.asarray(self.interface.T @ np.linalg.solve(dynamic, self.interface @ self.impedance(s)))


def _matrices(matrices: Iterable[Array], specimen: Iterable[Array]) -> dict[str, Array]:
    """Name M, C and K of a structure, and K_e, C_e and M_e of its specimen."""
    names = ("mass", "damping", "stiffness", "specimen_stiffness", "specimen_damping", "specimen_mass")
    return dict(zip(names, (*matrices, *specimen), strict=True))


def whole_structure(structure: Structure | Partition) -> Partition:
    """Convert any description of a structure with a specimen to its matrices."""
    return structure if isinstance(structure, Partition) else Partition.from_structure(structure)
