"""What motions without an ellipse at some structure would have there, drawn from the model itself.

A boundary that reaches beyond where ellipses describe it leaves a motion without one, at high damping and
large errors. Such a motion tolerates more than others. To leave it out everywhere would shift and narrow what
is learned of all motions, which is optimistic at some structures and pessimistic at others.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.hierarchical.strata import (
    EVENT,
    FREQUENCY,
    FREQUENCY_SLOPE,
    MOTION,
    MOTION_SLOPE,
    REMAINDER,
    Grid,
)
from reliab.sampling import Laplace

_ROUNDS = 2


def filled(model: Hierarchical, lacking: NDArray[np.float64], events: NDArray[np.str_]) -> Hierarchical:
    """Add motions that lack some structures to a model of motions that have all.

    What is missing is drawn once, given what the motion has at its other structures, at the mode of the
    posterior; this is done again with the mode of the filled model.

    `lacking` (motions, F, X, 2); `events` (motions,).
    """
    if not len(lacking):
        return model
    completed = model
    for _ in range(_ROUNDS):
        theta = Laplace.about_mode(completed).mode[None]
        law = np.einsum("tq,fxt->fxq", completed.coefficients(theta)[0], completed.terms)
        covariance = _covariance(completed.grid, completed.covariances(theta)[0])
        rng = np.random.default_rng(2017)  # the same draws in every round
        drawn = np.stack([_drawn(motion, law, covariance, rng) for motion in lacking])
        completed = replace(
            model,
            values=np.concatenate([model.values, drawn]),
            events=np.concatenate([model.events, events]),
        )
    return completed


def _covariance(grid: Grid, covariances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Covariance of all values of one motion, shape (F·X·2, F·X·2), from those of the effects."""
    along_f, along_xi = grid.shape
    everywhere, same = np.ones((along_f, along_f)), np.eye(along_f)
    level, slope = np.ones((along_xi, along_xi)), np.outer(grid.eta, grid.eta)
    over_structures = {
        EVENT: np.kron(everywhere, level),
        MOTION: np.kron(everywhere, level),
        MOTION_SLOPE: np.kron(everywhere, slope),
        FREQUENCY: np.kron(same, level),
        FREQUENCY_SLOPE: np.kron(same, slope),
        REMAINDER: np.eye(along_f * along_xi),
    }
    pairs = [np.array([[aa, ab], [ab, bb]]) for aa, bb, ab in covariances]
    parts = (np.kron(over_structures[name], pair) for name, pair in zip(grid.effects, pairs, strict=True))
    return np.asarray(sum(parts))


def _drawn(
    values: NDArray[np.float64],
    law: NDArray[np.float64],
    covariance: NDArray[np.float64],
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Draw what one motion lacks given what it has, shape (F, X, 2)."""
    y, centre = values.ravel().copy(), law.ravel()
    gone = np.isnan(y)
    has = covariance[np.ix_(~gone, ~gone)]
    weight = np.linalg.solve(has, covariance[np.ix_(~gone, gone)]).T
    mean = centre[gone] + weight @ (y[~gone] - centre[~gone])
    remaining = covariance[np.ix_(gone, gone)] - weight @ covariance[np.ix_(~gone, gone)]
    y[gone] = rng.multivariate_normal(mean, remaining, method="eigh")
    return y.reshape(values.shape)
