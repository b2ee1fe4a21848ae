"""How tolerable errors grow when only a part of the stiffness is in the laboratory.

To first order an error u − 1 of the actuator makes the measured displacement stray by (u − 1)(1 − αω₀²/D)
times the exact response, D = s² + 2ξω₀s + ω₀². Under white noise near resonance D ≈ 2iξω₀²(1 + iδ) with the
weight 1/π(1 + δ²), so that the mean square of the second factor is 1 + α²/8ξ², and ::

    a(α)/a(1) = b(α)/b(1) = (1 + 1/8ξ²)/(1 + α²/8ξ²)

For α far above ξ that is 1/α². The specimen must be a spring: nothing is said of dampers and masses.
"""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from reliab.core.arrays import Array
from reliab.core.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


LEAST_SHARE_OVER_DAMPING: Final = 10.0
"""Least α/ξ for which limits are carried: the limit that 95 % of 20 real motions keep then lay between 0.88
and 1.18 of the carried one at 16 structures, below it between 0.64 and 1.57. What single motions tolerate may
grow far less than by the law (`datasets/experimental_share`)."""

_FULL_SHARE = 1.0
_FREQUENCIES, _DAMPING_RATIOS = (0.5, 3.0), (0.01, 0.10)  # of datasets/experimental_share/growth.csv


def whole_is_worst(frequency: float, damping_ratio: float) -> bool:
    """Tell whether α = 1 was measured to be the worst case at a structure.

    For structures of 0.5 to 3 Hz with damping ratios of 1 to 10 % the errors of tests on the ellipses of
    α = 1 were simulated at seven smaller shares from 0.05 to 0.7, under 20 real motions: none was larger
    (`datasets/experimental_share`). Of stiff and damped structures it is not so: where the motion is much
    slower than the structure, the static part of an amplitude error vanishes for α = 1, and for a smaller
    share it does not.

    `frequency`, `damping_ratio`: the structure [Hz, -]. Returns whether it lies among those that were
    simulated.

    >>> whole_is_worst(1.0, 0.02), whole_is_worst(15.0, 0.05)
    (True, False)
    """
    return all(
        lowest <= value <= highest
        for value, (lowest, highest) in ((frequency, _FREQUENCIES), (damping_ratio, _DAMPING_RATIOS))
    )


def growth(experimental_fraction: ArrayLike, damping_ratio: ArrayLike) -> Array:
    """Ellipse parameters of a structure with a share α in the laboratory over those of α = 1.

    `experimental_fraction`, `damping_ratio`: α and ξ [-], broadcast against each other. Returns factor on a
    and on b [-], at least 1.

    >>> growth([1.0, 0.5, 0.2], 0.02).round(2)
    array([ 1.  ,  3.96, 23.22])
    """
    share, xi = np.broadcast_arrays(
        np.asarray(experimental_fraction, dtype=np.float64), np.asarray(damping_ratio, dtype=np.float64)
    )
    if not ((share > 0.0) & (share <= 1.0)).all():
        raise InputError(
            "The share of the stiffness in the laboratory must be above 0 and at most 1",
            value=float(share.flat[0]),
            remedy="Give a fraction, 0.6 for 60 %",
        )
    weak = (share < _FULL_SHARE) & (share < LEAST_SHARE_OVER_DAMPING * xi * (1.0 - 1e-9))
    if weak.any():
        raise InputError(
            "The share of the stiffness in the laboratory is too small for this law, which needs α of at "
            f"least {LEAST_SHARE_OVER_DAMPING:g} ξ",
            value=f"α = {share[weak].flat[0]:g} at ξ = {xi[weak].flat[0]:g}",
            remedy="Choose less damped structures, or give `motions`, whose boundaries are computed for any "
            "fraction",
        )
    stiff = 1.0 / (8.0 * xi**2)
    return np.asarray((1.0 + stiff) / (1.0 + share**2 * stiff))


def carry_to_share(ellipses: "xr.Dataset", experimental_fraction: float) -> "xr.Dataset":
    """Transfer ellipses of structures with all stiffness in the laboratory to a smaller share.

    `ellipses`: `a` and `b` with a coordinate `xi`, of α = 1; `experimental_fraction`: α [-]. Returns the same
    with larger a and b; the attribute `experimental_fraction` is α, and `caution` says that the ellipses were
    carried by a law.
    """
    import xarray as xr

    from reliab.sweep.labels import share_of

    stored_share = share_of(ellipses)
    if stored_share != _FULL_SHARE:
        raise InputError(
            "These ellipses are not of structures with all stiffness in the laboratory",
            value=f"α = {stored_share:g}",
            remedy="Give `motions`, whose boundaries are computed for any fraction",
        )
    factor = xr.DataArray(
        growth(experimental_fraction, ellipses["xi"].values), {"xi": ellipses["xi"].values}, "xi"
    )
    carried_ellipses = ellipses.assign(
        {name: (ellipses[name] * factor).transpose(*ellipses[name].dims) for name in ("a", "b")}
    )
    caution = (
        f"The ellipses of α = 1 were transferred to α = {experimental_fraction:g} by the law "
        "(1 + 1/8ξ²)/(1 + α²/8ξ²) of a spring as the specimen; under 20 real motions simulated limits lay "
        "between 0.88 and 1.18 of transferred ones. Give ground motions for boundaries of their own."
    )
    previous_caution = str(ellipses.attrs.get("caution", ""))
    return carried_ellipses.assign_attrs(
        experimental_fraction=experimental_fraction, caution=f"{previous_caution} {caution}".strip()
    )
