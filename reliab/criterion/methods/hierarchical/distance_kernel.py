"""Distances of many motions in Student's t distribution, compiled."""

import numpy as np
from numpy.typing import NDArray

from reliab.compiled import compiled


@compiled
def log_distances(
    strayed: NDArray[np.float64],
    effects: NDArray[np.float64],
    groups: NDArray[np.int64],
    degrees: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Sum ln(1 + d²/ν) over the motions of each earthquake."""
    vectors, events, nodes, _ = effects.shape
    sums = np.zeros((vectors, events, nodes))
    for vector in range(vectors):
        share = 1.0 / degrees[vector]
        for motion in range(groups.size):
            event = groups[motion]
            first, second = strayed[vector, motion, 0], strayed[vector, motion, 1]
            for node in range(nodes):
                along = first - effects[vector, event, node, 0]
                across = second - effects[vector, event, node, 1]
                sums[vector, event, node] += np.log(1.0 + share * (along * along + across * across))
    return sums
