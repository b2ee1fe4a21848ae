"""A linear structure of any number of degrees of freedom, M x'' + C x' + K x = −M ι a_g; specimens in it.

Its damping comes from ratios of the modes, or from two by Rayleigh's method; its exact response is that to a
ground motion that is linear between samples.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.core.stated_value import require_physical
from reliab.structures.structure import Structure

_SINGULAR = 1e-10  # of the largest eigenvalue
_NO_MASS = 1e-12  # of the largest mass


def condense_statically(
    stiffness: Array, matrices: tuple[Array, ...], retained_count: int
) -> tuple[Array, ...]:
    """Condense matrices of a specimen statically to its first degrees of freedom."""
    is_dependent = np.arange(stiffness.shape[0]) >= retained_count
    shapes = static_shapes(stiffness, is_dependent)
    return tuple(shapes.T @ matrix @ shapes for matrix in matrices)


def massless(mass: Array) -> NDArray[np.bool_]:
    """Tell which degrees of freedom have no mass, or one that is rounding beside the largest."""
    return np.asarray(np.abs(mass).max(axis=1) <= _NO_MASS * np.abs(mass).max())


def static_shapes(stiffness: Array, is_dependent: NDArray[np.bool_]) -> Array:
    """Shapes of the structure when the remaining degrees of freedom move by one each."""
    moving = ~is_dependent
    shapes = np.zeros((stiffness.shape[0], int(moving.sum())))
    shapes[moving] = np.eye(shapes.shape[1])
    shapes[is_dependent] = -np.linalg.solve(
        stiffness[np.ix_(is_dependent, is_dependent)], stiffness[np.ix_(is_dependent, moving)]
    )
    return shapes


def modal_damping(mass: ArrayLike, stiffness: ArrayLike, ratios: ArrayLike) -> Array:
    """Damping matrix of given damping ratios of the modes, C = M Φ diag(2ζ_iω_i) Φᵀ M.

    `ratios` [-]; returns [N·s/m].

    >>> modal_damping([[1000.0]], [[4000.0]], 0.05)
    array([[200.]])
    """
    modes = natural_modes(mass, stiffness)
    size = modes.circular_frequency.size
    values = np.atleast_1d(np.asarray(ratios, dtype=np.float64))
    if values.size not in {1, size}:
        raise InputError(
            f"Give one damping ratio for all modes, or {size}, one for each",
            value=f"{values.size} ratios",
            remedy="Write 0.02 for 2 % in all modes",
        )
    if not ((values >= 0.0) & (values < 1.0)).all():
        raise InputError(
            "Damping ratios must lie in [0, 1)",
            value=values.tolist(),
            remedy="Give fractions of critical damping, 0.02 for 2 %",
        )
    spread = np.asarray(mass) @ modes.shapes
    return np.asarray((spread * (2.0 * values * modes.circular_frequency)) @ spread.T)


def rayleigh_damping(
    mass: ArrayLike, stiffness: ArrayLike, ratios: tuple[float, float], frequencies: tuple[float, float]
) -> Array:
    """Damping matrix C = a₀M + a₁K that has two damping ratios at two frequencies (Rayleigh).

    `ratios` [-]; `frequencies` [Hz]; returns [N·s/m].

    >>> damping = rayleigh_damping([[2.0]], [[8.0]], (0.02, 0.02), (0.1, 1.0))
    >>> bool(damping[0, 0] > 0.0)
    True
    """
    first, second = (2.0 * np.pi * f for f in frequencies)
    if not (first > 0.0 and second > 0.0 and first != second):
        raise InputError(
            "Rayleigh damping needs two different positive frequencies",
            value=f"{frequencies} Hz",
            remedy="Give two frequencies in hertz",
        )
    system = 0.5 * np.array([[1.0 / first, first], [1.0 / second, second]])
    mass_factor, stiffness_factor = np.linalg.solve(system, np.asarray(ratios, dtype=np.float64))
    squares = scipy.linalg.eigh(mass, stiffness, eigvals_only=True)  # 1/ω², zero without a mass
    omega = 1.0 / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
    lowest = 0.5 * (mass_factor / omega + stiffness_factor * omega).min()
    if lowest < 0.0:
        raise InputError(
            "Rayleigh damping must leave every mode a positive damping ratio",
            value=f"{significant(lowest)} for some mode",
            remedy="Choose ratios or frequencies that lie closer together",
        )
    return np.asarray(mass_factor * np.asarray(mass) + stiffness_factor * np.asarray(stiffness))


_QUANTITIES = {"mass": "mass", "damping": "damping coefficient", "stiffness": "stiffness"}
_SYMMETRY = 1e-6  # of the largest entry: printed matrices are rounded
_ROUNDING = 1e-9  # of the largest eigenvalue: a semi-definite matrix in double precision


def square_matrix(values: ArrayLike, name: str) -> Array:
    """Return a finite, square, symmetric matrix, made exactly symmetric."""
    matrix = np.array(values, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.size == 0:  # noqa: PLR2004
        raise InputError(
            f"The {name} must be square", value=f"shape {matrix.shape}", remedy="Give n rows of n numbers"
        )
    quantity = next((_QUANTITIES[word] for word in _QUANTITIES if word in name), "number")
    largest = float(np.abs(matrix).max())
    require_physical(quantity, largest, zero=True, label=f"largest entry of the {name}")
    difference = np.abs(matrix - matrix.T)
    if difference.max() > _SYMMETRY * np.abs(matrix).max():
        row, column = np.unravel_index(int(np.argmax(difference)), matrix.shape)
        raise InputError(
            f"The {name} must be symmetric",
            value=f"{matrix[row, column]:g} in row {row + 1}, column {column + 1} and "
            f"{matrix[column, row]:g} in row {column + 1}, column {row + 1}",
            remedy="Correct one of the two entries",
        )
    symmetric = np.asarray(0.5 * (matrix + matrix.T))
    symmetric.setflags(write=False)
    return symmetric


def matrices_of_one_size(mass: ArrayLike, damping: ArrayLike, stiffness: ArrayLike) -> dict[str, Array]:
    """Return the matrices of a structure by their names, each as :func:`square_matrix` makes it."""
    given = {"mass": mass, "damping": damping, "stiffness": stiffness}
    matrices = {name: square_matrix(values, f"{name} matrix") for name, values in given.items()}
    rows = [len(matrix) for matrix in matrices.values()]
    if len(set(rows)) > 1:
        raise InputError(
            "Mass, damping and stiffness matrices must be of the same size",
            value=f"{rows[0]}, {rows[1]} and {rows[2]} rows",
            remedy="Give one row and column for each degree of freedom",
        )
    return matrices


def influence_vector(influence: ArrayLike | None, size: int) -> Array:
    """Return how far each degree of freedom moves with the ground, shape (n,); ones by default."""
    vector = np.ones(size) if influence is None else np.array(influence, dtype=float)
    if vector.shape != (size,) or not np.isfinite(vector).all() or not vector.any():
        raise InputError(
            f"The influence vector needs {size} finite numbers that are not all zero",
            value=vector.tolist(),
            remedy="Give 1 for each degree of freedom that moves with the ground, else 0",
        )
    vector.setflags(write=False)
    return vector


def lowest_eigenvalue(matrix: Array) -> tuple[float, float]:
    """Lowest eigenvalue of a symmetric matrix, and the largest modulus, in its units."""
    eigenvalues = np.linalg.eigvalsh(matrix)
    return float(eigenvalues[0]), float(np.abs(eigenvalues).max())


def require_positive_definite(matrix: Array, name: str, remedy: str) -> None:
    """Raise an InputError that names the lowest eigenvalue unless the matrix is positive definite."""
    lowest, largest = lowest_eigenvalue(matrix)
    if lowest <= _ROUNDING**2 * largest or lowest <= 0.0:
        raise InputError(
            f"The {name} must be positive definite", value=f"the eigenvalue {lowest:g}", remedy=remedy
        )


def require_positive_semidefinite(matrix: Array, name: str, remedy: str) -> None:
    """Raise an InputError that names the lowest eigenvalue if the matrix has a negative one."""
    lowest, largest = lowest_eigenvalue(matrix)
    if lowest < -_ROUNDING * largest:
        raise InputError(
            f"The {name} must not have a negative eigenvalue", value=f"{lowest:g}", remedy=remedy
        )


def place_of(names: tuple[str, ...], name: str | int) -> int:
    """Place of a degree of freedom among the names of all."""
    if str(name) not in names:
        raise InputError(
            "No such degree of freedom",
            value=repr(name),
            remedy=f"Name one of {', '.join(names)}",
        )
    return names.index(str(name))


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Undamped modes of a structure, lowest first."""

    circular_frequency: Array  # ω_i [rad/s], shape (modes,)
    shapes: Array  # Mode shapes φ_i in columns, of unit modal mass [1/√kg], shape (degrees of freedom, modes)

    @property
    def frequency(self) -> Array:
        """Natural frequencies [Hz], shape (modes,)."""
        return np.asarray(self.circular_frequency / (2.0 * math.pi))


