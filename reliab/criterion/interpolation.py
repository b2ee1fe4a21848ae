"""Linear interpolation in the logarithms of frequency and damping ratio."""

import numpy as np
from numpy.typing import NDArray


def tents(nodes: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights of nodes in a linear interpolation over ln x.

    `nodes` (nodes,); `x` any shape; returns (..., nodes).

    >>> tents(np.array([1.0, 4.0, 16.0]), np.array([2.0, 16.0])).tolist()
    [[0.5, 0.5, 0.0], [0.0, 0.0, 1.0]]
    """
    if nodes.size == 1:
        return np.ones((*x.shape, 1))
    grid, at = np.log(nodes), np.clip(np.log(x), np.log(nodes[0]), np.log(nodes[-1]))
    return np.stack([np.interp(at, grid, unit) for unit in np.eye(nodes.size)], axis=-1)
