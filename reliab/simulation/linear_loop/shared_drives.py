r"""Deviations of many actuators as responses to a few shared drives.

The deviation y = x_m − x_I of one actuator obeys the recursion of its own dominant pair, driven by
what the reduced loop and the exact response leave of it::

    y₊₊ = c₁y₊ + c₂y + w,     E = e^(pH),  c₁ = 2Re E,  c₂ = −|E|²

For a given record the w of all actuators before one structure are nearly sums of the same few. The
shared ones are those of a few actuators, orthonormal over the frequencies (pivoted QR), and every other
actuator is fitted with them by least squares. The largest part that this leaves out of w, at any
frequency up to the highest that blocks resolve, bounds the relative error of y for **every** record.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.dominant_pole import modal_loop
from reliab.simulation.linear_loop.pole_recursion import recursion
from reliab.structures.structure import Structure

DRIVES = 6
"""Number of shared drives."""

LEFT_OUT = 1e-5
"""Largest share of an actuator's drive that the shared ones may leave out at any frequency [-]."""

_LAGS = 5  # blocks of which a drive is made up
_NO_DRIVE = 1e-10  # of the exact response's drive; less counts as none
_REACH_GAIN = 1.1  # of the actuators from which drives are taken: |ln k_p| in damping ratios
_LONGEST_DELAY = 0.3  # of a block; the fast pair of a longer delay needs more drives
_GAINS, _DELAYS = 9, 10
_FREQUENCIES = 24  # below the structure's and above it


