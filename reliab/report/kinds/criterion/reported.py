"""The criteria of a report, and the structure at which it shows them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from reliab.core.vocabulary import CurveName, Side
from reliab.criterion.criterion import Criterion
from reliab.criterion.ellipse_sample import EllipseSample, sample_of

_PAPER_STRUCTURE = (1.0, 0.02)


@dataclass(frozen=True, kw_only=True, eq=False)
class ReportedCriteria:
    """Criteria with the ellipses behind them, and the structure at which a report shows them."""

    ellipses: xr.Dataset
    criteria: tuple[Criterion, ...]

    @property
    def criterion(self) -> Criterion:
        """The criterion of the verdict."""
        return self.criteria[0]

    @cached_property
    def frequencies(self) -> np.ndarray:
        """Frequencies of the ellipses [Hz], increasing."""
        return np.sort(self.ellipses["f"].values.astype(np.float64))

    @cached_property
    def damping_ratios(self) -> np.ndarray:
        """Damping ratios of the ellipses [-], increasing."""
        return np.sort(self.ellipses["xi"].values.astype(np.float64))

    @cached_property
    def structure(self) -> tuple[float, float]:
        """The structure nearest to the paper's."""
        nearest = (
            float(nodes[np.argmin(np.abs(np.log(nodes / wanted)))])
            for nodes, wanted in zip((self.frequencies, self.damping_ratios), _PAPER_STRUCTURE, strict=True)
        )
        frequency, damping_ratio = nearest
        return frequency, damping_ratio

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Limits a [-] and b [ms²] at the structure."""
        a, b = self.criterion.limits(*self.structure)
        return float(a), float(b)

    @cached_property
    def sample(self) -> EllipseSample:
        """Ellipses of all motions at the structure."""
        frequency, damping_ratio = self.structure
        chosen = self.criterion
        return sample_of(
            self.ellipses,
            frequency=frequency,
            damping_ratio=damping_ratio,
            threshold=chosen.threshold,
            metric=chosen.metric,
            curve=chosen.provenance.curve,
        )

    @property
    def inscribed(self) -> bool:
        """Whether the criterion of the verdict rests on ellipses that lie inside the boundaries."""
        return self.criterion.provenance.curve == CurveName.INSCRIBED

    def lead(self, criterion: Criterion) -> float:
        """Limit of an early actuator without amplitude error at the structure [ms]; NaN where unknown."""
        if criterion.lead_law is None:
            return float("nan")
        _, b = criterion.limits(*self.structure, side=Side.LEAD)
        return float(np.sqrt(b))

    def over_grid(self, criterion: Criterion) -> tuple[np.ndarray, np.ndarray]:
        """Limits a [-] and b [ms²] of late actuators over all structures, shape (F, X)."""
        return criterion.limits(self.frequencies[:, None], self.damping_ratios[None, :])
