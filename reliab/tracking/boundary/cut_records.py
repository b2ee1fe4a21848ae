"""How the ellipse of a ground motion changes when its record is cut to another length.

RMS^R is a mean over the record, so that whoever ends a record early takes quiet time away, and a and b shrink
with it. What a motion loses depends on its own shaking. It is computed from the record, to first order in the
actuator's error, as the ratio to the ellipse of the whole record; what larger errors add is nearly the same
in both and drops out.

Between the records of a suite, length and shaking go together: the short ones are close to the fault and
shake briefly. A regression over them says that a short record tolerates more than a long one that is cut.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import error_histories

CUT_LENGTHS: Final = (10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 90.0)
"""Lengths [s] to which records are cut; between them ratios are interpolated."""


def ratios_of_cut_record(
    response: Array,
    time_step: float,
    structure: Structure,
    onset: float,
    lengths: Sequence[float] = CUT_LENGTHS,
) -> Array:
    """Ratios of a and b of a cut record to those of the whole record.

    `response`: exact displacement of the structure over the whole record, in any unit, shape (n,); `onset`
    [s]: where a cut record begins, or earlier where the rest would be too short. A record that is no longer
    than a length stays whole. Returns shape (lengths, 2).

    The free vibration after a short pulse has died long before either end: a and b grow with the length.

    >>> t = np.arange(0.0, 100.0, 0.01)
    >>> decaying = np.exp(-0.6 * t) * np.sin(2.0 * np.pi * t)
    >>> structure = Structure(frequency=1.0, damping_ratio=0.1)
    >>> ratios_of_cut_record(decaying, 0.01, structure, 0.0, (50.0, 200.0)).round(2).tolist()
    [[0.5, 0.5], [1.0, 1.0]]
    """
    _, *histories = error_histories(response, time_step, structure)
    squares = [
        scipy.integrate.cumulative_trapezoid(history**2, dx=time_step, initial=0.0) for history in histories
    ]
    whole, ratios = (response.size - 1) * time_step, np.ones((len(lengths), 2))
    for row, length in enumerate(lengths):
        if length >= whole:
            continue
        begin = round(min(onset, whole - length) / time_step)
        end = min(begin + round(length / time_step), response.size - 1)
        peak = np.abs(response[begin : end + 1]).max() / np.abs(response).max()
        shares = np.array([(square[end] - square[begin]) / square[-1] for square in squares])
        ratios[row] = length / whole * peak**2 / shares
    return ratios
