"""The single-degree-of-freedom structure of which one part is tested, and its stability."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.stated_value import require_physical


@dataclass(frozen=True, kw_only=True)
class Structure:
    """A linear elastic single-degree-of-freedom structure, divided for hybrid simulation.

    Parameters
    ----------
    frequency : float
        Natural frequency f of the whole structure [Hz].
    damping_ratio : float
        Inherent damping ratio ξ [-], in (0, 1).
    experimental_fraction : float, optional
        Share α of the stiffness that stands in the laboratory [-], in (0, 1]; the paper's worst
        case, and the default, is 1.

    Examples
    --------
    >>> Structure(frequency=1.0, damping_ratio=0.02).circular_frequency
    6.283185307179586
    """

    frequency: float
    damping_ratio: float
    experimental_fraction: float = 1.0

    def __post_init__(self) -> None:
        require_physical("natural frequency", self.frequency)
        require_physical("damping ratio", self.damping_ratio)
        require_physical("share of the stiffness in the laboratory", self.experimental_fraction)

    @property
    def circular_frequency(self) -> float:
        """Natural circular frequency ω₀ [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @property
    def pole(self) -> complex:
        """Pole p = −ξω₀ + iω₀√(1 − ξ²) of the structure's own mode [1/s]."""
        xi = self.damping_ratio
        return self.circular_frequency * complex(-xi, math.sqrt(1.0 - xi**2))


def longest_lead(structure: Structure, gain: ArrayLike = 1.0) -> Array:
    """Longest lead for which the loop is solved, a quarter of the shortest period.

    `gain`: actuator gain k_p [-], any shape. Returns lead [s], positive, in the shape of `gain`.

    >>> float(longest_lead(Structure(frequency=1.0, damping_ratio=0.02)))
    0.25
    """
    alpha = structure.experimental_fraction
    stiffness = np.maximum(1.0 - alpha + alpha * np.asarray(gain, dtype=np.float64), 1.0)
    return np.asarray(0.25 / (structure.frequency * np.sqrt(stiffness)))


def refuse_long_leads(structure: Structure, gain: Array, delay: Array) -> None:
    """Refuse leads beyond the longest that can be solved.

    `gain`, `delay`: actuator gain [-] and delay [s], negative for a lead, shape (cells,). Raises InputError
    if a lead is too long.
    """
    if delay.size == 0 or delay.min() >= 0.0:
        return
    longest = longest_lead(structure, gain)
    wrong = -delay > longest * (1.0 + 1e-12)
    if wrong.any():
        worst = int(np.argmax(-delay - longest))
        raise InputError(
            f"A lead must be shorter than a quarter of the structure's period, {1e3 * longest[worst]:.4g} ms "
            f"for f = {structure.frequency:g} Hz and k_p = {gain[worst]:g}",
            value=f"{-1e3 * delay[worst]:.4g} ms",
            remedy="Check the sign and the time axis of command and measured displacement",
        )


def critical_delay(structure: Structure, gain: ArrayLike = 1.0) -> Array:
    """Delay at which the loop loses stability.

    `gain` [-].
    Returns critical delay τ_c [s] in the shape of `gain`; infinite where no delay makes the loop unstable (a
    small experimental fraction with enough damping).

    The paper's 6.4 ms for 1 Hz and 2 % damping:

    >>> round(1000 * float(critical_delay(Structure(frequency=1.0, damping_ratio=0.02))), 3)
    6.368
    """
    gain = np.asarray(gain, dtype=np.float64)
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    numerical = (1.0 - alpha) * w0**2
    half_linear = numerical - 2.0 * (xi * w0) ** 2
    constant = numerical**2 - (alpha * gain * w0**2) ** 2
    discriminant = half_linear**2 - constant
    # The larger root is where poles leave the stable half-plane as the delay grows.
    crossing = half_linear + np.sqrt(np.maximum(discriminant, 0.0))
    crosses = (discriminant >= 0.0) & (crossing > 0.0)
    omega = np.sqrt(np.where(crosses, crossing, 1.0))
    delay = np.arctan2(2.0 * xi * w0 * omega, omega**2 - numerical) / omega
    return np.where(crosses, delay, np.inf)


def stability_margin(structure: Structure, gain: ArrayLike, delay: ArrayLike) -> Array:
    """Unused share of the critical delay, 1 − τ/τ_c [-]; negative when unstable.

    `gain`, `delay`: actuator gain [-] and delay [s], negative for a lead, broadcast against each other.
    Returns the margin [-] in the broadcast shape; above 1 for a lead, which is never unstable.
    """
    return 1.0 - np.asarray(delay, dtype=np.float64) / critical_delay(structure, gain)
