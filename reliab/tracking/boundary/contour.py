"""The contour of equal error in the plane of amplitude A and delay d, found by root-finding.

The paper's protocol: the amplitude steps by 0.001 from 1 to both sides as far as the contour goes,
and at each amplitude the delay is found at which the error reaches the threshold. Here a contour
that is narrower than five such steps gets a finer step and one wider than a hundred a coarser one.

A contour has two sides: actuators that are late, and actuators that are early. They differ, because a delay
reduces the damping of the loop and a lead increases it.

Between the cells of a stored grid the logarithm of the squared error, which is smooth where the error itself
has a tip (at the perfect actuator) or grows beyond all bounds (beyond the critical delay), is a bicubic
spline in coordinates that are linear at the perfect actuator, logarithmic around it and linear again further
out, where the error saturates or grows exponentially. Many surfaces on one grid are evaluated together.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.compiled import compiled
from reliab.core.errors import InputError
from reliab.core.vocabulary import Side
from reliab.structures.structure import Structure, longest_lead

_FLOOR = 3e-4  # errors below this are not resolved
_LARGEST_ERROR = 1e3


GAIN_SCALE, DELAY_SCALE = 0.2, 0.1
"""Shares of the largest |ln k_p| and delay beyond which the coordinates are linear."""


def stretch_coordinate(value: Array, core: float, scale: float) -> Array:
    """Coordinate that is linear below the core, logarithmic up to the scale, and linear beyond.

    `value`: values, any shape and unit; `core`, `scale`: limits of the logarithmic part, in the unit of the
    values. Returns coordinate [-], odd and increasing in the value.
    """
    return np.arcsinh(value / core) + value / scale


class ErrorSurfaces:
    """Errors over one grid of gains and delays, interpolated.

    `gain`: gains k_p [-], increasing, with 1 among them, shape (kp,); `delay`: delays τ [s], increasing, with
    0 among them; negative for leads, shape (tau,); `error`: errors [-], shape (surfaces, kp, tau).
    """

    def __init__(self, gain: Array, delay: Array, error: Array) -> None:
        offset = np.log(gain)
        unit_gain_index = int(np.argmin(np.abs(offset)))
        self._cores = (max(offset[unit_gain_index + 1], -offset[unit_gain_index - 1]), delay[delay > 0.0][0])
        self._scales = (GAIN_SCALE * max(offset[-1], -offset[0]), DELAY_SCALE * delay[-1])
        self._ends = (gain[0], gain[-1], delay[0], delay[-1])
        bounded_error = np.minimum(np.nan_to_num(error, nan=np.inf), _LARGEST_ERROR)
        values = np.log(bounded_error.astype(np.float64) ** 2 + _FLOOR**2)
        self._edges = self._stretch(offset, 0), self._stretch(delay, 1)
        gain_spline = scipy.interpolate.CubicSpline(self._edges[0], values, axis=1).c  # (4, kp, surface, tau)
        delay_spline = scipy.interpolate.CubicSpline(
            self._edges[1], gain_spline, axis=3
        ).c  # (4, tau, 4, kp, surface)
        self._patches = np.ascontiguousarray(delay_spline.transpose(4, 3, 1, 2, 0))

    def _stretch(self, value: Array, axis: int) -> Array:
        return stretch_coordinate(value, self._cores[axis], self._scales[axis])

    def error(self, amplitude: Array, delay: Array, surface: NDArray[np.int64]) -> Array:
        """Error of given actuators.

        `amplitude`, `delay`: gain [-] and delay [s], shape (cells,); `surface`: index of the surface for each
        actuator, shape (cells,). Returns error [-], shape (cells,); NaN outside the grid.
        """
        lowest, highest, earliest, latest = self._ends
        is_on_grid = (amplitude >= lowest * (1 - 1e-9)) & (amplitude <= highest * (1 + 1e-9))
        is_on_grid &= (delay >= earliest * (1 + 1e-9)) & (delay <= latest)
        offset = np.log(np.clip(amplitude, lowest, highest))
        place = self._stretch(offset, 0), self._stretch(np.clip(delay, earliest, latest), 1)
        value = _evaluate(*self._edges, self._patches, *place, surface)
        return np.where(is_on_grid, np.sqrt(np.maximum(np.exp(value) - _FLOOR**2, 0.0)), np.nan)


@compiled
def _evaluate(
    gain_edges: Array,
    delay_edges: Array,
    patches: Array,
    gain: Array,
    delay: Array,
    surface: NDArray[np.int64],
) -> Array:
    """Bicubic patches by Horner's scheme; shape of the patches (surface, kp, tau, 4, 4)."""
    errors = np.empty(gain.size)
    for cell in range(gain.size):
        i = min(max(np.searchsorted(gain_edges, gain[cell], side="right") - 1, 0), gain_edges.size - 2)
        j = min(max(np.searchsorted(delay_edges, delay[cell], side="right") - 1, 0), delay_edges.size - 2)
        x, y = gain[cell] - gain_edges[i], delay[cell] - delay_edges[j]
        patch = patches[surface[cell], i, j]
        total = 0.0
        for row in range(4):
            row_value = ((patch[row, 0] * y + patch[row, 1]) * y + patch[row, 2]) * y + patch[row, 3]
            total = total * x + row_value
        errors[cell] = total
    return errors


