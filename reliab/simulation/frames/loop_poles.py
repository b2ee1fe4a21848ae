"""The hybrid test of a partitioned frame reduced to one pole pair per mode and a fast remainder.

With g = γᵀD⁻¹γ of the undivided structure, D = M s² + C s + K, and σ = k_p e^(−sτ), the poles of the test
are the roots of ``1 + Z(s)(σ(s) − 1)g(s) = 0``. Each pole λ of the structure grows into one of them as the
actuator's error grows, and is traced by Newton's iteration on ``(s − λ)(1 + Z(σ − 1)g)``, which has
no singularity at λ, so that a mode that the specimen does not drive stays where it is. At a pole p the
response is that of the shape v with ``(D + Z(σ − 1)γγᵀ)v = 0``; since the matrix is symmetric the residue
of the floors under −a_g is ``v vᵀMι / vᵀ(dD/ds + d(Z(σ − 1))/ds γγᵀ)v``. The remainder of the transfer
function is nearly constant over the frequencies of earthquakes; a first-order lag with its value and slope at
s = 0 approximates it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.errors import InputError
from reliab.structures.partition import Partition

_PARTS = 4  # in which the actuator's error is approached
_NEWTON_STEPS = 30
_CONVERGED = 1e-12
_CIRCLE = 8  # points around s = 0 from which value and slope there are taken
_UNKNOWN_POLES = np.errstate(over="ignore", invalid="ignore", divide="ignore")
"""A pole that is not found runs away, and is NaN in what is computed from it."""


@dataclass(frozen=True, kw_only=True)
class PoleLoop:
    """Poles and residues of one output of the test, one column per cell."""

    # poles, residues: Poles p [1/s] with positive imaginary part and residues r [s] of the response to −a_g,
    # shape (modes, cells); their conjugates belong to them. NaN where Newton's iteration did not converge
    poles: Spectrum
    residues: Spectrum
    # remainder, remainder_time: Static value R [s²] and time constant T [s] of what the pairs leave, shape
    # (cells,): R/(1 + Ts), or for T < 0 the ground ahead, R e^(−Ts)
    remainder: Array
    remainder_time: Array

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether every followed pole lies in the left half-plane, shape (cells,)."""
        return np.asarray((self.poles.real < 0.0).all(axis=0))

    @_UNKNOWN_POLES
    def transfer(self, s: Spectrum) -> Spectrum:
        """Reduced transfer function from −a_g [s²] at s [rad/s], shape (frequencies, cells)."""
        at = np.asarray(s)[:, np.newaxis]
        lag, ahead = np.maximum(self.remainder_time, 0.0), np.maximum(-self.remainder_time, 0.0)
        total = self.remainder * np.exp(at * ahead) / (1.0 + at * lag)
        for pole, residue in zip(self.poles, self.residues, strict=True):
            total = total + residue / (at - pole) + residue.conj() / (at - pole.conj())
        return np.asarray(total)


@_UNKNOWN_POLES
def pole_loop(partition: Partition, gain: Array, delay: Array, output: Array | None = None) -> PoleLoop:
    """Follow the poles of the test for many actuators, and work out the residues of an output."""
    start = partition.frame.poles
    if start.size < partition.frame.size:
        raise InputError(
            "Every mode of the frame must oscillate",
            value=f"{partition.frame.size - start.size} overdamped modes",
            remedy="Reduce the damping, or the number of degrees of freedom",
        )
    poles = np.stack([_follow_pole(partition, complex(pole), gain, delay) for pole in start])
    residues = _residues(partition, poles, gain, delay, output)
    remainder, remainder_time = _remainder(partition, poles, residues, gain, delay, output)
    return PoleLoop(poles=poles, residues=residues, remainder=remainder, remainder_time=remainder_time)


def _follow_pole(partition: Partition, pole: complex, gain: Array, delay: Array) -> Spectrum:
    """Pole that grows out of one of the structure's, shape (cells,)."""
    start, others, residue, other_residues = _receptance(partition, pole)
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    s = np.full(gain.size, start, dtype=np.complex128)
    step = s
    for stage in range(1, _PARTS + 1):
        share = stage / _PARTS
        for _ in range(_NEWTON_STEPS):
            sigma = gain * np.exp(-s * delay)
            error = share * (sigma - 1.0)
            impedance, impedance_slope = k + s * (c + s * m), c + 2.0 * s * m
            distance = s[:, np.newaxis] - others
            sum_over_others = (other_residues / distance).sum(axis=1)
            slope_over_others = -(other_residues / distance**2).sum(axis=1)
            smooth = residue + (s - start) * sum_over_others  # (s − λ)·g
            smooth_slope = sum_over_others + (s - start) * slope_over_others
            force = impedance * error
            force_slope = impedance_slope * error - impedance * share * delay * sigma
            value = (s - start) + smooth * force
            slope = 1.0 + smooth_slope * force + smooth * force_slope
            step = value / slope
            s = s - step
            if np.all(np.abs(step) <= _CONVERGED * np.abs(s)):
                break
    settled = (np.abs(step) <= 1e-8 * np.abs(s)) & (s.imag > 0.0)
    return np.asarray(np.where(settled, s, np.nan))


