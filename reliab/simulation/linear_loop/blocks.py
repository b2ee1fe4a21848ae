"""The record divided into equal blocks of time whose length depends on the structure only.

A stepping engine advances in equal blocks. In each block the record a_g is replaced by the straight
line, from a₀ to a₁, that has exactly the same effect on the structure's own mode z' = pz + a_g::

    F₀a₀ + F₁a₁ = z(t + H) − e^(pH)z(t),   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

(two real numbers for one complex one). A mode whose pole lies near p, as it does for a small actuator error,
then responds to the line nearly as to the record. The exact response x_I follows from the same z.

In the compiled loops the mode is z' = pz + a_g. Complex numbers are multiplied in their parts, without the
search for NaN that a compiler adds to a complex product.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum, read_only
from reliab.core.compiled import compiled
from reliab.simulation.excitation import Excitation
from reliab.structures.structure import Structure

_SAMPLE_TOLERANCE = 1e-9  # of the record's step; a time closer than this to a sample counts as that sample's
_NEAR_PEAK = 0.97  # a block that ends this high may hold the peak of the exact response
_PARTS = 16  # into which such a block is divided

Weights = tuple[complex, complex, complex]
"""F₀, F₁ and decay of a mode, as of `blocks.ramp_weights`."""

Way = tuple[float, float, float, float, float, float]
"""What the mode becomes some time s after a sample, as factors of z, of the acceleration there and of its
change to the next sample: z(t + s) = e^(ps)z + a(e^(ps) − 1)/p + a'(e^(ps) − 1 − ps)/p². Real and imaginary
parts."""


@compiled
def _next(weights: Weights, x: float, y: float, a: float, b: float) -> tuple[float, float]:
    """Give z at the next sample, up to which the acceleration goes from a to b."""
    early, late, decay = weights
    u = (early.real * a + late.real * b) + (decay.real * x - decay.imag * y)
    v = (early.imag * a + late.imag * b) + (decay.real * y + decay.imag * x)
    return u, v


@compiled
def sample_record(record: Array, weights: Weights) -> Array:
    """Exact z at the samples of a record, real and imaginary part, from rest; shape (samples, 2)."""
    z, x, y = np.zeros((record.size, 2)), 0.0, 0.0
    for i in range(record.size - 1):
        x, y = _next(weights, x, y, record[i], record[i + 1])
        z[i + 1, 0], z[i + 1, 1] = x, y
    return z


@compiled
def _place_of(time: float, h: float, samples: int) -> tuple[int, float]:
    """Sample before a time [s], −1 before the record, and the time from there [s]."""
    if time <= 0.0:
        return -1, 0.0
    i = min(int(time * (1.0 / h) + 1e-9), samples - 2)
    elapsed = time - i * h
    return i, 0.0 if elapsed < _SAMPLE_TOLERANCE * h else elapsed


@compiled
def _way(elapsed: float, h: float, pole: complex) -> Way:
    """Way of the mode from a sample to a time after it [s]."""
    if elapsed == 0.0:
        return 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    inverse = 1.0 / pole
    growth = np.exp(pole * elapsed)
    constant_part = (growth - 1.0) * inverse
    ramp = (constant_part - elapsed) * inverse
    return (
        growth.real,
        growth.imag,
        constant_part.real,
        constant_part.imag,
        ramp.real * (1.0 / h),
        ramp.imag * (1.0 / h),
    )


@compiled
def _interpolate_ground(way: Way, x: float, y: float, a: float, b: float) -> tuple[float, float]:
    """Give z between two samples, from z at the first and the accelerations of both."""
    u = (way[0] * x - way[1] * y) + (a * way[2] + (b - a) * way[4])
    v = (way[1] * x + way[0] * y) + (a * way[3] + (b - a) * way[5])
    return u, v


@compiled
def _cut_record(
    record: Array,
    pole: complex,
    weights: tuple[Weights, Weights],
    edges: tuple[NDArray[np.int64], Array],
    lines: tuple[Array, Array, Array],
) -> None:
    """Lines and exact response of one record, into arrays; the mode advances from sample to sample."""
    sample_weights, (early, late, decay) = weights
    (place, ways), (left, right, ideal) = edges, lines
    scale = 1.0 / (early.real * late.imag - early.imag * late.real)
    height = -1.0 / pole.imag  # x_I = −2Re(z/(p − p̄))
    x, y, position = 0.0, 0.0, 0
    p, q = 0.0, 0.0
    for k in range(ideal.size):
        i = place[k]
        while position < i:
            x, y = _next(sample_weights, x, y, record[position], record[position + 1])
            position += 1
        r, s = 0.0, 0.0
        if i >= 0:
            way = (ways[k, 0], ways[k, 1], ways[k, 2], ways[k, 3], ways[k, 4], ways[k, 5])
            r, s = _interpolate_ground(way, x, y, record[i], record[i + 1])
        if k > 0:
            u = r - (decay.real * p - decay.imag * q)
            v = s - (decay.real * q + decay.imag * p)
            left[k - 1] = (late.imag * u - late.real * v) * scale
            right[k - 1] = (early.real * v - early.imag * u) * scale
        ideal[k] = s * height
        p, q = r, s


@compiled
def cut_records(
    record: tuple[Array, float],
    poles: Spectrum,
    weights: tuple[Spectrum, Spectrum],
    spacings: tuple[Array, Array, NDArray[np.int64]],
) -> tuple[Array, Array, Array]:
    """Straight lines that drive modes from edge to edge, and the exact response there.

    `spacings` [s].
    Returns `left, right`: ground acceleration at the ends of each block, those of one mode after those of
    another, shape (records, blocks of all modes).
    Returns `ideal`: exact response x_I [m] at the edges of the blocks, shape (records, blocks of all modes +
    modes).
    """
    (records, h), (starts, steps, counts) = record, spacings
    number, total, longest = records.shape[0], 0, 0
    for count in counts:
        total, longest = total + count, max(longest, count)
    left, right = np.empty((number, total)), np.empty((number, total))
    ideal = np.empty((number, total + poles.size))
    place, ways = np.empty(longest + 1, dtype=np.int64), np.empty((longest + 1, 6))
    i = 0
    for n in range(poles.size):
        sample_weights, longer = weights[0][n], weights[1][n]
        both = (sample_weights[0], sample_weights[1], sample_weights[2]), (longer[0], longer[1], longer[2])
        blocks, edges = (slice(i, i + counts[n]), slice(i + n, i + n + counts[n] + 1))
        sample_way = offset_way = _way(0.0, h, poles[n])
        last_start = 0.0
        for k in range(counts[n] + 1):
            place[k], elapsed = _place_of(starts[n] + steps[n] * k, h, records.shape[1])
            if (
                elapsed > 0.0 and abs(elapsed - last_start) > _SAMPLE_TOLERANCE * h
            ):  # edges often lie alike between samples
                last_start, offset_way = elapsed, _way(elapsed, h, poles[n])
            way = offset_way if elapsed > 0.0 else sample_way
            ways[k, 0], ways[k, 1], ways[k, 2], ways[k, 3], ways[k, 4], ways[k, 5] = way
        for m in range(number):
            lines = left[m, blocks], right[m, blocks], ideal[m, edges]
            _cut_record(records[m], poles[n], both, (place, ways), lines)
        i += counts[n]
    return left, right, ideal


@compiled
def peak_of_mode(
    record: tuple[Array, float],
    pole: complex,
    weights: Weights,
    ideal: Array,
    window: tuple[float, float],
    step: float,
) -> float:
    """Largest |x_I| [m] inside the window, between the edges of blocks too.

    `step` [s]; `ideal` [m]; `window` [s].
    """
    a, h = record
    samples = sample_record(a[0], weights)
    high = 0.0
    for edge in ideal:
        high = max(high, abs(edge))
    largest = 0.0
    for k in range(ideal.size - 1):
        if max(abs(ideal[k]), abs(ideal[k + 1])) >= _NEAR_PEAK * high:
            for place in range(_PARTS + 1):
                time = min(window[0] + step * (k + place / _PARTS), window[1])
                i, elapsed = _place_of(time, h, a.shape[1])
                if i >= 0:
                    way = _way(elapsed, h, pole)
                    _, y = _interpolate_ground(way, samples[i, 0], samples[i, 1], a[0, i], a[0, i + 1])
                    largest = max(largest, abs(y))
    return largest / pole.imag


LARGEST_PHASE_STEP = 0.09
"""Largest ω₀H of a block [rad]. The sampled peak of a harmonic is then within 1e-3 of the true one; for any
record the peak of the parabola through three samples is."""

LONGEST_BLOCK = 0.01
"""Longest block [s], so that the response of a soft structure above its own frequency is resolved too."""

_Number = TypeVar("_Number", np.float64, np.complex128)


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """A record as straight lines over equal blocks of time, and the exact response at their edges."""

    step: float  # Length H of a block [s]
    before: int  # Blocks before the window
    end: float  # Fraction of the last block at which the window ends, in (0, 1]
    # left, right: Ground acceleration [m/s²] at the two ends of each block, shape (blocks,)
    left: Array
    right: Array
    ideal: Array  # Exact response x_I [m] at the edges of the blocks, shape (blocks + 1,)
    excitation: Excitation  # The record and its window
    pole: complex  # Pole p of the structure's own mode [1/s]

    @property
    def intervals(self) -> float:
        """Length of the window in blocks."""
        return self.left.size - self.before - 1 + self.end

    @property
    def most_ahead(self) -> int:
        """Largest number of blocks that an actuator can look ahead: those in a quarter of the period."""
        return int(np.ceil(0.5 * np.pi / (abs(self.pole) * self.step))) + 1

    def extend_lines(self, count: int) -> tuple[Array, Array]:
        """Ground acceleration at the ends of the blocks and of further ones after the window.

        Returns left, right [m/s²].
        """
        if count == 0:
            return self.left, self.right
        total = self.left.size + count
        return self._longest_lines[0][:total], self._longest_lines[1][:total]

    @cached_property
    def _longest_lines(self) -> tuple[Array, Array]:
        total = self.left.size + self.most_ahead
        time_step = self.excitation.time_step
        silence = np.zeros(int(np.ceil((total - self.before + 1) * self.step / time_step)) + 2)
        record = np.concatenate([self.excitation.acceleration, silence])
        first = self.excitation.window[0] - self.step * self.before
        place = Spacing(step=self.step, first=first, blocks=total, before=self.before, end=self.end)
        left, right, _ = _lines(record[np.newaxis], time_step, self.pole, place)
        return left[0], right[0]

    @cached_property
    def ideal_peak(self) -> float:
        """Largest |x_I| [m] inside the window, between the edges of blocks too."""
        ground = self.excitation
        record = read_only(ground.acceleration[np.newaxis]), ground.time_step
        weights = mode_weights(self.pole, ground.time_step)
        window_response = self.ideal[self.before :]
        return peak_of_mode(record, self.pole, weights, window_response, ground.window, self.step)


def ramp_weights(
    pole: NDArray[_Number], step: float
) -> tuple[NDArray[_Number], NDArray[_Number], NDArray[_Number]]:
    """Weights F₀, F₁ and decay e^(pH) of the mode z' = pz + a over a block in which a is linear."""
    phase = pole * step
    constant_part = np.expm1(phase) / pole
    late = (constant_part - step) / phase
    return constant_part - late, late, np.exp(phase)


