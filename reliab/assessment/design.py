"""Before the test: how much delay and amplitude error a rig may have."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

import numpy as np

from reliab.assessment.default_criterion import default_criterion, ellipses_of_nearest, list_frequencies
from reliab.assessment.placement import scale_limits
from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.core.vocabulary import MILLI, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.experimental_share import growth
from reliab.criterion.scope import confidence_to_promise
from reliab.structures.structure import Structure, critical_delay

CONFIDENCES = (0.80, 0.90, 0.95, 0.99)
"""Shares of the population's ground motions for which tolerable errors are stated."""

_CHART_FREQUENCIES = 8  # frequencies


@dataclass(frozen=True, kw_only=True)
class TolerableErrors(PlainResult):
    """What is tolerable for one structure at one confidence."""

    keys: ClassVar[Keys] = {
        "f": "frequency",
        "xi": "damping_ratio",
        "alpha": "experimental_fraction",
        "threshold": "threshold",
        "confidence": "promise",
        **same_names("a", "b"),
        "amplitude_limit": "amplitude_error",
        "delay_limit_ms": "delay",
        "amplitude_limit_of_both": "both.0",
        "delay_limit_of_both_ms": "both.1",
        "critical_delay_ms": "critical_delay",
        **same_names("outside_validity", "position", "population", "scope"),
    }

    frequency: float  # frequency, damping_ratio, experimental_fraction: The structure [Hz, -, -]
    damping_ratio: float
    threshold: float  # Error of the whole test [-]
    confidence: float  # Share of the population's ground motions
    a: float  # a, b: Ellipse parameters [-] and [ms²]
    b: float
    critical_delay: float  # Delay [s] at which the loop loses stability
    outside_validity: bool  # Whether the criterion was carried over from another structure
    experimental_fraction: float = 1.0
    # Where the case that the criterion is for lies among its ground motions: "inside", "at the edge" or
    # "outside", where no share is promised
    position: str = "inside"
    promised_from: float = 0.0  # Share from which the criterion promises one
    # Ground motions for which the criterion speaks, in words; empty where it does not state them
    population: str = ""
    # Least value, 5 % and 95 % quantile and greatest value of their lengths and effective durations [s],
    # cycles and magnitudes
    scope: Mapping[str, Sequence[float]] = field(default_factory=dict)

    @property
    def promise(self) -> float | None:
        """Share of the population's ground motions; None where the criterion promises none."""
        return confidence_to_promise(self.confidence, self.position, self.promised_from)

    @property
    def amplitude_error(self) -> float:
        """Tolerable |A − 1| [-] of a rig without delay."""
        return float(np.sqrt(self.a))

    @property
    def delay(self) -> float:
        """Tolerable delay [s] of a rig without amplitude error."""
        return float(np.sqrt(self.b)) / MILLI

    @property
    def both(self) -> tuple[float, float]:
        """Tolerable |A − 1| [-] and delay [s] of a rig with both errors in equal parts."""
        return self.amplitude_error / np.sqrt(2.0), self.delay / np.sqrt(2.0)


def chart_frequencies(criterion: Criterion | None = None) -> list[float]:
    """Give increasing frequencies [Hz] for a chart: shipped ones, or some of a criterion's validity."""
    if criterion is None:
        return list_frequencies()
    low, high = criterion.law.validity.frequency
    return [float(frequency) for frequency in np.unique(np.linspace(low, high, _CHART_FREQUENCIES))]


def tolerable_errors(
    frequencies: Sequence[float],
    damping_ratio: float,
    *,
    threshold: float = 0.05,
    confidences: Sequence[float] = CONFIDENCES,
    metric: str = "rms",
    criterion: Criterion | None = None,
    experimental_fraction: float = 1.0,
) -> list[TolerableErrors]:
    """State tolerable errors before a test, by frequency, then by confidence.

    `frequencies` [Hz]; `threshold`: error of the whole test [-]; `confidences`: shares of the population's
    ground motions. A `criterion` states its own threshold, metric and confidence; by default it is the one
    that ships, at each of the confidences. Limits of α = 1 are carried to another share α of the stiffness in
    the laboratory by the law of :func:`reliab.criterion.experimental_share.growth`. Outside of the
    criterion's validity the nearest structure stands for the one asked for, by dimensionless errors.
    """
    tolerances, larger = [], float(growth(experimental_fraction, damping_ratio))
    for frequency in frequencies:
        structure = Structure(frequency=frequency, damping_ratio=damping_ratio)
        laboratory_structure = replace(structure, experimental_fraction=experimental_fraction)
        criteria = (
            [criterion]
            if criterion is not None
            else [
                default_criterion(frequency, damping_ratio, threshold, confidence, metric=metric)
                for confidence in confidences
            ]
        )
        for candidate in criteria:
            a, b, carried_from = scale_limits(candidate, structure)
            tolerances.append(
                TolerableErrors(
                    frequency=frequency,
                    damping_ratio=damping_ratio,
                    threshold=candidate.threshold,
                    confidence=candidate.confidence,
                    experimental_fraction=experimental_fraction,
                    a=larger * a,
                    b=larger * b,
                    critical_delay=float(critical_delay(laboratory_structure)),
                    outside_validity=carried_from is not None,
                    position=candidate.provenance.position,
                    promised_from=candidate.provenance.promised_from,
                    population=candidate.provenance.population,
                    scope=candidate.provenance.scope,
                )
            )
    return tolerances


def tolerable_sides(
    *,
    f: float,
    xi: float,
    alpha: float = 1.0,
    threshold: float = 0.05,
    confidence: float = 0.95,
    metric: str = "rms",
    duration: float | None = None,
) -> dict[str, tuple[float, float]]:
    """Return the tolerable ellipse, a [-] and b [ms²], of actuators that are late ("lag") and early ("lead").

    Of the criterion that ships; for records of a `duration` [s], or of any length.
    """
    criterion = default_criterion(f, xi, threshold, confidence, metric=metric, duration=duration)
    structure, larger = Structure(frequency=f, damping_ratio=xi), float(growth(alpha, xi))
    limits = {
        str(side): scale_limits(criterion, structure, side)[:2]
        for side in (Side if criterion.knows_leads else (Side.LAG,))
    }
    return {side: (larger * a, larger * b) for side, (a, b) in limits.items()}


def boundaries_of_motions(
    *, f: float, xi: float, alpha: float = 1.0, threshold: float = 0.05, metric: str = "rms"
) -> tuple[Array, Array]:
    """Return a [-] and b [ms²] of each motion that ships, shape (motions,) each, of actuators that are late.

    Those of the nearest shipped structure, carried as limits are; motions without an ellipse are left out.
    """
    table = ellipses_of_nearest(f, xi, metric).interpolate_threshold(threshold)
    near = Structure(
        frequency=float(table.coordinates["f"][0]), damping_ratio=float(table.coordinates["xi"][0])
    )
    lag = table.coordinates["side"].tolist().index(str(Side.LAG))
    a, b = (np.asarray(values[..., lag], dtype=np.float64).ravel() for values in (table.a, table.b))
    larger = float(growth(alpha, xi)) * (xi / near.damping_ratio) ** 2
    is_known = (a > 0.0) & (b > 0.0)
    return larger * a[is_known], larger * (near.frequency / f) ** 2 * b[is_known]