def natural_modes(mass: ArrayLike, stiffness: ArrayLike) -> Modes:
    """Undamped modes of mass and stiffness matrices.

    >>> natural_modes([[2.0]], [[8.0]]).circular_frequency
    array([2.])
    """
    squares, shapes = scipy.linalg.eigh(np.asarray(stiffness), np.asarray(mass))
    return Modes(circular_frequency=np.sqrt(squares), shapes=shapes)


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """A linear elastic structure of several degrees of freedom under one ground motion.

    >>> frame = Frame(mass=[[1000.0]], damping=[[125.7]], stiffness=[[39478.4]])
    >>> frame.modes.frequency.round(3), frame.damping_ratios.round(3)
    (array([1.]), array([0.01]))
    """

    # mass, damping, stiffness: Symmetric matrices M [kg], C [N·s/m] and K [N/m] of the whole structure, shape
    # (n, n); M and K are positive definite, C has no negative eigenvalue
    mass: Array
    damping: Array
    stiffness: Array
    # Displacement ι of the degrees of freedom when the ground moves by one [-], shape (n,); ones by default,
    # as for horizontal displacements of floors
    influence: Array = None  # type: ignore[assignment]  # ones of the right length
    names: tuple[str, ...] = ()  # Names of the degrees of freedom; "1" to "n" by default

    def __post_init__(self) -> None:
        for field, matrix in matrices_of_one_size(self.mass, self.damping, self.stiffness).items():
            object.__setattr__(self, field, matrix)
        object.__setattr__(self, "influence", influence_vector(self.influence, self.size))
        names = tuple(self.names) or tuple(str(k + 1) for k in range(self.size))
        if len(names) != self.size or len(set(names)) != self.size:
            raise InputError(
                f"The {self.size} degrees of freedom need as many different names",
                value=list(names),
                remedy="Give each degree of freedom a name of its own",
            )
        object.__setattr__(self, "names", names)
        require_positive_definite(self.mass, "mass matrix", "Give every degree of freedom a positive mass")
        require_positive_definite(
            self.stiffness, "stiffness matrix", "A structure that can move without a force is not supported"
        )
        require_positive_semidefinite(self.damping, "damping matrix", "Damping must not feed energy in")

    @classmethod
    def from_structure(cls, structure: Structure, mass: float = 1.0) -> Self:
        """Return the one-mode structure as a frame of one degree of freedom of a mass [kg]."""
        w0 = structure.circular_frequency
        damping = 2.0 * structure.damping_ratio * w0 * mass
        return cls(
            mass=np.array([[mass]]), damping=np.array([[damping]]), stiffness=np.array([[w0**2 * mass]])
        )

    @property
    def size(self) -> int:
        """Number n of degrees of freedom."""
        return int(self.mass.shape[0])

    @cached_property
    def modes(self) -> Modes:
        """Undamped modes."""
        return natural_modes(self.mass, self.stiffness)

    @cached_property
    def damping_ratios(self) -> Array:
        """Modal damping ratios φᵀCφ/(2ω) [-], coupling between modes left out, shape (n,)."""
        shapes = self.modes.shapes
        modal = np.einsum("di,de,ei->i", shapes, self.damping, shapes)
        return np.asarray(modal / (2.0 * self.modes.circular_frequency))

    @cached_property
    def poles(self) -> Spectrum:
        """Poles of the structure with positive imaginary part [1/s], lowest first, shape (n,) or fewer."""
        eigenvalues = np.linalg.eigvals(self.state_matrix)
        oscillating = eigenvalues[eigenvalues.imag > 0.0]
        return np.asarray(oscillating[np.argsort(np.abs(oscillating))])

    @cached_property
    def state_matrix(self) -> Array:
        """Matrix of the first-order system of x and x', shape (2n, 2n)."""
        n = self.size
        matrix = np.zeros((2 * n, 2 * n))
        matrix[:n, n:] = np.eye(n)
        matrix[n:, :n] = -np.linalg.solve(self.mass, self.stiffness)
        matrix[n:, n:] = -np.linalg.solve(self.mass, self.damping)
        return matrix

    def degree_of_freedom(self, name: str | int) -> int:
        """Place of a degree of freedom from its name, or from its number, which starts from 1."""
        return place_of(self.names, name)

    def dynamic_stiffness(self, s: Spectrum) -> Spectrum:
        """Dynamic stiffness M s² + C s + K [N/m] at s [rad/s], shape (…, n, n)."""
        s = np.asarray(s)[..., np.newaxis, np.newaxis]
        return np.asarray(s**2 * self.mass + s * self.damping + self.stiffness)


