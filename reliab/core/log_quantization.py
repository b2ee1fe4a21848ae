"""Positive numbers as whole steps of their logarithm, told by differences between neighbours: a small file.

A step s rounds by s/2 of the value at most. Neighbours resemble each other, so that their differences are
small; a whole number k is stored as 2k, or as −2k − 1 below zero, which leaves the higher bytes empty.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array

STEP = "step_of_logarithm"
"""Attribute of a variable that is stored in steps: the step."""
NEIGHBOURS = "differences_along"
"""Attribute of a variable that is stored in steps: the dimensions along which neighbours are."""
UNKNOWN = "unknown_where"
"""Attribute of a variable that is stored in steps: the variable that is not zero where it has no value."""


def to_steps(values: Array, step: float, axes: Sequence[int]) -> NDArray[np.uint32]:
    """Write positive numbers; for what is not finite stands its neighbour along the first of the axes.

    >>> to_steps(np.array([1.0, 1.1, np.nan, 0.9]), 0.1, [0]).tolist()
    [0, 2, 0, 3]
    """
    steps = np.round(np.log(_fill_gaps(values, axes[0])) / step).astype(np.int64)
    for axis in axes:
        steps = np.diff(steps, axis=axis, prepend=0)
    return np.where(steps < 0, -2 * steps - 1, 2 * steps).astype(np.uint32)


def from_steps(
    stored_steps: NDArray[np.uint32], step: float, axes: Sequence[int], last: Sequence[int] = ()
) -> NDArray[np.float32]:
    """Read numbers that :func:`to_steps` wrote; `last`: those of the axes along which only the last is asked.

    >>> from_steps(to_steps(np.array([1.0, 2.0]), 0.01, [0]), 0.01, [0]).round(2).tolist()
    [1.0, 1.9900000095367432]
    """
    if not 0.0 < step < 1.0:
        raise ValueError(f"a step of {step} of the logarithm")
    steps = ((stored_steps >> 1) ^ -(stored_steps & 1)).view(np.int32)
    for axis in last:
        steps = np.sum(steps, axis=axis, dtype=np.int32, keepdims=True)
    for axis in set(axes) - set(last):
        steps = np.cumsum(steps, axis=axis, dtype=np.int32)
    numbers: NDArray[np.float32] = np.exp(np.float32(step) * steps.astype(np.float32))
    return numbers


def numbers_of(
    stored_steps: NDArray[np.uint32],
    attributes: Mapping[str, Any],
    dimensions: Sequence[str],
    last: Sequence[str] = (),
) -> NDArray[np.float32]:
    """Read a variable of a file by its attributes and its dimensions' names.

    Along its neighbours it is given from the first on; `last`: dimensions of which only the last is asked.

    >>> stored = to_steps(np.array([[1.0, 2.0]]), 0.01, [1])
    >>> numbers_of(stored, {STEP: 0.01, NEIGHBOURS: "xi"}, ["f", "xi"]).round(2).tolist()
    [[1.0, 1.9900000095367432]]
    """
    neighbours = str(attributes[NEIGHBOURS]).split()
    axes, ends = (
        [dimensions.index(name) for name in neighbours if name in some] for some in (dimensions, last)
    )
    return from_steps(stored_steps, float(np.ravel(attributes[STEP])[0]), axes, ends)


def _fill_gaps(values: Array, axis: int) -> Array:
    """Values in which the one before stands for one that is not finite, and 1 where there is none before."""
    lanes = np.moveaxis(values, axis, -1)
    places = np.where(np.isfinite(lanes), np.arange(lanes.shape[-1]), -1)
    last_places = np.maximum.accumulate(places, axis=-1)
    complete_lanes = np.where(
        last_places < 0, 1.0, np.take_along_axis(lanes, np.maximum(last_places, 0), axis=-1)
    )
    return np.moveaxis(complete_lanes, -1, axis)
