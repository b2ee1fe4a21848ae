"""A law that is fitted to limits is scaled, so that it contains as many motions as they do."""

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.laws import FittedLaw, Law
from reliab.criterion.sample_grid import SampleGrid


def contained_alike(kind: FittedLaw, law: Law, grid: SampleGrid, limits: NDArray[np.float64]) -> Law:
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


def room(sample: EllipseSample, a: float, b: float) -> NDArray[np.float64]:
    """Factor by which limits could grow before a motion's own ellipse no longer contains theirs.

    Returns (motions,).
    Returns factors on a and b; a motion contains the limits where its factor is at least 1.
    """
    return np.minimum(sample.a / a, sample.b / b)