def exact_step(dynamics: Array, loads: Array, step: float) -> tuple[Array, Array, Array]:
    """Transition over a step and the effect of loads that are linear in it.

    `step` [s].
    Returns `transition, early, late`: e^(Ah), and the effects of the loads' values at the begin and the end
    of the step, shapes (n, n) and twice (n, m).

    >>> transition, early, late = exact_step(np.array([[0.0]]), np.array([[1.0]]), 0.5)
    >>> float(transition[0, 0]), float(early[0, 0]), float(late[0, 0])
    (1.0, 0.25, 0.25)
    """
    n, m = loads.shape
    system = np.zeros((n + 2 * m, n + 2 * m))
    system[:n, :n] = dynamics * step
    system[:n, n : n + m] = loads * step
    system[n : n + m, n + m :] = np.eye(m)
    flow = scipy.linalg.expm(system)
    late = flow[:n, n + m :]
    return flow[:n, :n].copy(), flow[:n, n : n + m] - late, late


def reference_response(frame: Frame, ground: Array, step: float) -> Array:
    """Exact displacements of the undivided linear structure [m], shape (degrees of freedom, samples).

    `ground` [m/s²]; `step` [s].
    """
    loads = np.concatenate([np.zeros(frame.size), -frame.influence])[:, np.newaxis]
    transition, early, late = exact_step(frame.state_matrix, loads, step)
    return follow_load(transition, early[:, 0].copy(), late[:, 0].copy(), ground, frame.size)