def block_length(structure: Structure) -> float:
    """Length of a block [s] that suits the structure."""
    return min(LONGEST_BLOCK, LARGEST_PHASE_STEP / structure.circular_frequency)


def cut(excitation: Excitation, structure: Structure, *, step: float | None = None) -> Blocks:
    """Cut a record into equal blocks, one of which starts where the window starts.

    `step` [s].
    """
    (blocks,) = cut_together([excitation], structure, step=step or block_length(structure))
    return blocks


def cut_together(excitations: Sequence[Excitation], structure: Structure, *, step: float) -> list[Blocks]:
    """Cut records of the same instants and window into the same blocks."""
    place = spacing(excitations[0], step)
    records = np.stack([excitation.acceleration for excitation in excitations])
    lines = _lines(records, excitations[0].time_step, structure.pole, place)
    return [
        Blocks(
            step=place.step,
            before=place.before,
            end=place.end,
            left=left,
            right=right,
            ideal=ideal,
            excitation=excitation,
            pole=structure.pole,
        )
        for excitation, left, right, ideal in zip(excitations, *lines, strict=True)
    ]


@dataclass(frozen=True, kw_only=True)
class Spacing:
    """Where blocks lie: their length H and the first edge [s], their number, and the window among them.

    The window begins after `before` blocks and ends at the fraction `end` of the last one.
    """

    step: float
    first: float
    blocks: int
    before: int
    end: float


