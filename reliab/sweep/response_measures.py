"""What the exact response of a structure says of its boundary under a ground motion."""

from collections.abc import Sequence
from itertools import product

import numpy as np
import xarray as xr

from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.structures.structure import Structure
from reliab.sweep.labels import join_coordinates, motion_coordinates
from reliab.sweep.request import excitation_of
from reliab.tracking.boundary.first_order import first_order_ellipse
from reliab.tracking.indices.window import Window


def measure_responses(
    motions: Sequence[Motion],
    frequencies: Sequence[float],
    damping_ratios: Sequence[float],
    *,
    progress: Progress = silent,
) -> xr.Dataset:
    """Measure what the exact responses of structures say of the boundaries under ground motions.

    `motions`: the ground motions; read one at a time; `frequencies`, `damping_ratios`: the structures [Hz,
    -], wholly in the laboratory. Returns `a_first` [-] and `b_first` [ms²], the ellipse per squared RMS^R of
    the whole record in the limit of small errors, and `effective_duration` [s] = ∫x²dt/max x² of the
    response, over (motion, f, xi), with the coordinates of the motions.

    >>> from reliab.motions.loading import load_motions
    >>> measured = measure_responses(load_motions("synthetic")[:1], [1.0], [0.02, 0.05])
    >>> bool(measured["effective_duration"].max() < measured["duration"].max())
    True
    """
    rows, headers = [], []
    for count, motion in enumerate(motions, start=1):
        excitation = excitation_of(motion, Window())
        ellipses = [
            first_order_ellipse(excitation, Structure(frequency=f, damping_ratio=xi))
            for f, xi in product(frequencies, damping_ratios)
        ]
        rows.append([(ellipse.amplitude, ellipse.delay, ellipse.effective_duration) for ellipse in ellipses])
        headers.append(motion_coordinates([motion]))
        progress(count, len(motions))
    table = np.reshape(rows, (len(rows), len(frequencies), len(damping_ratios), 3))
    names = "a_first", "b_first", "effective_duration"
    return xr.Dataset(
        {name: (("motion", "f", "xi"), table[..., column]) for column, name in enumerate(names)},
        coords={**join_coordinates(headers), "f": list(frequencies), "xi": list(damping_ratios)},
    )