@compiled
def follow_load(transition: Array, early: Array, late: Array, ground: Array, output_count: int) -> Array:
    """First states of a linear system under a load that is linear in every step, shape (shown, samples)."""
    states, samples = transition.shape[0], ground.size
    z, z_next = np.zeros(states), np.zeros(states)
    outputs = np.zeros((output_count, samples))
    for k in range(samples - 1):
        for i in range(states):
            total = early[i] * ground[k] + late[i] * ground[k + 1]
            for j in range(states):
                total += transition[i, j] * z[j]
            z_next[i] = total
        for i in range(states):
            z[i] = z_next[i]
        for i in range(output_count):
            outputs[i, k + 1] = z[i]
    return outputs


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """The specimen without further effects: force = k·x + c·v + m·a of the piston's motion.

    >>> Specimen(stiffness=2000.0).damping
    0.0
    """

    stiffness: float  # Stiffness k [N/m], not negative
    damping: float = 0.0  # Damping coefficient c [N·s/m]
    mass: float = 0.0  # Moving mass m [kg], not negative

    def __post_init__(self) -> None:
        require_physical("stiffness", self.stiffness, zero=True, label="stiffness of the specimen")
        require_physical(
            "damping coefficient",
            self.damping,
            zero=True,
            signed=True,
            label="damping coefficient of the specimen",
        )
        require_physical("mass", self.mass, zero=True, label="mass of the specimen")


def floor_interface(frame: Frame, name: str | int) -> Array:
    """γ of a specimen between the ground and a degree of freedom, shape (n,)."""
    interface = np.zeros(frame.size)
    interface[frame.degree_of_freedom(name)] = 1.0
    return interface


def drift_interface(frame: Frame, upper: str | int, lower: str | int) -> Array:
    """γ of a specimen between two degrees of freedom, shape (n,).

    Raises InputError if both are the same.
    """
    interface = floor_interface(frame, upper)
    if frame.degree_of_freedom(lower) == frame.degree_of_freedom(upper):
        raise InputError(
            "A drift needs two different degrees of freedom",
            value=str(upper),
            remedy="Name the floors above and below the storey",
        )
    interface[frame.degree_of_freedom(lower)] = -1.0
    return interface


def add_specimen(frame: Frame, interface: Sequence[float] | Array, specimen: Specimen) -> Frame:
    """Return the frame with a specimen added at an interface: the whole of which it is then a part."""
    interface_product = np.outer(interface, interface)
    return Frame(
        mass=frame.mass + specimen.mass * interface_product,
        damping=frame.damping + specimen.damping * interface_product,
        stiffness=frame.stiffness + specimen.stiffness * interface_product,
        influence=frame.influence,
        names=frame.names,
    )
