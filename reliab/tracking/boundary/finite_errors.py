r"""The boundary that a response predicts at errors of finite size, and a traced one beside it.

A delay d feeds energy into the loop: the error's oscillator has the damping ratio ξ' = ξ − ω₀d/2, the exact
response that of the structure, ξ. Under a steady response the mean square of the error is that of small
errors times 2ξ²/(ξ'(ξ + ξ')). With the dimensionless delay δ = ω₀d/ξ, and s the one that small errors would
allow,

.. math:: s^2 (1 − δ/2)(1 − δ/4) = δ^2, \qquad \frac{δ}{s} = \frac{2}{\sqrt{4 + s^2/16} + 3s/4}

which ends at the critical delay δ = 2. A lead takes energy out: −3s/4. No constant is fitted.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
import scipy

from reliab.core.arrays import Array
from reliab.core.vocabulary import MILLI, Side
from reliab.structures.structure import Structure

if TYPE_CHECKING:
    from reliab.tracking.boundary.contour import Contour
    from reliab.tracking.boundary.first_order import FirstOrderEllipse


_WIDEST_LEAD: Final = 2.0  # s up to which a lead is predicted; at √8 no lead reaches the error

DIRECTIONS: Final = np.linspace(0.0, np.pi, 9)
"""Angles at which a boundary is compared with the predicted one, from A > 1 over a delay to A < 1 [rad]."""


def ratio_of_delays(size: Array, side: Side | str) -> Array:
    """Delay on the boundary of a finite error over the one that small errors would allow [-].

    `size`: dimensionless delay s = ω₀d/ξ of small errors, any shape.

    >>> ratio_of_delays(np.array([0.0, 0.5, 100.0]), Side.LAG).round(2).tolist()
    [1.0, 0.84, 0.02]
    >>> ratio_of_delays(np.array([0.0, 0.5]), Side.LEAD).round(2).tolist()
    [1.0, 1.23]
    """
    if Side(side) is Side.LAG:
        return np.asarray(2.0 / (np.sqrt(4.0 + size**2 / 16.0) + 0.75 * size))
    narrow = np.minimum(size, _WIDEST_LEAD)
    return np.asarray(2.0 / (np.sqrt(4.0 + narrow**2 / 16.0) - 0.75 * narrow))


def predict_ellipse(
    response: "FirstOrderEllipse", structure: "Structure", threshold: float, side: Side
) -> tuple[float, float]:
    """Ellipse parameters a [-] and b [ms²] that a response predicts for an error of finite size.

    `threshold` [-].

    >>> from reliab.tracking.boundary.first_order import FirstOrderEllipse
    >>> from reliab.structures.structure import Structure
    >>> response = FirstOrderEllipse(amplitude=0.05, delay=1000.0, effective_duration=4.0, duration=30.0)
    >>> structure = Structure(frequency=1.0, damping_ratio=0.02)
    >>> [round(value, 6) for value in predict_ellipse(response, structure, 0.05, Side.LAG)]
    [0.000125, 1.770767]
    """
    a, b = response.parameters(threshold)
    size = np.sqrt(b) / MILLI * structure.circular_frequency / structure.damping_ratio
    return a, float(b * ratio_of_delays(np.asarray(size), side) ** 2)


def scales_of_contour(contour: "Contour | None", a: float, b: float) -> Array:
    """Multiples of an ellipse's a [-] and b [ms²] at which it reaches a boundary.

    Returns the least of all, whose ellipse lies wholly inside, and those towards `DIRECTIONS`, in the
    ellipse's own angle, shape (10,). Where the boundary is cut or open, they are those of the cut; NaN
    without a boundary.

    >>> from reliab.tracking.boundary.contour import Contour
    >>> angle = np.linspace(0.0, np.pi, 99)
    >>> circle = Contour(amplitude=1.0 + 0.01 * np.cos(angle), delay=0.002 * np.sin(angle))
    >>> scales_of_contour(circle, 5e-5, 4.0).round(2)[[0, 1, 5]].tolist()
    [1.0, 2.0, 1.0]
    """
    if contour is None or contour.amplitude.size == 0:
        return np.full(1 + DIRECTIONS.size, np.nan)
    amplitude, delay = contour.outline
    u, v = (amplitude - 1.0) / np.sqrt(a), np.abs(delay) * MILLI / np.sqrt(b)
    angle, logarithm = np.arctan2(v, u), np.log(u**2 + v**2)
    order = np.argsort(angle)
    towards = np.interp(DIRECTIONS, angle[order], logarithm[order])
    return np.asarray(np.exp(np.concatenate([[logarithm.min()], towards])))


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
    from reliab.tracking.boundary.first_order import error_histories

    _, *histories = error_histories(response, time_step, structure)
    squares = [
        scipy.integrate.cumulative_trapezoid(history**2, dx=time_step, initial=0.0) for history in histories
    ]
    record_duration, ratios = (response.size - 1) * time_step, np.ones((len(lengths), 2))
    for row, length in enumerate(lengths):
        if length >= record_duration:
            continue
        begin = round(min(onset, record_duration - length) / time_step)
        end = min(begin + round(length / time_step), response.size - 1)
        peak = np.abs(response[begin : end + 1]).max() / np.abs(response).max()
        shares = np.array([(square[end] - square[begin]) / square[-1] for square in squares])
        ratios[row] = length / record_duration * peak**2 / shares
    return ratios
