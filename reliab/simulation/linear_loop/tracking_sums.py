"""Sums behind the frequency-domain evaluation index, accumulated while stepping.

The index needs Σ F[O]F[I]* and Σ |F[I]|² over positive frequencies, and the latter weighted with
the frequency. By Parseval these are sums over time with the analytic signal x_c + iq_c of the
command, q_c its Hilbert transform. The loop being linear, q_c is its response to the Hilbert
transform of the record, so that no history is stored. That transform reaches back before the
record, and stepping starts as much earlier as the structure remembers. The taper of the window
enters squared; it varies slowly, so that it may be exchanged with the Hilbert transform.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.blocks import Blocks, cut_together
from reliab.simulation.linear_loop.pole_recursion import (
    BlockRecursion,
    fill_lanes,
    leading_loop,
    leading_recursion,
    modal_loop,
    recursion,
    recursions,
)
from reliab.structures.structure import Structure

_LARGEST_PHASE_STEP = 0.2
_LONGEST_BLOCK = 0.025
_MEMORY = 4.0  # time constants of free vibration that are stepped before the record
_SUMS = 5
LANES = 16
"""Cells that advance side by side."""

_Lanes = list[tuple[Array, Array]]
"""Coefficients of command and measured displacement, a pair for each set of lanes."""


@dataclass(frozen=True, kw_only=True)
class TrackingSums:
    """Sums over positive frequencies of command I and measured displacement O, Hann-tapered."""

    cross: Spectrum  # Σ F[O]F[I]*, complex, shape (cells,)
    power: Array  # Σ |F[I]|² in the same unit, shape (cells,)
    equivalent_frequency: Array  # Σ f|F[I]|² / Σ |F[I]|² [Hz], shape (cells,)


@dataclass(frozen=True, kw_only=True)
class QuadraturePair:
    """A record and its Hilbert transform, both with as much silence before as the record is long."""

    # straight, turned: The record and the record with every frequency turned by a quarter of a cycle
    straight: Excitation
    quadrature: Excitation

    @classmethod
    def from_excitation(cls, excitation: Excitation) -> "QuadraturePair":
        """Pair a record with its Hilbert transform."""
        record = excitation.acceleration
        silence = np.zeros_like(record)
        length = scipy.fft.next_fast_len(3 * record.size, real=True)
        late = np.concatenate([silence, record])
        quadrature_record = scipy.fft.irfft(-1j * scipy.fft.rfft(late, length), length)[: late.size]
        shift = record.size * excitation.time_step
        begin, end = excitation.window
        later = (begin + shift, end + shift)
        return cls(
            straight=Excitation(acceleration=late, time_step=excitation.time_step, window=later),
            quadrature=Excitation(
                acceleration=quadrature_record, time_step=excitation.time_step, window=later
            ),
        )


@dataclass(frozen=True, kw_only=True)
class TrackedCells:
    """Actuators before one structure whose command and measured displacement are to be summed."""

    structure: Structure  # The structure under test
    # gain, delay: Actuator gain [-] and delay [s], negative for a lead, shape (cells,)
    gain: Array
    delay: Array

    @property
    def step(self) -> float:
        """Length of a block [s]; the sums need fewer blocks than the errors."""
        return min(_LONGEST_BLOCK, _LARGEST_PHASE_STEP / self.structure.circular_frequency)

    @cached_property
    def recursions(self) -> list[tuple[BlockRecursion, _Lanes]]:
        """Recursions of the measured displacement, each with the coefficients of command and itself."""
        late, early = np.flatnonzero(self.delay >= 0.0), np.flatnonzero(self.delay < 0.0)
        pairs: list[tuple[BlockRecursion, _Lanes]] = []
        if late.size:
            cells = self.structure, self.gain[late], self.delay[late]
            (sensor,) = recursions(modal_loop(*cells), self.step, late)
            command = recursion(modal_loop(*cells, has_measured_output=False), self.step)
            pairs.append((sensor, _fill_coefficient_lanes(command, sensor.coefficients)))
        if early.size:
            loop = leading_loop(self.structure, self.gain[early], -self.delay[early])
            _, command = leading_recursion(loop.command(self.gain[early]), self.step)
            place = np.full(self.gain.size, -1)
            place[early] = np.arange(early.size)
            pairs += [
                (segment, _fill_coefficient_lanes(command[:, place[segment.cells]], segment.coefficients))
                for segment in recursions(loop, self.step, early)
            ]
        return pairs


def _fill_coefficient_lanes(command: Array, measured_coefficients: Array) -> _Lanes:
    """Coefficients of both in sets of lanes, the last filled up."""
    both = fill_lanes(command, LANES), fill_lanes(measured_coefficients, LANES)
    sets = range(0, both[0].shape[1], LANES)
    return [(both[0][:, lane : lane + LANES].copy(), both[1][:, lane : lane + LANES].copy()) for lane in sets]


def tracking_sums(pair: QuadraturePair, cells: TrackedCells) -> TrackingSums:
    """Accumulate the sums behind the index for many cells, with a Hann taper over the window."""
    structure, step = cells.structure, cells.step
    memory = _MEMORY / (structure.damping_ratio * structure.circular_frequency)
    begin = pair.straight.window[0] - memory - step
    records = [record.since(begin) for record in (pair.straight, pair.quadrature)]
    straight, aside = cut_together(records, structure, step=step)
    first = max(0, straight.before - int(memory / step))
    sine = np.sin(np.pi * np.arange(straight.left.size - straight.before) / straight.intervals)
    taper = np.square(np.square(sine))
    lead_blocks = straight.before - first
    ends = _ends(straight, first), _ends(aside, first)
    sums = np.empty((_SUMS, cells.gain.size))
    for measured_recursion, lanes_of in cells.recursions:
        lines = straight.extend_lines(measured_recursion.ahead)
        ahead = np.stack([line[first + measured_recursion.ahead :] for line in lines])
        parts = [_accumulate(*ends, ahead, taper, lead_blocks, *lanes) for lanes in lanes_of]
        sums[:, measured_recursion.cells] = np.concatenate(parts, axis=1)[:, : measured_recursion.cells.size]
    # Samples one and two steps apart show sin ωH and sin 2ωH; 8 sin ωH − sin 2ωH = 6ωH + O((ωH)⁵).
    frequency = (8.0 * sums[3] - sums[4]) / sums[2] / (12.0 * np.pi * step)
    cross = np.empty(sums.shape[1], dtype=np.complex128)
    cross.real, cross.imag = sums[0], sums[1]
    return TrackingSums(cross=cross, power=sums[2], equivalent_frequency=frequency)


def _ends(blocks: Blocks, first: int) -> Array:
    return np.stack([blocks.left[first:], blocks.right[first:]])


@compiled
def _step(
    slow: tuple[float, float],
    fast: tuple[float, float],
    k: tuple[float, float, float, float, float, float],
    n: tuple[float, float, float, float, float, float],
    a: tuple[float, float, float, float],
) -> tuple[float, float]:
    """Next displacement of the dominant and of the fast pair of one cell."""
    a0, a1, a2, a3 = a
    new = k[0] * slow[0] + k[1] * slow[1] + k[2] * a0 + k[3] * a1 + k[4] * a2 + k[5] * a3
    quick = n[0] * fast[0] + n[1] * fast[1] + n[2] * a0 + n[3] * a1 + n[4] * a2 + n[5] * a3
    return new, quick


@compiled
def _accumulate(
    straight: Array,
    aside: Array,
    ahead: Array,
    taper: Array,
    before: int,
    command: Array,
    measured_coefficients: Array,
) -> Array:
    """Step command, its quadrature and measured displacement of a set of lanes; shape (5, lanes).

    The measured displacement is driven by the record `ahead`, which is the record itself unless it leads.
    """
    c, m = np.empty((12, LANES)), np.empty((12, LANES))
    copy_rows(command, c)
    copy_rows(measured_coefficients, m)
    x, q, o = np.zeros((4, LANES)), np.zeros((4, LANES)), np.zeros((4, LANES))
    past, sums = np.zeros((4, LANES)), np.zeros((_SUMS, LANES))
    for i in range(1, before + taper.size - 1):
        a = (straight[0, i], straight[1, i], straight[0, i - 1], straight[1, i - 1])
        b = (ahead[0, i], ahead[1, i], ahead[0, i - 1], ahead[1, i - 1])
        h = (aside[0, i], aside[1, i], aside[0, i - 1], aside[1, i - 1])
        weight = taper[i + 1 - before] if i + 1 >= before else 0.0
        for j in range(LANES):
            k = (c[0, j], c[1, j], c[2, j], c[3, j], c[4, j], c[5, j])
            n = (c[6, j], c[7, j], c[8, j], c[9, j], c[10, j], c[11, j])
            slow, fast = _step((x[0, j], x[1, j]), (x[2, j], x[3, j]), k, n, a)
            x[0, j], x[1, j], x[2, j], x[3, j] = slow, x[0, j], fast, x[2, j]
            place = slow + fast
            slow, fast = _step((q[0, j], q[1, j]), (q[2, j], q[3, j]), k, n, h)
            q[0, j], q[1, j], q[2, j], q[3, j] = slow, q[0, j], fast, q[2, j]
            aslant = slow + fast
            k = (m[0, j], m[1, j], m[2, j], m[3, j], m[4, j], m[5, j])
            n = (m[6, j], m[7, j], m[8, j], m[9, j], m[10, j], m[11, j])
            slow, fast = _step((o[0, j], o[1, j]), (o[2, j], o[3, j]), k, n, b)
            o[0, j], o[1, j], o[2, j], o[3, j] = slow, o[0, j], fast, o[2, j]
            output = slow + fast
            sums[0, j] += weight * output * place
            sums[1, j] -= weight * output * aslant
            sums[2, j] += 0.5 * weight * (place * place + aslant * aslant)
            sums[3, j] += 0.5 * weight * (aslant * past[0, j] - place * past[1, j])
            sums[4, j] += 0.5 * weight * (aslant * past[2, j] - place * past[3, j])
            past[2, j], past[3, j], past[0, j], past[1, j] = past[0, j], past[1, j], place, aslant
    return sums
