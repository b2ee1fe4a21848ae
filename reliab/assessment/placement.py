"""Position of a test in the (A, d) plane among the boundaries of a population of ground motions."""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from reliab.core.vocabulary import Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.laws.law import Validity
from reliab.structures.structure import Structure

LARGEST_PROBABILITY: Final = 0.99
"""Largest probability stated for a population of ground motions: higher ones were not validated."""

_DRAWS = 200


def cap_probability(probability: float | None) -> float | None:
    """Probability limited to the range that was validated; None where it is not known.

    >>> cap_probability(1.0), cap_probability(0.4), cap_probability(None)
    (0.99, 0.4, None)
    """
    if probability is None:
        return None
    return min(max(probability, 1.0 - LARGEST_PROBABILITY), LARGEST_PROBABILITY)


@dataclass(frozen=True, kw_only=True)
class Placement:
    """A test against a criterion."""

    # a, b: Limits [-] and [ms²] of the structure, on the test's side where the criterion has limits for it
    a: float
    b: float
    # (A − 1)²/a + d²/b; the test is accepted up to 1. None where the test leads and the criterion has no
    # limits for leads
    index: float | None
    index_interval: tuple[float, float] | None  # 95 % interval of the index; None likewise
    # Probability that the error stays below the threshold, over ground motions and over what noise leaves
    # open of A and d; None where no motions stand behind the criterion
    probability: float | None
    # Structure [Hz, -] from which the criterion was carried over, if the test's lies outside
    carried_from: tuple[float, float] | None

    @property
    def amplitude_limit(self) -> float:
        """Tolerable |A − 1| [-] without delay."""
        return float(np.sqrt(self.a))

    @property
    def delay_limit_ms(self) -> float:
        """Tolerable delay [ms] without amplitude error."""
        return float(np.sqrt(self.b))

    @property
    def accepted(self) -> bool | None:
        """Whether the test is accepted; None where it has no index."""
        return None if self.index is None else self.index <= 1.0

    @property
    def capped_probability(self) -> float | None:
        """Probability as far as it was validated."""
        return cap_probability(self.probability)

    @property
    def is_carried(self) -> bool:
        """Whether the criterion was carried over from another structure."""
        return self.carried_from is not None


@dataclass(frozen=True, kw_only=True)
class _NearestStructure:
    """The nearest valid structure, and the scaling of errors from one structure to the other."""

    frequency: float
    damping_ratio: float
    amplitude_factor: float
    delay_factor: float

    @classmethod
    def clip(cls, validity: Validity, structure: Structure) -> "_NearestStructure":
        """Clip a structure; errors keep their dimensionless size, (A − 1)/ξ and dω₀/ξ."""
        f = float(np.clip(structure.frequency, *validity.frequency))
        xi = float(np.clip(structure.damping_ratio, *validity.damping_ratio))
        factor = xi / structure.damping_ratio
        return cls(
            frequency=f,
            damping_ratio=xi,
            amplitude_factor=factor,
            delay_factor=factor * structure.frequency / f,
        )

    def errors(
        self, amplitude: NDArray[np.float64], delay: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float]:
        """Return A [-], d [s] and the structure [Hz, -] as criteria take them."""
        scaled_errors = 1.0 + self.amplitude_factor * (amplitude - 1.0), self.delay_factor * delay
        return *scaled_errors, self.frequency, self.damping_ratio


def place(
    criterion: Criterion, structure: Structure, amplitude: float, delay: float, draws: NDArray[np.float64]
) -> Placement:
    """Place a test against a criterion."""
    nearest = _NearestStructure.clip(criterion.law.validity, structure)
    side = Side.LEAD if delay < 0.0 else Side.LAG
    knows_leads = criterion.knows_leads
    if not knows_leads and float(np.quantile(draws[1], 0.975)) < 0.0:
        a, b, carried_from = scale_limits(criterion, structure)
        return Placement(
            a=a, b=b, index=None, index_interval=None, probability=None, carried_from=carried_from
        )
    if not knows_leads:  # no lead that noise does not explain: the limits for lags begin at d = 0
        delay, side = max(delay, 0.0), Side.LAG
        draws = np.stack([draws[0], np.maximum(draws[1], 0.0)])
    a, b, carried_from = scale_limits(criterion, structure, side)
    index = criterion.index(*nearest.errors(np.array([amplitude]), np.array([delay])))
    spread = criterion.index(*nearest.errors(draws[0], draws[1]))
    low, high = np.quantile(spread, [0.025, 0.975]).tolist()
    return Placement(
        a=a,
        b=b,
        index=float(index[0]),
        index_interval=(low, high),
        probability=_probability(criterion, structure, draws[:, :_DRAWS]),
        carried_from=carried_from,
    )


def scale_limits(
    criterion: Criterion, structure: Structure, side: Side = Side.LAG
) -> tuple[float, float, tuple[float, float] | None]:
    """Limits of any structure, scaled from the nearest structure for which the criterion is valid.

    Returns a [-] and b [ms²], of which a/ξ² and bω₀²/ξ² are those of the nearest valid structure, and that
    structure [Hz, -] if it is another one.
    """
    criterion.require_converged()
    nearest = _NearestStructure.clip(criterion.law.validity, structure)
    a, b = (float(limit) for limit in criterion.limits(nearest.frequency, nearest.damping_ratio, side))
    place = nearest.frequency, nearest.damping_ratio
    is_outside = place != (structure.frequency, structure.damping_ratio)
    return a / nearest.amplitude_factor**2, b / nearest.delay_factor**2, place if is_outside else None


def _probability(criterion: Criterion, structure: Structure, draws: NDArray[np.float64]) -> float | None:
    if criterion.population is None:
        return None
    nearest = _NearestStructure.clip(criterion.population.validity, structure)
    return float(np.mean(criterion.probability(*nearest.errors(draws[0], draws[1]))))
