"""What a method has learned of one side of the boundaries, and the law that is fitted to its limits."""

from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import FittedLaw
from reliab.criterion.laws.table import Table
from reliab.criterion.methods.method import Learned, Method
from reliab.criterion.sample_grid import SampleGrid


def contained_alike(kind: FittedLaw, law: Law, grid: SampleGrid, limits: Array) -> Law:
    """Scale a law so that it contains as many motions as the limits that it was fitted to.

    Limits that all motions contain are compared at the depth of the least motion, so that they keep their
    distance from it.

    `limits` (F, X, 2).
    """
    a, b = law.limits(grid.frequencies[:, None], grid.damping_ratios[None, :])
    rooms, rooms_of_law = (
        np.concatenate(
            [room(sample, *pair) for sample, pair in zip(grid.cells, pairs.reshape(-1, 2), strict=True)]
        )
        for pairs in (limits, np.stack([a, b], axis=-1))
    )
    excluded = float(np.mean(rooms < 1.0))
    depth, depth_of_law = (
        float(np.quantile(values, excluded, method="lower")) for values in (rooms, rooms_of_law)
    )
    factor = depth_of_law if excluded > 0.0 else depth_of_law / depth
    return kind.fit(grid.frequencies, grid.damping_ratios, factor * a, factor * b)


def room(sample: EllipseSample, a: float, b: float) -> Array:
    """Factor by which limits could grow before a motion's own ellipse no longer contains theirs.

    Returns (motions,).
    Returns factors on a and b; a motion contains the limits where its factor is at least 1.
    """
    return np.minimum(sample.a / a, sample.b / b)


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
                "A law needs positive limits at every structure",
                value=(
                    f"too few motions or earthquakes for {method.name} at {confidence:g} at "
                    f"{empty} structures"
                ),
                remedy="Give more motions or a lower confidence, or keep the limits as a table",
            )
        grid = self.grid.frequencies, self.grid.damping_ratios
        law: Law = kind.fit(*grid, limits[..., 0], limits[..., 1])
        return (law if kind is Table else contained_alike(kind, law, self.grid, limits)), empty