ErrorOfCells = Callable[[Array, Array, NDArray[np.int64]], Array]
"""Error [-] of the whole test for amplitudes [-], delays [s] and indices of contours, shape (cells,)."""

AMPLITUDE_STEP = 0.001
_FEWEST_STEPS, _MOST_STEPS = 5, 100
_THRESHOLDS = (1e-6, 10.0)
_FIRST_GUESS = 1e-5  # small against any contour; the error grows in proportion from there
_GROWTH = 1.4
_TIP = 1e-6
REACH = 5.0
"""A contour is cut where |ln A| exceeds this many damping ratios."""

LEAD_REACH = 7.0
"""Leads are searched up to this many ξ/ω₀, or to a quarter of the period where that is shorter: a longer lead
damps the structure so much that the error no longer grows."""

_TOLERANCES = {"xrtol": 1e-7, "frtol": 1e-8, "xatol": 1e-12}


@dataclass(frozen=True, kw_only=True)
class Contour:
    """Points at which the error of the whole test equals a threshold."""

    amplitude: Array  # Amplitude A [-], increasing, shape (points,)
    delay: Array  # Delay d [s], shape (points,); negative on the side of leads
    # Amplitudes [-] and delays [s] of the further points that bound the region inside the contour: the tips,
    # at which the contour meets d = 0 or is cut, and the longest lead searched where no lead reaches the
    # threshold, of shape (2, corners)
    corners: Array = field(default_factory=lambda: np.zeros((2, 0)))

    @property
    def outline(self) -> tuple[Array, Array]:
        """Amplitudes [-] and delays [s] of the whole outline of the region, points and corners together."""
        return (
            np.concatenate([self.amplitude, self.corners[0]]),
            np.concatenate([self.delay, self.corners[1]]),
        )


def furthest_lead(structure: Structure, gain: Array) -> Array:
    """Longest lead [s] that is searched, at amplitudes [-] of any shape."""
    reach = LEAD_REACH * structure.damping_ratio / structure.circular_frequency
    return np.minimum(reach, longest_lead(structure, gain))


def trace_contours(
    error: ErrorOfCells,
    thresholds: Array,
    structure: Structure,
    *,
    amplitude_step: float = AMPLITUDE_STEP,
    side: Side | Sequence[Side] = Side.LAG,
) -> list[Contour]:
    """Trace contours of equal error around the perfect actuator A = 1, d = 0.

    All contours advance together, so that the error is asked for many cells at once. A contour is
    cut at five damping ratios of amplitude error: further out the loop resonates at another
    frequency than the structure, the error no longer grows, and no ellipse describes the contour.
    Below 10 % RMS^R hardly any contour reaches that far. On the side of leads a contour is open where no
    lead, up to the longest that is searched, reaches the threshold.

    `error`: error [-] of given amplitudes [-] and delays [s] for the contours of given indices; smallest near
    A = 1, d = 0; `thresholds`: error [-] on each contour, positive, shape (contours,); `structure`: the
    structure under test, which sets the scale of amplitudes, ξ, and of delays, 1/ω₀; `amplitude_step`: step
    of the amplitude [-], the paper's 0.001 by default; `side`: side of all contours, or of each; actuators
    that are late by default. Returns one for each threshold, each of at least eleven amplitudes; fewer points
    where it is open; without points and corners where even the perfect actuator exceeds the threshold,
    because the loop has other errors.

    >>> def error(amplitude, delay, contour):
    ...     return np.hypot(amplitude - 1.0, delay)
    >>> structure = Structure(frequency=1.0, damping_ratio=0.02)
    >>> (circle,) = trace_contours(error, np.array([0.05]), structure)
    >>> circle.amplitude.size, float(circle.delay.max().round(6))
    (99, 0.05)
    """
    wrong = ~((thresholds >= _THRESHOLDS[0]) & (thresholds <= _THRESHOLDS[1]))
    if wrong.any():
        raise InputError(
            f"The error threshold must lie between {_THRESHOLDS[0]:g} and {_THRESHOLDS[1]:g}",
            value=thresholds[wrong][0],
            remedy="Give a fraction, 0.05 for 5 %",
        )
    sides = [side] * thresholds.size if isinstance(side, Side) else list(side)
    sign = np.array([direction.sign for direction in sides])
    nowhere = np.zeros(0)
    contours = [Contour(amplitude=nowhere, delay=nowhere) for _ in thresholds]
    everyone = np.arange(thresholds.size)
    least = _finite(error(np.ones(everyone.size), np.zeros(everyone.size), everyone))
    crossing_indices = np.flatnonzero(least < thresholds)
    if crossing_indices.size:
        crossing_contours = _trace(
            lambda amplitude, delay, contour: error(amplitude, delay, crossing_indices[contour]),
            thresholds[crossing_indices],
            sign[crossing_indices],
            structure,
            amplitude_step,
        )
        for place, contour in zip(crossing_indices.tolist(), crossing_contours, strict=True):
            contours[place] = contour
    return contours


