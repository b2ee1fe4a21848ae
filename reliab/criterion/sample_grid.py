"""Ellipses of ground motions over a grid of structures: what limits are learned from."""

from dataclasses import dataclass
from typing import Self

from reliab.core.arrays import Array
from reliab.criterion.ellipse_sample import EllipseSample, sample_of
from reliab.criterion.ellipse_table import Ellipses, tabled
from reliab.criterion.population import Population


@dataclass(frozen=True, kw_only=True, eq=False)
class SampleGrid:
    """Ellipses at one error, of one curve, on one side of the boundaries."""

    # Motions of each structure, shape (frequencies, damping ratios)
    samples: tuple[tuple[EllipseSample, ...], ...]
    population: Population  # The same motions with gaps where they have no ellipse
    n_motions: int  # Number of motions that were offered
    threshold: float  # Error on the boundaries [-]
    metric: str  # metric, curve, side: Which error, which ellipses, and which side
    curve: str
    side: str

    @classmethod
    def from_ellipses(
        cls, ellipses: Ellipses, *, threshold: float, metric: str, curve: str, side: str
    ) -> Self:
        """Take the ellipses of one error, curve and side, in increasing order of f and ξ."""
        table = tabled(ellipses)
        chosen = {"threshold": threshold, "metric": metric, "curve": curve, "side": side}
        population = Population.from_ellipses(table, **chosen)  # type: ignore[arg-type]
        samples = tuple(
            tuple(sample_of(table, frequency=f, damping_ratio=xi, **chosen) for xi in damping_ratios)  # type: ignore[arg-type]
            for damping_ratios in [population.damping_ratios.tolist()]
            for f in population.frequencies.tolist()
        )
        return cls(samples=samples, population=population, n_motions=table.n_motions, **chosen)  # type: ignore[arg-type]

    @property
    def cells(self) -> list[EllipseSample]:
        """Motions of each structure, the damping ratio varying fastest."""
        return [sample for row in self.samples for sample in row]

    @property
    def frequencies(self) -> Array:
        """Natural frequencies [Hz], shape (F,), increasing."""
        return self.population.frequencies

    @property
    def damping_ratios(self) -> Array:
        """Damping ratios [-], shape (X,), increasing."""
        return self.population.damping_ratios

    @property
    def fewest_events(self) -> int:
        """Least number of earthquakes at a structure."""
        return min(sample.n_events for sample in self.cells)

    @property
    def fewest_motions(self) -> int:
        """Least number of motions with an ellipse at a structure."""
        return min(sample.n_motions for sample in self.cells)
