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

    Parameters
    ----------
    kind : type of Law
        The kind of law.
    law : Law
        The law that was fitted.
    grid : SampleGrid
        The motions.
    limits : array of float, shape (F, X, 2)
        The limits a [-] and b [ms²], positive.

    Returns
    -------
    Law
        The law with all limits times one factor.
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

    Parameters
    ----------
    sample : EllipseSample
        The motions.
    a, b : float
        The limits [-] and [ms²], positive.

    Returns
    -------
    array of float, shape (motions,)
        Factors on a and b; a motion contains the limits where its factor is at least 1.
    """
    return np.minimum(sample.a / a, sample.b / b)
