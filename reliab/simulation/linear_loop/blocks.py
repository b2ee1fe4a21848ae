"""The record divided into equal blocks of time whose length depends on the structure only.

A stepping engine advances in equal blocks. In each block the record a_g is replaced by the straight
line, from a₀ to a₁, that has exactly the same effect on the structure's own mode z' = pz + a_g::

    F₀a₀ + F₁a₁ = z(t + H) − e^(pH)z(t),   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

(two real numbers for one complex one). A mode whose pole lies near p, as it does for a small actuator error,
then responds to the line nearly as to the record. The exact response x_I follows from the same z.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, read_only
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.block_kernel import Weights, cut_records, peak_of_mode
from reliab.structures.structure import Structure

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

    def prolonged(self, count: int) -> tuple[Array, Array]:
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
        inside = self.ideal[self.before :]
        return peak_of_mode(record, self.pole, weights, inside, ground.window, self.step)


def ramp_weights(
    pole: NDArray[_Number], step: float
) -> tuple[NDArray[_Number], NDArray[_Number], NDArray[_Number]]:
    """Weights F₀, F₁ and decay e^(pH) of the mode z' = pz + a over a block in which a is linear."""
    phase = pole * step
    whole = np.expm1(phase) / pole
    late = (whole - step) / phase
    return whole - late, late, np.exp(phase)


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
    inside = int(np.ceil((end - begin) / step - 1e-9))
    before = int(np.ceil(begin / step - 1e-9))
    return Spacing(
        step=step,
        first=begin - step * before,
        blocks=before + inside,
        before=before,
        end=(end - begin) / step - (inside - 1),
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
