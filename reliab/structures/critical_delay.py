"""The exact critical delay of a partitioned structure of any number of degrees of freedom.

With an actuator k_p e^(−sτ) the hybrid test is stable as long as no root of ``1 + k_p L(s) e^(−sτ) = 0`` lies
in the right half-plane, L = Z(s) γᵀ(M_n s² + C_n s + K_n)⁻¹γ. A root crosses the imaginary axis at iΩ only
where |k_p L(iΩ)| = 1, whatever the delay. These Ω are the imaginary eigenvalues of a Hamiltonian matrix made
of a state-space model of L (Boyd, Balakrishnan and Kabamba 1989, *Math. Control Signals Systems* 2, 207-219),
so that none is missed, and the corresponding delay follows from the phase::

    τ = (π + arg L(iΩ) mod 2π)/Ω

The smallest is the critical delay.
"""

import math

import numpy as np

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.structures.partition import Partition

_ON_AXIS = 1e-6  # real part over modulus of an eigenvalue that may lie on the imaginary axis
_NEWTON_STEPS = 40


def open_loop(partition: Partition) -> tuple[Array, Array, Array, float]:
    """Return A, B, C, D of L = Z γᵀ(M_n s² + C_n s + K_n)⁻¹ γ, in modal coordinates of the frame."""
    shapes = partition.frame.modes.shapes
    gamma = shapes.T @ partition.direction
    mass, damping, stiffness = (
        shapes.T @ matrix @ shapes
        for matrix in (
            partition.numerical_mass,
            partition.numerical_damping,
            partition.numerical_stiffness,
        )
    )
    n = gamma.size
    scale = float(partition.frame.modes.circular_frequency[0])  # velocities in units of ω₁x
    a = np.zeros((2 * n, 2 * n))
    a[:n, n:] = scale * np.eye(n)
    a[n:, :n] = -np.linalg.solve(mass, stiffness) / scale
    a[n:, n:] = -np.linalg.solve(mass, damping)
    accelerated = np.linalg.solve(mass, gamma)
    b = np.concatenate([np.zeros(n), accelerated / scale])
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    of_acceleration = m * scale * (gamma @ a[n:])
    c_row = np.concatenate([k * gamma, c * scale * gamma]) + of_acceleration
    return a, b, c_row, float(m * gamma @ accelerated)


def is_stable_without_delay(partition: Partition, gain: float) -> bool:
    """Whether the hybrid test with an actuator of a gain [-] and no delay is stable."""
    a, b, c, d = open_loop(partition)
    closed = a - np.outer(b, c) * (gain / (1.0 + gain * d))
    return bool(np.linalg.eigvals(closed).real.max() < 0.0)


def crossings(partition: Partition, gain: float = 1.0) -> Array:
    """Frequencies Ω at which |k_p L(iΩ)| = 1 [rad/s], increasing, shape (crossings,)."""
    a, b, c, d = open_loop(partition)
    c, d = gain * c, gain * d
    r = d * d - 1.0
    hamiltonian = np.block(
        [
            [a - np.outer(b, c) * (d / r), -np.outer(b, b) / r],
            [np.outer(c, c) / r, -a.T + np.outer(c, b) * (d / r)],
        ]
    )
    eigenvalues = np.linalg.eigvals(hamiltonian)
    near = eigenvalues[(np.abs(eigenvalues.real) < _ON_AXIS * np.abs(eigenvalues)) & (eigenvalues.imag > 0.0)]
    identity = np.eye(a.shape[0])

    def modulus(omega: float) -> tuple[float, float]:
        """Excess ln|k_p L| and its slope over Ω."""
        solved = np.linalg.solve(1j * omega * identity - a, np.column_stack([b, b]))[:, 0]
        again = np.linalg.solve(1j * omega * identity - a, solved)
        value = c @ solved + d
        return float(np.log(abs(value))), float((-1j * (c @ again) / value).real)

    refined = []
    for omega in np.sort(near.imag):
        for _ in range(_NEWTON_STEPS):
            excess, slope = modulus(omega)
            if slope == 0.0 or abs(excess) < 1e-13:  # noqa: PLR2004 - rounding
                break
            omega = omega - excess / slope  # noqa: PLW2901 - Newton's iteration
        refined.append(float(omega))
    return np.asarray(refined)


def critical_delay(partition: Partition, gain: float = 1.0) -> tuple[float, float]:
    """Delay at which the hybrid test loses stability, and the frequency at which it then oscillates.

    `gain` [-].
    Returns `delay`: critical delay τ_c [s]; infinite where no delay makes the test unstable, and zero where
    any does, because k_p m_e γᵀM_n⁻¹γ reaches 1.
    Returns `frequency`: frequency [Hz] of the oscillation at the limit; NaN where there is no finite one.

    The paper's 6.4 ms for 1 Hz and 2 % damping:

    >>> from reliab.structures.structure import Structure
    >>> structure = Structure(frequency=1.0, damping_ratio=0.02)
    >>> delay, frequency = critical_delay(Partition.of_structure(structure))
    >>> round(1000 * delay, 3), round(frequency, 2)
    (6.368, 1.0)
    """
    if not is_stable_without_delay(partition, gain):
        raise InputError(
            "The hybrid test must be stable with an actuator without delay",
            value=f"an unstable partition at k_p = {gain:g}",
            remedy="Leave more stiffness, damping or mass to the computer",
        )
    a, b, c, d = open_loop(partition)
    if abs(gain * d) >= 1.0:
        return 0.0, math.nan
    limit, frequency = math.inf, math.nan
    for omega in crossings(partition, gain).tolist():
        value = gain * (c @ np.linalg.solve(1j * omega * np.eye(b.size) - a, b) + d)
        delay = float((math.pi + np.angle(value)) % (2.0 * math.pi)) / omega
        if delay < limit:
            limit, frequency = delay, omega / (2.0 * math.pi)
    return limit, frequency
