"""Damping matrices from damping ratios of the modes, or from two damping ratios by Rayleigh's method."""

import numpy as np
import scipy
from numpy.typing import ArrayLike

from reliab.arrays import Array
from reliab.errors import InputError
from reliab.significant import significant
from reliab.structures.frames.frame import natural_modes


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
            "Rayleigh damping needs two different positive frequencies", value=f"{frequencies} Hz"
        )
    system = 0.5 * np.array([[1.0 / first, first], [1.0 / second, second]])
    on_mass, on_stiffness = np.linalg.solve(system, np.asarray(ratios, dtype=np.float64))
    squares = scipy.linalg.eigh(mass, stiffness, eigvals_only=True)  # 1/ω², zero without a mass
    omega = 1.0 / np.sqrt(np.maximum(squares, np.finfo(float).tiny))
    lowest = 0.5 * (on_mass / omega + on_stiffness * omega).min()
    if lowest < 0.0:
        raise InputError(
            "Rayleigh damping must leave every mode a positive damping ratio",
            value=f"{significant(lowest)} for some mode",
            remedy="Choose ratios or frequencies that lie closer together",
        )
    return np.asarray(on_mass * np.asarray(mass) + on_stiffness * np.asarray(stiffness))