def _receptance(partition: Partition, pole: complex) -> tuple[complex, Spectrum, complex, Spectrum]:
    """Split g = Σ r/(s − λ) into the pole nearest to a given one and the others."""
    matrix = partition.frame.state_matrix
    n = partition.frame.size
    eigenvalues, right = np.linalg.eig(matrix)
    driven = np.concatenate([np.zeros(n), np.linalg.solve(partition.frame.mass, partition.direction)])
    residues = (partition.direction @ right[:n]) * np.linalg.solve(right, driven.astype(complex))
    place = int(np.argmin(np.abs(eigenvalues - pole)))
    others = np.arange(2 * n) != place
    return (
        complex(eigenvalues[place]),
        eigenvalues[others],
        complex(residues[place]),
        residues[others],
    )


def _residues(
    partition: Partition, poles: Spectrum, gain: Array, delay: Array, output: Array | None
) -> Spectrum:
    """Residues of the output at each pole, shape (modes, cells)."""
    frame, gamma = partition.frame, partition.direction
    load = frame.mass @ frame.influence
    k, c, m = partition.specimen.stiffness, partition.specimen.damping, partition.specimen.mass
    s = np.nan_to_num(poles, nan=1.0)
    sigma = gain * np.exp(-s * delay)
    force = partition.impedance(s)[..., 0, 0] * (sigma - 1.0)
    force_slope = (c + 2.0 * s * m) * (sigma - 1.0) - (k + s * (c + s * m)) * delay * sigma
    at = s[..., np.newaxis, np.newaxis]
    along = np.outer(gamma, gamma)
    matrix = frame.dynamic_stiffness(s) + force[..., np.newaxis, np.newaxis] * along
    slope = 2.0 * at * frame.mass + frame.damping + force_slope[..., np.newaxis, np.newaxis] * along
    shapes = np.linalg.svd(matrix)[2][..., -1, :].conj()
    scale = np.einsum("...i,...ij,...j->...", shapes, slope, shapes)
    response = (shapes @ load) / scale
    seen = sigma * (shapes @ gamma) if output is None else shapes @ output
    return np.asarray(np.where(np.isnan(poles), np.nan, response * seen))


def _remainder(
    partition: Partition, poles: Spectrum, residues: Spectrum, gain: Array, delay: Array, output: Array | None
) -> tuple[Array, Array]:
    """Value and time constant at s = 0 of what the pole pairs leave of the transfer function."""
    radius = 0.5 * float(np.abs(partition.frame.poles).min())
    s = radius * np.exp(2j * np.pi * (np.arange(_CIRCLE) + 0.5) / _CIRCLE)
    exact = transfer(partition, gain, delay, s, output)
    at = s[:, np.newaxis, np.newaxis]
    remainder = exact - (residues / (at - poles) + residues.conj() / (at - poles.conj())).sum(axis=1)
    value = remainder.mean(axis=0).real
    slope = (remainder / s[:, np.newaxis]).mean(axis=0).real
    time = np.nan_to_num(-slope / value, nan=0.0, posinf=0.0, neginf=0.0)
    # A delay leaves a remainder that lags (T > 0), a lead one that is ahead (T < 0); any other is static.
    sound = (time * delay > 0.0) & (np.abs(time) < 2.0 * np.abs(delay))
    return np.asarray(np.nan_to_num(value)), np.where(sound, time, 0.0)


def transfer(
    partition: Partition, gain: Array, delay: Array, s: Spectrum, output: Array | None = None
) -> Spectrum:
    """Exact transfer function of an output from −a_g [s²], for many actuators.

    The structure is solved once for each frequency; an actuator's error only adds a multiple of γγᵀ, which
    the formula of Sherman and Morrison takes into account.

    `s` [rad/s].
    """
    frame, gamma = partition.frame, partition.direction
    loads = np.column_stack([frame.mass @ frame.influence, gamma]).astype(complex)
    solved = np.linalg.solve(frame.dynamic_stiffness(s), loads[np.newaxis])
    to_command, receptance = (solved[..., 0] @ gamma)[:, np.newaxis], (solved[..., 1] @ gamma)[:, np.newaxis]
    sigma = gain * np.exp(-np.asarray(s)[:, np.newaxis] * delay)
    force = partition.impedance(s)[..., 0] * (sigma - 1.0)
    command = to_command / (1.0 + force * receptance)
    if output is None:
        return np.asarray(sigma * command)
    ideal, pushed = (solved[..., 0] @ output)[:, np.newaxis], (solved[..., 1] @ output)[:, np.newaxis]
    return np.asarray(ideal - pushed * force * command)
