"""Tests that a criterion is asked about.

A laboratory's tests have an amplitude error and a delay somewhere around the boundary. Here they lie
evenly over the area of an ellipse of twice the typical size, the typical being the geometric means of
a and b over the motions, so that about a quarter of them would be good for the typical motion.
"""

from typing import Final

import numpy as np
import scipy
import xarray as xr

from reliab.validation.cross_validation.cell import Cell
from reliab.validation.cross_validation.region import Actuators
from reliab.vocabulary import MILLI, Side

_SIZE: Final = 2.0


def draw_trials(
    ellipses: xr.Dataset, cell: Cell, count: int, *, side: Side = Side.LAG, seed: int = 0
) -> Actuators:
    """Draw tests for one structure."""
    parameters = cell.parameters(ellipses, side=side)
    half_axes = _SIZE * np.exp([0.5 * np.nanmean(np.log(values)) for values in parameters])
    uniform = scipy.stats.qmc.Sobol(2, rng=seed).random_base2(max(count - 1, 0).bit_length())[:count]
    radius, angle = np.sqrt(uniform[:, 0]), np.pi * uniform[:, 1]
    return Actuators(
        gain=1.0 + half_axes[0] * radius * np.cos(angle),
        delay=side.sign * half_axes[1] * radius * np.sin(angle) / MILLI,
    )
