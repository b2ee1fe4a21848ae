"""The contour of equal error in the plane of amplitude A and delay d, found by root-finding.

The paper's protocol: the amplitude steps by 0.001 from 1 to both sides as far as the contour goes,
and at each amplitude the delay is found at which the error reaches the threshold. Here a contour
that is narrower than five such steps gets a finer step and one wider than a hundred a coarser one.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from reliab.errors import InputError

ErrorOfCells = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]
"""Error [-] of the whole test for given amplitudes [-] and delays [s], shape (cells,)."""

AMPLITUDE_STEP = 0.001
_FEWEST_STEPS, _MOST_STEPS = 5, 100
_FIRST_GUESS = 1e-5  # small against any contour; the error grows in proportion from there
_GROWTH = 1.4
_TIP = 1e-6
_LOWEST_AMPLITUDE = 0.02
_LARGEST_AMPLITUDE = 20.0
_TOLERANCES = {"xrtol": 1e-7, "frtol": 1e-8, "xatol": 1e-12}


@dataclass(frozen=True, kw_only=True)
class Contour:
    """Points at which the error of the whole test equals a threshold.

    Attributes
    ----------
    amplitude : numpy.ndarray
        Amplitude A [-], increasing, shape (points,).
    delay : numpy.ndarray
        Delay d [s], shape (points,).
    """

    amplitude: NDArray[np.float64]
    delay: NDArray[np.float64]


def trace_contour(
    error: ErrorOfCells, threshold: float, *, time_scale: float, amplitude_step: float = AMPLITUDE_STEP
) -> Contour:
    """Trace the contour of equal error around the perfect actuator A = 1, d = 0.

    Parameters
    ----------
    error : callable
        Error [-] of given amplitudes [-] and delays [s]; zero at A = 1, d = 0.
    threshold : float
        Error [-] on the contour, positive.
    time_scale : float
        Time [s] by which delays compare with amplitudes, 1/ω₀ of the structure.
    amplitude_step : float, optional
        Step of the amplitude [-], the paper's 0.001 by default.

    Returns
    -------
    Contour
        At least eleven points with d ≥ 0.

    Raises
    ------
    InputError
        If the error does not reach the threshold however wrong the amplitude is.

    Examples
    --------
    >>> circle = trace_contour(lambda a, d: np.hypot(a - 1.0, d), 0.05, time_scale=1.0)
    >>> circle.amplitude.size, float(circle.delay.max().round(6))
    (99, 0.05)
    """
    if not (np.isfinite(threshold) and threshold > 0.0):
        raise InputError(
            "The error threshold must be positive", value=threshold, remedy="Give a fraction, 0.05 for 5 %"
        )
    lower, upper = _amplitude_range(error, threshold)
    amplitude = _amplitudes(lower, upper, amplitude_step)
    return Contour(
        amplitude=amplitude, delay=_delays(error, threshold, amplitude, (lower, upper), time_scale)
    )


def _amplitude_range(error: ErrorOfCells, threshold: float) -> tuple[float, float]:
    """Amplitudes below and above 1 at which the error reaches the threshold without delay."""
    side = np.array([-1.0, 1.0])

    def excess(change: NDArray[np.float64], side: NDArray[np.float64]) -> NDArray[np.float64]:
        return _finite(error(1.0 + side * change, np.zeros_like(change))) - threshold

    slope = (excess(np.full(2, _FIRST_GUESS), side) + threshold) / _FIRST_GUESS
    outer = threshold / slope
    furthest = np.array([1.0 - _LOWEST_AMPLITUDE, _LARGEST_AMPLITUDE - 1.0])
    outer = np.minimum(outer, furthest)
    while (inside := excess(outer, side) < 0.0).any():
        if (inside & (outer >= furthest)).any():
            raise InputError(
                f"The error must reach the threshold for some amplitude between {_LOWEST_AMPLITUDE:g} and "
                f"{_LARGEST_AMPLITUDE:g}",
                value=f"a threshold of {threshold:g}",
                remedy="Give a smaller threshold",
            )
        outer = np.where(inside, np.minimum(_GROWTH * outer, furthest), outer)
    root = elementwise.find_root(excess, (np.zeros(2), outer), args=(side,), tolerances=_TOLERANCES)
    return 1.0 - float(root.x[0]), 1.0 + float(root.x[1])


def _amplitudes(lower: float, upper: float, step: float) -> NDArray[np.float64]:
    """Amplitudes 1 ± j·step inside the contour."""
    narrow, wide = min(1.0 - lower, upper - 1.0), max(1.0 - lower, upper - 1.0)
    if narrow < (_FEWEST_STEPS + 1) * step:
        step /= np.ceil((_FEWEST_STEPS + 1) * step / narrow)
    if wide > _MOST_STEPS * step:
        step *= np.ceil(wide / (_MOST_STEPS * step))
    # A point at the very tip would have no delay left to find.
    below, above = int((1.0 - lower) / step - _TIP), int((upper - 1.0) / step - _TIP)
    return 1.0 + step * np.arange(-below, above + 1, dtype=np.float64)


def _delays(
    error: ErrorOfCells,
    threshold: float,
    amplitude: NDArray[np.float64],
    ends: tuple[float, float],
    time_scale: float,
) -> NDArray[np.float64]:
    """Delay on the contour at each amplitude."""

    def excess(delay: NDArray[np.float64], amplitude: NDArray[np.float64]) -> NDArray[np.float64]:
        return _finite(error(amplitude, delay)) - threshold

    half_width = np.where(amplitude < 1.0, 1.0 - ends[0], ends[1] - 1.0)
    height = np.sqrt(np.maximum(1.0 - ((amplitude - 1.0) / half_width) ** 2, 1e-3))
    outer = 1.1 * time_scale * half_width * height
    while (inside := excess(outer, amplitude) < 0.0).any():
        outer = np.where(inside, _GROWTH * outer, outer)
    start = np.zeros_like(outer)
    root = elementwise.find_root(excess, (start, outer), args=(amplitude,), tolerances=_TOLERANCES)
    return np.asarray(root.x, dtype=np.float64)


def _finite(error: NDArray[np.float64]) -> NDArray[np.float64]:
    """Put an error beyond any threshold where the loop grew beyond all numbers."""
    return np.nan_to_num(error, nan=1e300, posinf=1e300)