@dataclass(frozen=True, kw_only=True, eq=False)
class SharedDrives:
    """Shared drives of the actuators before one structure."""

    # e^(−iωH) at the frequencies at which drives are compared, shape (frequencies, 1)
    back: Spectrum
    exact: Array  # Recursion of the exact response, shape (6, 1)
    taps: Array  # Of `drive_histories`, shape (13, drives)
    # Real and imaginary parts of the transfer functions from both ends of a block to the shared drives,
    # divided by `rows`, shape (4 frequencies, drives)
    orthonormal: Array
    rows: Array  # Usual size of a drive at each frequency, shape (frequencies, 1)

    def weights(self, coefficients: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Weights of the shared drives in those of late actuators."""
        targets = _parts(_drives(coefficients, self.exact, self.back) / self.rows)
        weights, residual = _fit(self.orthonormal, targets)
        exact_weights = _exact_drive(self.exact, self.back) / self.rows
        nothing = _NO_DRIVE * _sizes(_parts(exact_weights))
        weights[:, np.all(_sizes(targets) <= nothing, axis=0)] = 0.0
        return weights, np.all(_sizes(residual) <= LEFT_OUT * _sizes(targets) + nothing, axis=0)

    def histories(self, blocks: Blocks) -> Array:
        """Shared drives [m] in each block of a record, shape (drives, blocks)."""
        return drive_histories(blocks.left, blocks.right, blocks.ideal, self.taps)


@lru_cache(maxsize=1024)
def shared_drives(structure: Structure, step: float) -> SharedDrives:
    """Choose the shared drives of actuators before a structure.

    `step` [s].
    """
    turn = structure.circular_frequency * step
    low_frequencies = np.geomspace(1e-3 * turn, turn, _FREQUENCIES, endpoint=False)
    back = np.exp(-1j * np.append(low_frequencies, np.geomspace(turn, np.pi, _FREQUENCIES)))[:, np.newaxis]
    exact = recursion(modal_loop(structure, np.ones(1), np.zeros(1)), step)[:6]
    candidates = _candidates(structure, step)
    targets = _drives(candidates, exact, back)
    sizes = _sizes(_parts(targets))
    rows = np.sqrt(np.mean((sizes / sizes.max(axis=0)) ** 2, axis=1, keepdims=True))
    parts = _parts(targets / rows)
    _, _, order = scipy.linalg.qr(parts / np.linalg.norm(parts, axis=0), mode="economic", pivoting=True)
    drive_rows = order[:DRIVES]
    orthonormal, triangle = np.linalg.qr(parts[:, drive_rows])
    return SharedDrives(
        back=back,
        exact=exact,
        taps=_taps(candidates[:, drive_rows]) @ np.linalg.inv(triangle),
        orthonormal=orthonormal.copy(),
        rows=rows,
    )


def _candidates(structure: Structure, step: float) -> Array:
    """Recursions of late actuators with errors of interest, shape (12, cells)."""
    gains = np.exp(_REACH_GAIN * structure.damping_ratio * np.linspace(-1.0, 1.0, _GAINS))
    delays = _LONGEST_DELAY * step * np.linspace(0.0, 1.0, _DELAYS)
    gain, delay = (values.ravel() for values in np.meshgrid(gains, delays))
    is_perturbed = (gain != 1.0) | (delay > 0.0)
    loop = modal_loop(structure, gain[is_perturbed], delay[is_perturbed])
    return recursion(loop, step)[:, loop.residue != 0.0]


def _drives(coefficients: Array, exact: Array, back: Spectrum) -> Spectrum:
    """Transfer functions from both ends of a block to the drive w, shape (2, frequencies, cells)."""
    deviation = _pair(coefficients[:6], back) + _pair(coefficients[6:], back) - _pair(exact, back)
    return np.asarray(deviation * (1.0 - coefficients[0] * back - coefficients[1] * back**2))


def _exact_drive(exact: Array, back: Spectrum) -> Spectrum:
    return np.stack([exact[2] + exact[4] * back, exact[3] + exact[5] * back])


def _pair(c: Array, back: Spectrum) -> Spectrum:
    """Transfer functions of the recursion of one pair, a block early, shape (2, frequencies, cells)."""
    ends = np.stack([c[2] + c[4] * back, c[3] + c[5] * back])
    return np.asarray(ends / (1.0 - c[0] * back - c[1] * back**2))


def _parts(transfer: Spectrum) -> Array:
    """Real and imaginary parts from both ends of a block, shape (4 frequencies, cells)."""
    return np.concatenate([transfer[0].real, transfer[0].imag, transfer[1].real, transfer[1].imag])


def _sizes(parts: Array) -> Array:
    """Size of transfer functions from both ends of a block together, shape (frequencies, cells)."""
    return np.asarray(np.sqrt((parts**2).reshape(4, -1, parts.shape[1]).sum(axis=0)))


@compiled
def _fit(orthonormal: Array, targets: Array) -> tuple[Array, Array]:
    """Weights and rest; summed in a fixed order, so that no cell depends on the company of others."""
    weights, residual = np.zeros((orthonormal.shape[1], targets.shape[1])), targets.copy()
    for k in range(orthonormal.shape[1]):
        for row in range(targets.shape[0]):
            q = orthonormal[row, k]
            for j in range(targets.shape[1]):
                weights[k, j] += q * targets[row, j]
    for row in range(targets.shape[0]):
        for k in range(orthonormal.shape[1]):
            q = orthonormal[row, k]
            for j in range(targets.shape[1]):
                residual[row, j] -= q * weights[k, j]
    return weights, residual


def _taps(sources: Array) -> Array:
    """Drives of some actuators as sums of neighbouring values of a record and of the exact response.

    The recursion (1 − c₁z − c₂z²)x = (b₀ + d₀z)a₀ + (b₁ + d₁z)a₁ of either pair, z a block of delay, leaves
    of the dominant pair its load alone. The fast pair of so short a delay has c₁ of 3e-6 and c₂ of 3e-12, so
    that 1/(1 − c₁z − c₂z²) is 1 + c₁z.

    Returns the weights of a₀, then of a₁, in this block and the four before, and of the exact response at the
    end of this block and at the two edges before, shape (13, cells).
    """
    own_drives = np.stack([np.ones_like(sources[0]), -sources[0], -sources[1]])
    taps = np.zeros((2 * _LAGS + 3, sources.shape[1]))
    for end in (0, 1):
        lags = taps[end * _LAGS :]
        for dominant, late, fast in zip(sources[2 + end : 6 : 2], (0, 1), sources[8 + end :: 2], strict=True):
            lags[late] += dominant
            for later, weight in enumerate(own_drives):
                lags[late + later] += weight * fast
                lags[late + later + 1] += sources[6] * weight * fast
    taps[2 * _LAGS :] = -own_drives
    return taps


@compiled
def drive_histories(left: Array, right: Array, ideal: Array, taps: Array) -> Array:
    """Shared drives [m] in each block, from the lines of a record and the exact response to them."""
    blocks = left.size
    a0, a1, exact = np.zeros(blocks + _LAGS), np.zeros(blocks + _LAGS), np.zeros(blocks + _LAGS)
    for i in range(blocks):
        a0[i + _LAGS], a1[i + _LAGS], exact[i + _LAGS] = left[i], right[i], ideal[i + 1]
    drives = np.empty((DRIVES, blocks))
    for j in range(DRIVES):
        p0, p1, p2, p3, p4 = taps[0, j], taps[1, j], taps[2, j], taps[3, j], taps[4, j]
        q0, q1, q2, q3, q4 = taps[5, j], taps[6, j], taps[7, j], taps[8, j], taps[9, j]
        r0, r1, r2 = taps[10, j], taps[11, j], taps[12, j]
        for i in range(blocks):
            k = i + _LAGS
            early = p0 * a0[k] + p1 * a0[k - 1] + p2 * a0[k - 2] + p3 * a0[k - 3] + p4 * a0[k - 4]
            late = q0 * a1[k] + q1 * a1[k - 1] + q2 * a1[k - 2] + q3 * a1[k - 3] + q4 * a1[k - 4]
            drives[j, i] = early + late + (r0 * exact[k] + r1 * exact[k - 1] + r2 * exact[k - 2])
    return drives
