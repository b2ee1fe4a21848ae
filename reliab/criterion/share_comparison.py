"""Limits that were simulated for several shares of the stiffness, compared with the law of the share.

The law (see `reliab.criterion.experimental_share`) has one number besides α, the strength of resonance
s = 1/8ξ² under white noise ::

    a(α)/a(1) = b(α)/b(1) = (1 + s)/(1 + s α²)

Here the limits of criteria for several shares are compared with it, and s is fitted to them, for a and for b.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.criterion.criterion import Criterion
from reliab.criterion.experimental_share import LEAST_SHARE_OVER_DAMPING, growth

_NEAR_REACH = 0.9  # of the largest a that a boundary can have, since it is not traced further
_LOG_STRENGTHS: Final = (-12.0, 24.0)  # natural logarithms between which the strength is sought


@dataclass(frozen=True, kw_only=True)
class ShareRatio:
    """Limits at a share of the stiffness over those at the largest share."""

    # f, xi, alpha, reference: Natural frequency [Hz], damping ratio, share, and the largest share [-]
    f: float
    xi: float
    alpha: float
    reference: float
    threshold: float  # threshold, confidence: What the criteria state [-]
    confidence: float
    # a_ratio, b_ratio: Limits over those of the reference [-]; None where a limit is zero, and for a where
    # boundaries reach as far as they are traced
    a_ratio: float | None
    b_ratio: float | None
    law: float | None  # The same by the law [-]; None below ten damping ratios, where it is not stated
    # a_deviation, b_deviation: Ratios over that of the law, less 1 [-]; None where either is missing
    a_deviation: float | None
    b_deviation: float | None


def compare_shares(
    criteria: Sequence[Criterion], structures: Sequence[tuple[float, float]]
) -> dict[str, list[dict[str, Any]]]:
    """Compare criteria of several shares of the stiffness with the law of the share.

    `criteria`: criteria of several shares, alike in all else, at one or more thresholds and confidences;
    `structures`: natural frequencies [Hz] and damping ratios [-]. Returns `ratios`, a list of the fields of
    :class:`ShareRatio`, and `fits`, a list with `f`, `xi`, `threshold`, `confidence`, `white_noise`, the
    strength 1/8ξ² of the law, and for a and b the fitted `strength` and the `largest_deviation` of the ratios
    from the law with it (None without two ratios).
    """
    promises = dict.fromkeys((criterion.threshold, criterion.confidence) for criterion in criteria)
    groups = [
        [criterion for criterion in criteria if (criterion.threshold, criterion.confidence) == promise]
        for promise in promises
    ]
    compared = [_ratios(group, *structure) for structure in structures for group in groups]
    return {
        "ratios": [asdict(ratio) for ratios in compared for ratio in ratios],
        "fits": [_fits(ratios) for ratios in compared if ratios],
    }


def fitted_strength(shares: Array, ratios: Array, reference: float) -> tuple[float, float]:
    """Fit the strength of resonance to ratios of limits, by least squares in their logarithms.

    `shares`, `ratios`, `reference` [-]; returns strength, deviation [-].

    >>> shares = np.array([0.25, 0.5])
    >>> strength, deviation = fitted_strength(shares, (1 + 300) / (1 + 300 * shares**2), 1.0)
    >>> round(strength), round(deviation, 6)
    (300, 0.0)
    """

    def residuals(log_strength: float) -> Array:
        s = np.exp(log_strength)
        return np.asarray(np.log(ratios) - np.log((1.0 + s * reference**2) / (1.0 + s * shares**2)))

    best = scipy.optimize.minimize_scalar(
        lambda log_strength: float((residuals(log_strength) ** 2).sum()),
        bounds=_LOG_STRENGTHS,
        method="bounded",
        options={"xatol": 1e-8},
    )
    return float(np.exp(best.x)), float(np.abs(np.expm1(residuals(best.x))).max())


def _ratios(criteria: Sequence[Criterion], f: float, xi: float) -> list[ShareRatio]:
    """Ratios of one structure at one threshold and confidence."""
    limits = {
        criterion.provenance.experimental_fraction: [float(limit) for limit in criterion.limits(f, xi)]
        for criterion in criteria
    }
    reference = max(limits)
    from reliab.tracking.boundary.contour import REACH

    furthest = _NEAR_REACH * np.expm1(-REACH * xi) ** 2
    ratios = []
    for share in sorted(set(limits) - {reference}):
        a, b = (
            (limit / of if limit > 0.0 and of > 0.0 else None)
            for limit, of in zip(limits[share], limits[reference], strict=True)
        )
        a = None if limits[share][0] >= furthest else a
        stated = share >= LEAST_SHARE_OVER_DAMPING * xi
        law = float(growth(share, xi) / growth(reference, xi)) if stated else None
        ratios.append(
            ShareRatio(
                f=f,
                xi=xi,
                alpha=share,
                reference=reference,
                threshold=criteria[0].threshold,
                confidence=criteria[0].confidence,
                a_ratio=a,
                b_ratio=b,
                law=law,
                a_deviation=_deviation(a, law),
                b_deviation=_deviation(b, law),
            )
        )
    return ratios


def _deviation(ratio: float | None, law: float | None) -> float | None:
    return None if ratio is None or law is None else ratio / law - 1.0


def _fits(ratios: Sequence[ShareRatio]) -> dict[str, Any]:
    """Strengths of resonance fitted to the ratios of one structure."""
    first = ratios[0]
    fits: dict[str, Any] = {
        "f": first.f,
        "xi": first.xi,
        "threshold": first.threshold,
        "confidence": first.confidence,
        "white_noise": 1.0 / (8.0 * first.xi**2),
    }
    for name in ("a", "b"):
        pairs = [(ratio.alpha, getattr(ratio, f"{name}_ratio")) for ratio in ratios]
        known = np.array([pair for pair in pairs if pair[1] is not None], dtype=np.float64)
        strength, deviation = (
            fitted_strength(known[:, 0], known[:, 1], first.reference) if len(known) > 1 else (None, None)
        )
        fits |= {f"{name}_strength": strength, f"{name}_largest_deviation": deviation}
    return fits
