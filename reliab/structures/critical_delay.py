"""The delay at which a test loses stability, and the motion in which it does, for any number of actuators.

With measured over commanded displacement G e^(−sτ) at the interface, G a matrix of gains, a root of
``det(I + L(s) e^(−sτ)) = 0``, L = Γᵀ(M_n s² + C_n s + K_n)⁻¹Γ Z G, crosses the imaginary axis at iΩ only
where an eigenvalue λ of L(iΩ) has modulus one, with the delay ::

    τ = (π + arg λ mod 2π)/Ω

The smallest of these is the critical delay, and the eigenvector is the interface's motion there. For one
actuator the Ω are the imaginary eigenvalues of a Hamiltonian matrix made of a state-space model of L (Boyd,
Balakrishnan and Kabamba 1989, *Math. Control Signals Systems* 2, 207-219), so that none is missed. It knows
singular values and not eigenvalues, so that for several actuators the Ω are searched on a grid that resolves
every mode, and refined.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

_AXIS_TOLERANCE = 1e-6  # real part over modulus of an eigenvalue that may lie on the imaginary axis
_NEWTON_STEPS = 40
_GRID_POINTS = 3000
_AROUND_A_MODE = np.sinh(np.linspace(-6.0, 6.0, 161)) * 0.1  # in half-widths of the resonance
_RANGE = (0.02, 30.0)  # of the lowest and the highest natural frequency


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityLimit:
    """Where a test loses stability."""

    # Critical delay that all actuators have in common [s]; infinite where none is critical, and zero where
    # any is, because the specimen has too much of the mass
    delay: float
    frequency: float  # Of the oscillation at the limit [Hz]; NaN where there is no finite one
    # Interface displacements in that oscillation, the largest one, shape (p,); zero where there is none
    direction: Array


def stability_limit(partition: Partition, gain: float | Array = 1.0) -> StabilityLimit:
    """Delay of all actuators at which a test becomes unstable.

    `gain`: measured over commanded displacement at the interface [-], of all alike or of shape (p, p).

    The paper's 6.4 ms for 1 Hz and 2 % damping, which two like structures side by side have as well:

    >>> w0 = 2.0 * np.pi
    >>> for one in (np.eye(1), np.eye(2)):
    ...     partition = Partition(mass=one, damping=0.04 * w0 * one, stiffness=w0**2 * one, interface=one,
    ...         specimen_stiffness=w0**2 * one)
    ...     print(round(1000.0 * stability_limit(partition).delay, 3))
    6.368
    6.368
    """
    regular = partition.nonsingular_form
    gains = np.asarray(gain, dtype=float)
    gains = gains if gains.ndim else gains * np.eye(regular.degrees)
    _require_stable_without_delay(regular, gains)
    limit, limit_frequency = math.inf, math.nan
    if _too_heavy(regular, gains):
        limit = 0.0
    else:
        find_crossings = _crossings_of_one if regular.degrees == 1 else _crossings_of_several
        for omega, value in find_crossings(regular, gains):
            delay = float((math.pi + np.angle(value)) % (2.0 * math.pi)) / omega
            if delay < limit:
                limit, limit_frequency = delay, omega
    return StabilityLimit(
        delay=limit,
        frequency=limit_frequency / (2.0 * math.pi),
        direction=_direction(regular, gains, limit_frequency, limit),
    )


def _require_stable_without_delay(partition: Partition, gains: Array) -> None:
    gamma = partition.interface
    parts = zip(
        _numerical(partition),
        (partition.specimen_mass, partition.specimen_damping, partition.specimen_stiffness),
        strict=True,
    )
    mass, damping, stiffness = (numerical + gamma @ (part @ gains) @ gamma.T for numerical, part in parts)
    size = partition.size
    dynamics = np.block(
        [
            [np.zeros((size, size)), np.eye(size)],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping)],
        ]
    )
    if not np.linalg.eigvals(dynamics).real.max() < 0.0:
        raise InputError(
            "This hybrid test is unstable even without delay",
            value=f"an unstable partition with a gain of {np.array2string(np.squeeze(gains), precision=4)}",
            remedy="Leave more stiffness, damping or mass to the computer, or couple the actuators less",
        )


def _too_heavy(partition: Partition, gains: Array) -> bool:
    """Whether L has an eigenvalue of modulus one or more at the highest frequencies."""
    if not partition.specimen_mass.any():
        return False
    gamma = partition.interface
    specimen_inertia = gamma @ (partition.specimen_mass @ gains) @ gamma.T
    return not np.abs(scipy.linalg.eigvals(specimen_inertia, partition.numerical_mass)).max() < 1.0


def _numerical(partition: Partition) -> tuple[Array, Array, Array]:
    return partition.numerical_mass, partition.numerical_damping, partition.numerical_stiffness


def _crossings_of_one(partition: Partition, gains: Array) -> Iterator[tuple[float, complex]]:
    """Ω [rad/s] at which |L(iΩ)| = 1, increasing, and L there."""
    a, b, c, d = _state_space(partition)
    c, d = gains[0, 0] * c, gains[0, 0] * d
    identity = np.eye(b.size)

    def modulus(omega: float) -> tuple[float, float]:
        """Excess ln|L| and its slope over Ω."""
        response = np.linalg.solve(1j * omega * identity - a, np.column_stack([b, b]))[:, 0]
        second_response = np.linalg.solve(1j * omega * identity - a, response)
        value = c @ response + d
        return float(np.log(abs(value))), float((-1j * (c @ second_response) / value).real)

    for near in _imaginary_eigenvalues(a, b, c, d).tolist():
        omega = near
        for _ in range(_NEWTON_STEPS):
            excess, slope = modulus(omega)
            if slope == 0.0 or abs(excess) < 1e-13:  # noqa: PLR2004 - rounding
                break
            omega -= excess / slope
        yield float(omega), complex(c @ np.linalg.solve(1j * omega * identity - a, b) + d)


def _state_space(partition: Partition) -> tuple[Array, Array, Array, float]:
    """Return A, B, C, D of L without gain, in modal coordinates of the frame, for one actuator."""
    shapes = partition.frame.modes.shapes
    gamma = shapes.T @ partition.direction
    mass, damping, stiffness = (shapes.T @ matrix @ shapes for matrix in _numerical(partition))
    n = gamma.size
    scale = float(partition.frame.modes.circular_frequency[0])  # velocities in units of ω₁x
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = scale * np.eye(n)
    a[n:, :n] = -np.linalg.solve(mass, stiffness) / scale
    a[n:, n:] = -np.linalg.solve(mass, damping)
    acceleration = np.linalg.solve(mass, gamma)
    b = np.concatenate([np.zeros(n), acceleration / scale])
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    inertia_row = m * scale * (gamma @ a[n:])
    c_row = np.concatenate([k * gamma, c * scale * gamma]) + inertia_row
    return a, b, c_row, float(m * gamma @ acceleration)


def _imaginary_eigenvalues(a: Array, b: Array, c: Array, d: float) -> Array:
    """Where |C(iω − A)⁻¹B + D| = 1 [rad/s], increasing."""
    r = d * d - 1.0
    hamiltonian = np.block(
        [
            [a - np.outer(b, c) * (d / r), -np.outer(b, b) / r],
            [np.outer(c, c) / r, -a.T + np.outer(c, b) * (d / r)],
        ]
    )
    eigenvalues = np.linalg.eigvals(hamiltonian)
    near = (np.abs(eigenvalues.real) < _AXIS_TOLERANCE * np.abs(eigenvalues)) & (eigenvalues.imag > 0.0)
    return np.asarray(np.sort(eigenvalues[near].imag))


def _crossings_of_several(partition: Partition, gains: Array) -> Iterator[tuple[float, complex]]:
    """Ω [rad/s] at which an eigenvalue of L(iΩ) has modulus one, and the eigenvalue."""
    omega = _frequencies_of_loop(partition)
    values = _track_eigenvalues(_loop(partition, gains, omega))
    excess = np.log(np.maximum(np.abs(values), 1e-300))
    for place, branch in zip(*np.nonzero(np.diff(np.sign(excess), axis=0)), strict=True):
        near = complex(values[place, branch])
        crossing = _refine_root(partition, gains, float(omega[place]), float(omega[place + 1]), near)
        yield crossing, _nearest(partition, gains, crossing, near)


def _loop(partition: Partition, gains: Array, omega: Array) -> Spectrum:
    """L(iω) at frequencies [rad/s], shape (frequencies, p, p)."""
    s = np.asarray(1j * np.atleast_1d(omega), dtype=np.complex128)
    square = s[:, np.newaxis, np.newaxis]
    mass, damping, stiffness = _numerical(partition)
    displacement = np.linalg.solve(square**2 * mass + square * damping + stiffness, partition.interface + 0j)
    return np.asarray((partition.interface.T @ displacement) @ partition.impedance(s) @ gains)


def _frequencies_of_loop(partition: Partition) -> Array:
    """Frequencies [rad/s] close enough to each other to follow the loop of any actuators, shape (n,)."""
    mass, damping, stiffness = _numerical(partition)
    points = []
    for m, c, k in ((mass, damping, stiffness), (partition.mass, partition.damping, partition.stiffness)):
        squares, shapes = scipy.linalg.eigh(k, m)
        omega = np.sqrt(np.maximum(squares, 0.0))
        width = 0.5 * np.einsum("di,de,ei->i", shapes, c, shapes)
        points.append((omega[:, np.newaxis] + width[:, np.newaxis] * _AROUND_A_MODE).ravel())
        points.append(omega)
    fastest = float(omega.max())
    slowest = float(omega.min())
    points.append(np.geomspace(_RANGE[0] * slowest, _RANGE[1] * fastest, _GRID_POINTS))
    grid = np.unique(np.concatenate(points))
    return np.asarray(grid[grid >= _RANGE[0] * slowest])


def _track_eigenvalues(loops: Spectrum) -> Spectrum:
    """Eigenvalues over frequency, each in one column."""
    values = np.linalg.eigvals(loops)
    for k in range(1, len(values)):
        costs = np.abs(values[k - 1][:, np.newaxis] - values[k])
        _, order = scipy.optimize.linear_sum_assignment(costs)
        values[k] = values[k][order]
    return np.asarray(values)


def _nearest(partition: Partition, gains: Array, omega: float, near: complex) -> complex:
    values = np.linalg.eigvals(_loop(partition, gains, np.array([omega]))[0])
    return complex(values[np.argmin(np.abs(values - near))])


def _refine_root(partition: Partition, gains: Array, low: float, high: float, near: complex) -> float:
    def excess(omega: float) -> float:
        return math.log(abs(_nearest(partition, gains, omega, near)))

    if excess(low) * excess(high) > 0.0:  # two eigenvalues changed places within the step
        return 0.5 * (low + high)
    return float(scipy.optimize.brentq(excess, low, high, xtol=1e-13 * high, rtol=1e-14))


def _direction(partition: Partition, gains: Array, omega: float, delay: float) -> Array:
    """Interface displacements of the undamped oscillation at the limit, in phase with the largest."""
    if math.isnan(omega):
        return np.zeros(partition.degrees)
    s = 1j * omega
    mass, damping, stiffness = _numerical(partition)
    impedance = partition.impedance(np.array([s]))[0]
    gamma = partition.interface
    feedback = gamma @ (impedance @ gains * np.exp(-s * delay)) @ gamma.T
    dynamic = s**2 * mass + s * damping + stiffness + feedback
    shape = gamma.T @ np.linalg.svd(dynamic)[2][-1].conj()
    largest = shape[np.argmax(np.abs(shape))]
    return np.asarray((shape / largest).real)
