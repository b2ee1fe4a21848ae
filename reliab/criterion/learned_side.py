"""What a method has learned of one side of the boundaries."""

from dataclasses import dataclass

import numpy as np

from reliab.criterion.law_scaling import contained_alike
from reliab.criterion.laws import FittedLaw, Law, Table
from reliab.criterion.methods import Learned, Method
from reliab.criterion.sample_grid import SampleGrid
from reliab.errors import InputError


@dataclass(frozen=True, kw_only=True, eq=False)
class LearnedSide:
    """One side of the boundaries: its motions, and what a method learned from them."""

    grid: SampleGrid
    learned: Learned

    def law(self, kind: FittedLaw, method: Method, confidence: float, *, joint: bool) -> tuple[Law, int]:
        """Fit a law to the limits; return it with the number of structures at which they are zero."""
        limits = self.learned.limits(confidence, joint=joint)
        for row, column in np.ndindex(limits.shape[:2]):
            sample = self.grid.samples[row][column]
            if not method.carries(confidence, sample.n_motions, sample.n_events):
                limits[row, column] = 0.0
        empty = int((limits <= 0.0).any(axis=-1).sum())
        if empty and kind is not Table:
            raise InputError(
                "A law is fitted to limits that are positive at every structure",
                value=(
                    f"too few motions or earthquakes for {method.name} at {confidence:g} at "
                    f"{empty} structures"
                ),
                remedy="Give more motions or a lower confidence, or keep the limits as a table",
            )
        grid = self.grid.frequencies, self.grid.damping_ratios
        law: Law = kind.fit(*grid, limits[..., 0], limits[..., 1])
        return (law if kind is Table else contained_alike(kind, law, self.grid, limits)), empty