def spacing(excitation: Excitation, step: float) -> Spacing:
    """Lay blocks of a length [s], or of half the window where that is shorter, so that one starts with it."""
    begin, end = excitation.window
    step = min(step, 0.5 * (end - begin))
    window_blocks = int(np.ceil((end - begin) / step - 1e-9))
    lead_blocks = int(np.ceil(begin / step - 1e-9))
    return Spacing(
        step=step,
        first=begin - step * lead_blocks,
        blocks=lead_blocks + window_blocks,
        before=lead_blocks,
        end=(end - begin) / step - (window_blocks - 1),
    )


def _lines(records: Array, time_step: float, pole: complex, place: Spacing) -> tuple[Array, Array, Array]:
    """Straight lines that drive the mode in each block, as `block_kernel.cut_records` returns them."""
    poles, counts = np.array([pole]), np.array([place.blocks])
    weights = (np.array([mode_weights(pole, time_step)]), np.array([mode_weights(pole, place.step)]))
    spacings = np.array([place.first]), np.array([place.step]), counts
    return cut_records((read_only(records), time_step), poles, weights, spacings)


@lru_cache(maxsize=4096)
def mode_weights(pole: complex, step: float) -> Weights:
    """Weights and decay of one mode, as `ramp_weights`."""
    early, late, decay = (complex(weight[0]) for weight in ramp_weights(np.array([pole]), step))
    return early, late, decay
