"""What a report of criteria tells of, and the structure by which it does."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from reliab.criterion import Criterion, EllipseSample, sample_of

_PAPER_STRUCTURE = (1.0, 0.02)


@dataclass(frozen=True, kw_only=True, eq=False)
class Told:
    """What the report tells of, and the structure by which it does."""

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
        )

    def over_grid(self, criterion: Criterion) -> tuple[np.ndarray, np.ndarray]:
        """Limits a [-] and b [ms²] over all structures, shape (F, X)."""
        return criterion.limits(self.frequencies[:, None], self.damping_ratios[None, :])
