"""The exact stability limit of the loop with a gain and a pure delay.

The loop s² + 2ξω₀s + (1−α)ω₀² + αk_pω₀²e^(−sτ) = 0 loses stability where a root crosses the
imaginary axis at s = iΩ. The modulus of the characteristic equation gives Ω, its argument τ_c::

    (Ω² − (1−α)ω₀²)² + (2ξω₀Ω)² = (αk_pω₀²)²
    τ_c = atan2(2ξω₀Ω, Ω² − (1−α)ω₀²) / Ω

For α = 1 this is Ω² = ω₀²(−2ξ² + √(4ξ⁴ + k_p²)), τ_c = atan2(2ξω₀Ω, Ω²)/Ω (Wallace and others 2005).

A lead, τ < 0, never loses stability in this way. At a root s = iΩ the imaginary part of the equation is
2ξω₀Ω + αk_pω₀² sin(Ω|τ|) = 0, which asks for Ω|τ| > π, and its real part for Ω² ≤ (1−α+αk_p)ω₀². No root can
therefore lie on the imaginary axis while |τ| < π/(ω₀√(1−α+αk_p)), half a period, and the pair that carries
the response only gains damping, about αk_pω₀|τ|/2. The other roots lie far right of the axis: they describe
the dependence on future values, not growth in time. Leads are solved up to a quarter of a period, half of
that range, within which no root lies in 0 ≤ Re s ≤ 1/|τ| either.
"""

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.structures.structure import Structure


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
        at = int(np.argmax(-delay - longest))
        raise InputError(
            f"A lead must be shorter than a quarter of the structure's period, {1e3 * longest[at]:.4g} ms "
            f"for f = {structure.frequency:g} Hz and k_p = {gain[at]:g}",
            value=f"{-1e3 * delay[at]:.4g} ms",
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
