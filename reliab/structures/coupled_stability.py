"""The delay at which a test with several actuators loses stability, and the motion in which it does.

With measured over commanded displacement G e^(−sτ) at the interface, G a matrix of gains, a root of
``det(I + L(s) e^(−sτ)) = 0``, L = Γᵀ(M_n s² + C_n s + K_n)⁻¹Γ Z G, crosses the imaginary axis at iΩ only
where an eigenvalue λ of L(iΩ) has modulus one, with the delay τ = (π + arg λ mod 2π)/Ω. Its eigenvector is
the interface's motion there. Frequencies are searched on a grid that resolves every mode, and refined.
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array, Spectrum
from reliab.errors import InputError
from reliab.structures.partition import Partition

_EVERYWHERE = 3000
_AROUND_A_MODE = np.sinh(np.linspace(-6.0, 6.0, 161)) * 0.1  # in half-widths of the resonance
_RANGE = (0.02, 30.0)  # of the lowest and the highest natural frequency


@dataclass(frozen=True, kw_only=True, eq=False)
class CoupledLimit:
    """Where a test with several actuators loses stability."""

    delay: float  # Critical delay that all actuators have in common [s]; infinite where none is critical
    frequency: float  # Of the oscillation at the limit [Hz]; NaN where there is none
    # Interface displacements in that oscillation, the largest one, shape (p,)
    direction: Array


def coupled_limit(partition: Partition, gain: Array | None = None) -> CoupledLimit:
    """Delay of all actuators at which a test becomes unstable.

    `gain`: measured over commanded displacement at the interface [-], shape (p, p); the identity by default.

    Two like structures side by side have the critical delay of each, 6.368 ms for 1 Hz and 2 % damping:

    >>> w0 = 2.0 * np.pi
    >>> partition = Partition(mass=np.eye(2), damping=0.04 * w0 * np.eye(2),
    ...     stiffness=w0**2 * np.eye(2), interface=np.eye(2), specimen_stiffness=w0**2 * np.eye(2))
    >>> round(1000.0 * coupled_limit(partition).delay, 3)
    6.368
    """
    whole = partition.with_masses
    gains = np.eye(whole.degrees) if gain is None else np.asarray(gain, dtype=float)
    _require_stable_without_delay(whole, gains)
    omega = frequencies_of_loop(whole)
    values = _tracked(_loop(whole, gains, omega))
    limit, at = math.inf, math.nan
    excess = np.log(np.maximum(np.abs(values), 1e-300))
    for place, branch in zip(*np.nonzero(np.diff(np.sign(excess), axis=0)), strict=True):
        near = values[place, branch]
        low, high = omega[place], omega[place + 1]
        crossing = _refined(whole, gains, low, high, near)
        value = _nearest(whole, gains, crossing, near)
        delay = float((math.pi + np.angle(value)) % (2.0 * math.pi)) / crossing
        if delay < limit:
            limit, at = delay, crossing
    if math.isinf(limit):
        return CoupledLimit(delay=limit, frequency=math.nan, direction=np.zeros(whole.degrees))
    return CoupledLimit(
        delay=limit, frequency=at / (2.0 * math.pi), direction=_direction(whole, gains, at, limit)
    )


def _numerical(partition: Partition) -> tuple[Array, Array, Array]:
    return partition.numerical_mass, partition.numerical_damping, partition.numerical_stiffness


def _loop(partition: Partition, gains: Array, omega: Array) -> Spectrum:
    """L(iω) at frequencies [rad/s], shape (frequencies, p, p)."""
    s = np.asarray(1j * np.atleast_1d(omega), dtype=np.complex128)
    square = s[:, np.newaxis, np.newaxis]
    mass, damping, stiffness = _numerical(partition)
    moved = np.linalg.solve(square**2 * mass + square * damping + stiffness, partition.interface + 0j)
    return np.asarray((partition.interface.T @ moved) @ partition.impedance(s) @ gains)


def frequencies_of_loop(partition: Partition) -> Array:
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
    points.append(np.geomspace(_RANGE[0] * slowest, _RANGE[1] * fastest, _EVERYWHERE))
    every = np.unique(np.concatenate(points))
    return np.asarray(every[every >= _RANGE[0] * slowest])


def _tracked(loops: Spectrum) -> Spectrum:
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


def _refined(partition: Partition, gains: Array, low: float, high: float, near: complex) -> float:
    def excess(omega: float) -> float:
        return math.log(abs(_nearest(partition, gains, omega, near)))

    if excess(low) * excess(high) > 0.0:  # two eigenvalues changed places within the step
        return 0.5 * (low + high)
    return float(scipy.optimize.brentq(excess, low, high, xtol=1e-13 * high, rtol=1e-14))


def _direction(partition: Partition, gains: Array, omega: float, delay: float) -> Array:
    """Interface displacements of the undamped oscillation at the limit, in phase with the largest."""
    s = 1j * omega
    mass, damping, stiffness = _numerical(partition)
    impedance = partition.impedance(np.array([s]))[0]
    gamma = partition.interface
    feedback = gamma @ (impedance @ gains * np.exp(-s * delay)) @ gamma.T
    dynamic = s**2 * mass + s * damping + stiffness + feedback
    shape = gamma.T @ np.linalg.svd(dynamic)[2][-1].conj()
    largest = shape[np.argmax(np.abs(shape))]
    return np.asarray((shape / largest).real)


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
            "The hybrid test must be stable with actuators without delay",
            value="an unstable partition",
            remedy="Leave more stiffness, damping or mass to the computer, or couple the actuators less",
        )