def _trace(
    error: ErrorOfCells, thresholds: Array, sign: Array, structure: Structure, amplitude_step: float
) -> list[Contour]:
    """Trace contours that enclose the perfect actuator; the sign is that of their delays."""
    half_widths = _half_widths(error, thresholds, REACH * structure.damping_ratio)
    offsets = [_offsets(lower_width, upper_width, amplitude_step) for lower_width, upper_width in half_widths]
    owner = np.repeat(np.arange(thresholds.size), [offset.size for offset in offsets])
    offset = np.concatenate(offsets)
    furthest = np.where(sign[owner] < 0.0, furthest_lead(structure, 1.0 + offset), np.inf)
    size, has_delay = _delays(error, thresholds, sign, (offset, owner), half_widths, structure, furthest)
    contours = []
    for side, (lower_width, upper_width) in enumerate(half_widths):
        here = owner == side
        amplitude, delay, complete = 1.0 + offset[here], sign[side] * size[here], has_delay[here]
        tips = np.array([[1.0 - lower_width, 1.0 + upper_width], [0.0, 0.0]])
        cut = np.stack([amplitude[~complete], delay[~complete]])
        contours.append(
            Contour(
                amplitude=amplitude[complete],
                delay=delay[complete],
                corners=np.concatenate([tips, cut], axis=1),
            )
        )
    return contours


def _half_widths(error: ErrorOfCells, thresholds: Array, reach: float) -> Array:
    """Amplitude offsets below and above 1 at which each contour ends; shape (contours, 2)."""
    from scipy.optimize import elementwise

    owner = np.repeat(np.arange(thresholds.size), 2)
    side = np.tile([-1.0, 1.0], thresholds.size)
    furthest = np.abs(np.expm1(side * reach))

    def excess(offset: Array, side: Array, owner: NDArray[np.int64]) -> Array:
        return _finite(error(1.0 + side * offset, np.zeros_like(offset), owner)) - thresholds[owner]

    guess = np.full(owner.size, _FIRST_GUESS)
    slope = (excess(guess, side, owner) + thresholds[owner]) / guess
    outer = np.minimum(thresholds[owner] / slope, furthest)
    while ((is_inside := excess(outer, side, owner) < 0.0) & (outer < furthest)).any():
        outer = np.where(is_inside, np.minimum(_GROWTH * outer, furthest), outer)
    root = elementwise.find_root(
        excess, (np.zeros_like(outer), outer), args=(side, owner), tolerances=_TOLERANCES
    )
    return np.where(is_inside, furthest, root.x).reshape(-1, 2)


def _offsets(lower_width: float, upper_width: float, step: float) -> Array:
    """Amplitude offsets ± j·step inside a contour."""
    narrow, wide = min(lower_width, upper_width), max(lower_width, upper_width)
    if narrow < (_FEWEST_STEPS + 1) * step:
        step /= np.ceil((_FEWEST_STEPS + 1) * step / narrow)
    if wide > _MOST_STEPS * step:
        step *= np.ceil(wide / (_MOST_STEPS * step))
    # At the tip itself the delay is zero, and there is nothing to search for.
    first, last = int(lower_width / step - _TIP), int(upper_width / step - _TIP)
    return step * np.arange(-first, last + 1, dtype=np.float64)


def _delays(
    error: ErrorOfCells,
    thresholds: Array,
    sign: Array,
    places: tuple[Array, NDArray[np.int64]],
    half_widths: Array,
    structure: Structure,
    furthest: Array,
) -> tuple[Array, NDArray[np.bool_]]:
    """Size of the delay on its contour at each amplitude, and whether one exists in the range searched."""
    from scipy.optimize import elementwise

    offset, owner = places

    def excess(size: Array, offset: Array, owner: NDArray[np.int64]) -> Array:
        return _finite(error(1.0 + offset, sign[owner] * size, owner)) - thresholds[owner]

    half_width = half_widths[owner, (offset > 0.0).astype(np.int64)]
    height = np.sqrt(np.maximum(1.0 - (offset / half_width) ** 2, 1e-3))
    outer = np.minimum(1.1 / structure.circular_frequency * half_width * height, furthest)
    while ((is_inside := excess(outer, offset, owner) < 0.0) & (outer < furthest)).any():
        outer = np.where(is_inside, np.minimum(_GROWTH * outer, furthest), outer)
    size = outer.copy()
    is_closed = ~is_inside
    if is_closed.any():
        root = elementwise.find_root(
            excess,
            (np.zeros(int(is_closed.sum())), outer[is_closed]),
            args=(offset[is_closed], owner[is_closed]),
            tolerances=_TOLERANCES,
        )
        size[is_closed] = root.x
    return size, is_closed


def _finite(error: Array) -> Array:
    """Replace errors of diverged loops, which are not finite, by an error above any threshold."""
    return np.nan_to_num(error, nan=1e300, posinf=1e300)
