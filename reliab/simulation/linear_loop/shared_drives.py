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

from reliab.arrays import Array, Spectrum
from reliab.compiled import compiled, copy_rows
from reliab.simulation.linear_loop.blocks import Blocks
from reliab.simulation.linear_loop.dominant_pole import modal_loop
from reliab.simulation.linear_loop.pole_recursion import recursion
from reliab.structures import Structure

DRIVES = 6
"""Number of shared drives."""

LEFT_OUT = 1e-5
"""Largest share of an actuator's drive that the shared ones may leave out at any frequency [-]."""

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
    sources: Array  # Recursions of the actuators whose drives are taken, shape (12, drives)
    mixture: Array  # Shared drives from those of the sources, shape (drives, drives)
    # Real and imaginary parts of the transfer functions from both ends of a block to the shared drives,
    # divided by `rows`, shape (4 frequencies, drives)
    orthonormal: Array
    rows: Array  # Usual size of a drive at each frequency, shape (frequencies, 1)

    def weights(self, coefficients: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Weights of the shared drives in those of late actuators."""
        targets = _parts(_drives(coefficients, self.exact, self.back) / self.rows)
        weights, residual = _fit(self.orthonormal, targets)
        undisturbed = _exact_drive(self.exact, self.back) / self.rows
        nothing = _NO_DRIVE * _sizes(_parts(undisturbed))
        weights[:, np.all(_sizes(targets) <= nothing, axis=0)] = 0.0
        return weights, np.all(_sizes(residual) <= LEFT_OUT * _sizes(targets) + nothing, axis=0)

    def histories(self, blocks: Blocks) -> Array:
        """Shared drives [m] in each block of a record, shape (blocks, drives)."""
        return step_drives(blocks.left, blocks.right, blocks.ideal, self.sources, self.mixture)


@lru_cache(maxsize=1024)
def shared_drives(structure: Structure, step: float) -> SharedDrives:
    """Choose the shared drives of actuators before a structure.

    `step` [s].
    """
    turn = structure.circular_frequency * step
    below = np.geomspace(1e-3 * turn, turn, _FREQUENCIES, endpoint=False)
    back = np.exp(-1j * np.append(below, np.geomspace(turn, np.pi, _FREQUENCIES)))[:, np.newaxis]
    exact = recursion(modal_loop(structure, np.ones(1), np.zeros(1)), step)[:6]
    candidates = _candidates(structure, step)
    targets = _drives(candidates, exact, back)
    sizes = _sizes(_parts(targets))
    rows = np.sqrt(np.mean((sizes / sizes.max(axis=0)) ** 2, axis=1, keepdims=True))
    scaled = _parts(targets / rows)
    _, _, order = scipy.linalg.qr(scaled / np.linalg.norm(scaled, axis=0), mode="economic", pivoting=True)
    selected = order[:DRIVES]
    orthonormal, triangle = np.linalg.qr(scaled[:, selected])
    return SharedDrives(
        back=back,
        exact=exact,
        sources=candidates[:, selected].copy(),
        mixture=np.linalg.inv(triangle),
        orthonormal=orthonormal.copy(),
        rows=rows,
    )


def _candidates(structure: Structure, step: float) -> Array:
    """Recursions of late actuators with errors of interest, shape (12, cells)."""
    gains = np.exp(_REACH_GAIN * structure.damping_ratio * np.linspace(-1.0, 1.0, _GAINS))
    delays = _LONGEST_DELAY * step * np.linspace(0.0, 1.0, _DELAYS)
    gain, delay = (values.ravel() for values in np.meshgrid(gains, delays))
    moved = (gain != 1.0) | (delay > 0.0)
    loop = modal_loop(structure, gain[moved], delay[moved])
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


@compiled
def step_drives(left: Array, right: Array, ideal: Array, sources: Array, mixture: Array) -> Array:
    """Shared drives [m] in each block, from the lines of a record and the exact response to them."""
    drives = np.zeros((left.size, DRIVES))
    k, m = np.empty((12, DRIVES)), np.empty((DRIVES, DRIVES))
    copy_rows(sources, k)
    copy_rows(mixture, m)
    x, y, w, total = np.zeros((4, DRIVES)), np.zeros((2, DRIVES)), np.zeros(DRIVES), np.zeros(DRIVES)
    a2, a3 = 0.0, 0.0
    for i in range(left.size):
        a0, a1, exact = left[i], right[i], ideal[i + 1]
        for j in range(DRIVES):
            slow = k[0, j] * x[0, j] + k[1, j] * x[1, j]
            slow += k[2, j] * a0 + k[3, j] * a1 + k[4, j] * a2 + k[5, j] * a3
            fast = k[6, j] * x[2, j] + k[7, j] * x[3, j]
            fast += k[8, j] * a0 + k[9, j] * a1 + k[10, j] * a2 + k[11, j] * a3
            x[1, j], x[3, j], x[0, j], x[2, j] = x[0, j], x[2, j], slow, fast
            now = slow + fast - exact
            w[j] = now - k[0, j] * y[0, j] - k[1, j] * y[1, j]
            y[1, j], y[0, j], total[j] = y[0, j], now, 0.0
        for p in range(DRIVES):
            for j in range(DRIVES):
                total[j] += w[p] * m[p, j]
        for j in range(DRIVES):
            drives[i, j] = total[j]
        a2, a3 = a0, a1
    return drives
