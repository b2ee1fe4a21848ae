"""The loop reduced to its dominant pole pair.

A loop with a short delay is a second-order system: of the infinitely many poles of::

    Q(s) = s² + 2ξω₀s + (1−α)ω₀² + αk_pω₀²e^(−sτ)

one lightly damped pair carries the response, and the others, about 1/τ fast and heavily damped,
nearly follow the ground acceleration. The transfer function from −a_g is therefore split as::

    k_p e^(−sτ)/Q(s) = r/(s − p) + r̄/(s − p̄) + c/(1 + sT) + O(s²τ⁴)

with the residue r = k_p e^(−pτ)/Q'(p). The quasi-static term matches value and slope of what the
pair leaves at s = 0 (c ≈ τ²/2, T ≈ τ/3); it vanishes for τ = 0, where the pair is the whole loop.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.loop.structure import Structure

_NEWTON_STEPS = 60
_CONVERGED = 1e-14
_NO_DEVIATION = 1e-9  # of the response: a perfect actuator leaves nothing to be lost
# Reduced and exact loop are compared at these multiples of the natural frequency.
_COMPARED = np.geomspace(0.1, 40.0, 61)


@dataclass(frozen=True, kw_only=True)
class ModalLoop:
    """A pole pair with its residue and the quasi-static rest, one entry per cell.

    Attributes
    ----------
    pole, residue : numpy.ndarray
        Dominant pole p [1/s] and residue r [s] of the response to −a_g, complex, shape (cells,).
    quasi_static, lag : numpy.ndarray
        Gain c [s²] and time constant T [s] of what follows −a_g almost at once, shape (cells,).
    """

    pole: NDArray[np.complex128]
    residue: NDArray[np.complex128]
    quasi_static: NDArray[np.float64]
    lag: NDArray[np.float64]


def dominant_pole(
    structure: Structure, gain: NDArray[np.float64], delay: NDArray[np.float64]
) -> NDArray[np.complex128]:
    """Pole of the loop that grows out of the undelayed structure's own pole.

    Parameters
    ----------
    structure : Structure
        The structure under test.
    gain, delay : numpy.ndarray
        Actuator gain [-] and delay [s], shape (cells,).

    Returns
    -------
    numpy.ndarray
        The pole with positive imaginary part [1/s], shape (cells,); NaN where Newton's iteration
        does not settle (delays of the order of the period, which the modal reduction refuses).
    """
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    coupled = alpha * gain * w0**2
    stiffness = (1.0 - alpha) * w0**2 + coupled
    pole = -xi * w0 + 0.5 * coupled * delay + 1j * np.sqrt(stiffness)
    for _ in range(_NEWTON_STEPS):
        delayed = coupled * np.exp(-pole * delay)
        value = pole**2 + 2.0 * xi * w0 * pole + (1.0 - alpha) * w0**2 + delayed
        slope = 2.0 * pole + 2.0 * xi * w0 - delay * delayed
        step = value / slope
        pole = pole - step
        if np.all(np.abs(step) <= _CONVERGED * np.abs(pole)):
            return pole
    settled = np.abs(step) <= 1e-9 * np.abs(pole)
    return np.where(settled & (pole.imag > 0.0), pole, np.nan)


def modal_loop(structure: Structure, gain: NDArray[np.float64], delay: NDArray[np.float64]) -> ModalLoop:
    """Split the loop from −a_g to the measured displacement into its dominant pair and a rest.

    Parameters
    ----------
    structure : Structure
        The structure under test.
    gain, delay : numpy.ndarray
        Actuator gain [-] and delay [s], shape (cells,).

    Returns
    -------
    ModalLoop
        The reduced loop, one entry per cell.
    """
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    coupled = alpha * gain * w0**2
    pole = dominant_pole(structure, gain, delay)
    slope = 2.0 * pole + 2.0 * xi * w0 - delay * coupled * np.exp(-pole * delay)
    residue = gain * np.exp(-pole * delay) / slope
    # Value and slope at s = 0 of the whole transfer function, less those of the pair.
    stiffness = (1.0 - alpha) * w0**2 + coupled
    static = gain / stiffness
    static_slope = -static * (delay + (2.0 * xi * w0 - coupled * delay) / stiffness)
    value = static + 2.0 * (residue / pole).real
    slope_left = static_slope + 2.0 * (residue / pole**2).real
    follows = (delay > 0.0) & (value * slope_left < 0.0)
    return ModalLoop(
        pole=pole,
        residue=residue,
        quasi_static=np.where(follows, value, 0.0),
        lag=np.where(follows, -slope_left / np.where(follows, value, 1.0), 0.0),
    )


def transfer(
    structure: Structure, gain: NDArray[np.float64], delay: NDArray[np.float64], s: NDArray[np.complex128]
) -> NDArray[np.complex128]:
    """Exact transfer function k_p e^(−sτ)/Q(s) from −a_g to the measured displacement [s²]."""
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    actuator = gain * np.exp(-s * delay)
    return actuator / (s**2 + 2.0 * xi * w0 * s + w0**2 * (1.0 - alpha + alpha * actuator))


def band_edges(structure: Structure) -> NDArray[np.float64]:
    """Edges [Hz] of the bands in which the reduction is compared with the exact loop."""
    half = np.sqrt(_COMPARED[1] / _COMPARED[0])
    return structure.frequency * np.append(_COMPARED / half, _COMPARED[-1] * half)


def reduction_loss(
    structure: Structure, gain: NDArray[np.float64], delay: NDArray[np.float64], loop: ModalLoop
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Compare the reduced loop with the exact one, band by band.

    Parameters
    ----------
    structure : Structure
        The structure under test.
    gain, delay : numpy.ndarray
        Actuator gain [-] and delay [s], shape (cells,).
    loop : ModalLoop
        The reduced loop of the same cells.

    Returns
    -------
    lost, sought : numpy.ndarray
        Squared moduli of exact minus reduced transfer function and of x_m − x_I over −a_g [s⁴],
        shape (bands, cells). Weighted by the power of a record in each band their sums give the
        relative error of the deviation's mean square.
    """
    s = (2j * np.pi * structure.frequency * _COMPARED[:, np.newaxis]).astype(np.complex128)
    exact = transfer(structure, gain, delay, s)
    ideal = transfer(structure, np.ones(1), np.zeros(1), s)
    reduced = (
        loop.residue / (s - loop.pole)
        + loop.residue.conj() / (s - loop.pole.conj())
        + loop.quasi_static / (1.0 + s * loop.lag)
    )
    lost = np.abs(exact - reduced) ** 2
    sought = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
    return np.where(np.isfinite(lost), lost, np.inf), sought
