"""The loop reduced to a dominant and a fast pole pair, and the recursion of engine `pole` through them.

A loop with a short delay is a second-order system: of the infinitely many poles of::

    Q(s) = s² + 2ξω₀s + (1−α)ω₀² + αk_pω₀²e^(−sτ)

one lightly damped pair carries the response, and the others, about 1/τ fast and heavily damped,
nearly follow the ground acceleration. The transfer function from −a_g is therefore split as::

    k_p e^(−sτ)/Q(s) = r/(s − p) + r̄/(s − p̄) + (n₀ + n₁s)/(1 + m₁s + m₂s²) + O(s⁴τ⁶)

with the residue r = k_p e^(−pτ)/Q'(p). The last term is the Padé approximant of what the pair
leaves; for short delays that is k_p(e^(−sτ) − 1 + sτ)/s² times a constant near one. It vanishes for
τ = 0, where the pair is the whole loop.

Compensation that overshoots makes the actuator early: x_m(t) = k_p x_c(t + T). The loop then is an equation
with advanced argument, which cannot be marched forward; what a test shows is its bounded solution. Its
transfer function from −a_g to the measured displacement, ::

    k_p e^(sT)/Q(s),   Q(s) = s² + 2ξω₀s + (1−α)ω₀² + αk_pω₀²e^(sT)

has one pole pair p, p̄ left of the imaginary axis and, for leads below `longest_lead`, all others far to
the right of it, at about 5/T or more. The command is therefore the response of the pair plus a direct term
for the other poles, which look ahead by less than T::

    1/Q(s) = r/(s − p) + r̄/(s − p̄) + c + O(sT³/1000),   r = 1/Q'(p),   c of the order of T²/200

and the measured displacement is k_p times the command, shifted ahead by T.

A mode z' = pz + a_g is exact over a block of length H with E = e^(pH) and, for a record that goes
from a₀ to a₁ in the block, ::

    z₊ = Ez + u,   u = F₀a₀ + F₁a₁,   F₁ = ∫₀ᴴ (s/H)e^(p(H−s)) ds,   F₀ = ∫₀ᴴ e^(p(H−s)) ds − F₁

so that y = −(rz + r'z') of two modes obeys a real recursion of two states and four ends of blocks::

    y₊₊ = (E + E')y₊ − EE'y − (ru + r'u')₊₊ + (rE'u + r'Eu')₊

For the dominant and the fast pair a step costs twelve multiply-adds whatever the delay, and cells of
any gain and delay advance side by side.

For an actuator that leads by T the mode is needed at t + T, a time θ before the end of the block that
contains t + T: the same recursion is used with the residue r·e^(−pθ), and the effect of the record during θ
replaces the fast pair. The exact response is read that number of blocks earlier.
"""

from dataclasses import dataclass
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.excitation import LATEST, TRACKS, Deviation, end_weight, follow, follow_four, summary
from reliab.simulation.linear_loop.blocks import Blocks, ramp_weights
from reliab.structures.structure import Structure

_NEWTON_STEPS = 60
_CONVERGENCE_TOLERANCE = 1e-14
_MOMENTS = 4
_SHORT = 0.02  # ω₀τ below which the shape of the rest is that of a vanishing delay
_NO_DEVIATION = 1e-9  # of the response; below it an actuator counts as perfect
# Reduced and exact loop are compared at these multiples of the natural frequency.
_COMPARISON_FREQUENCIES = np.geomspace(0.1, 40.0, 61)


@dataclass(frozen=True, kw_only=True)
class ModalLoop:
    """Two pole pairs with their residues, one entry per cell."""

    # pole, residue: Dominant pole p [1/s] and residue r [s] of the response to −a_g, complex, shape (cells,);
    # their conjugates belong to them. The residue is zero where the loop does not oscillate
    pole: Spectrum
    residue: Spectrum
    # fast_poles, fast_residues: Poles [1/s] and residues [s] of the fast pair, complex, shape (2, cells); the
    # residues are zero where there is no delay
    fast_poles: Spectrum
    fast_residues: Spectrum

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from −a_g [s²] at frequencies s [rad/s] that broadcast with the cells."""
        slow = self.residue / (s - self.pole) + self.residue.conj() / (s - self.pole.conj())
        return np.asarray(slow + self.fast_transfer(s))

    def fast_transfer(self, s: Spectrum) -> Spectrum:
        """Part of the fast pair in the transfer function [s²]."""
        (p, q), (u, v) = self.fast_poles, self.fast_residues
        return np.asarray(u / (s - p) + v / (s - q))


class DominantPoleLoop(Protocol):
    """A reduced loop that approximates the exact one."""

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from −a_g [s²]."""


def dominant_pole(structure: Structure, gain: Array, delay: Array) -> Spectrum:
    """Pole of the loop that grows out of the undelayed structure's own pole.

    Returns the pole with positive imaginary part [1/s], shape (cells,); NaN where Newton's iteration does not
    converge (delays of the order of the period, which the modal reduction refuses).
    """
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    loop_gain = alpha * gain * w0**2
    stiffness = (1.0 - alpha) * w0**2 + loop_gain
    pole = -xi * w0 + 0.5 * loop_gain * delay + 1j * np.sqrt(stiffness)
    for _ in range(_NEWTON_STEPS):
        delayed_gain = loop_gain * np.exp(-pole * delay)
        value = pole**2 + 2.0 * xi * w0 * pole + (1.0 - alpha) * w0**2 + delayed_gain
        slope = 2.0 * pole + 2.0 * xi * w0 - delay * delayed_gain
        step = value / slope
        pole = pole - step
        if np.all(np.abs(step) <= _CONVERGENCE_TOLERANCE * np.abs(pole)):
            return pole
    has_converged = np.abs(step) <= 1e-9 * np.abs(pole)
    return np.where(has_converged & (pole.imag > 0.0), pole, np.nan)


def pole_or_own(structure: Structure, gain: Array, delay: Array) -> tuple[Spectrum, NDArray[np.bool_]]:
    """Dominant poles [1/s], the structure's own where there is none, and whether there is, shape (cells,)."""
    pole = dominant_pole(structure, gain, delay)
    oscillates = np.isfinite(pole)
    return np.where(oscillates, pole, structure.pole), oscillates


def modal_loop(
    structure: Structure, gain: Array, delay: Array, *, has_measured_output: bool = True
) -> ModalLoop:
    """Split the loop from −a_g to a displacement into its dominant pair and a rest."""
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    loop_gain = alpha * gain * w0**2
    pole, oscillates = pole_or_own(structure, gain, delay)
    slope = 2.0 * pole + 2.0 * xi * w0 - delay * loop_gain * np.exp(-pole * delay)
    output, late = (gain, delay) if has_measured_output else (np.ones_like(gain), np.zeros_like(delay))
    residue = np.where(oscillates, output * np.exp(-pole * late) / slope, 0.0)
    series_without_pair = _series(structure, gain, delay, output, late)
    for power in range(_MOMENTS):
        series_without_pair[power] += 2.0 * (residue / pole ** (power + 1)).real
    short = w0 * delay < _SHORT
    fast_poles, fast_residues = _fast_pair(
        series_without_pair, delay, short if has_measured_output else np.zeros_like(short)
    )
    if not has_measured_output:
        fast_residues = np.where(short, 0.0, fast_residues)  # of the order of τ⁴
    return ModalLoop(pole=pole, residue=residue, fast_poles=fast_poles, fast_residues=fast_residues)


def _series(structure: Structure, gain: Array, delay: Array, output: Array, late: Array) -> Array:
    """Taylor coefficients at s = 0 of the whole transfer function, shape (4, cells)."""
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    factorial = np.array([[1.0], [1.0], [2.0], [6.0]])
    power = np.arange(_MOMENTS, dtype=np.float64)[:, np.newaxis]
    numerator: Array = output * (-late) ** power / factorial
    denominator = alpha * gain * w0**2 * (-delay) ** power / factorial
    denominator[0] += (1.0 - alpha) * w0**2
    denominator[1] += 2.0 * xi * w0
    denominator[2] += 1.0
    series: Array = np.zeros_like(numerator)
    for k in range(_MOMENTS):
        lower_terms = sum(series[j] * denominator[k - j] for j in range(k))
        series[k] = (numerator[k] - lower_terms) / denominator[0]
    return series


def _fast_pair(series: Array, delay: Array, short: NDArray[np.bool_]) -> tuple[Spectrum, Spectrum]:
    """Poles and residues of the Padé approximant of Taylor coefficients, shape (2, cells) each."""
    tau = np.maximum(delay, 1e-12)
    c = series / tau ** np.arange(2, 2 + _MOMENTS)[:, np.newaxis]  # in units of the delay
    # For a very short delay rounding errors dominate the higher coefficients; a known shape replaces them.
    shape = np.array([[1.0], [-1.0 / 3.0], [1.0 / 12.0], [-1.0 / 60.0]])
    c = np.where(short, c[0] * shape, c)
    with np.errstate(all="ignore"):  # cells without a delay have no fast pair
        determinant = c[1] ** 2 - c[0] * c[2]
        m1 = (c[0] * c[3] - c[1] * c[2]) / determinant
        m2 = (c[2] ** 2 - c[1] * c[3]) / determinant
        root = np.sqrt((m1**2 - 4.0 * m2).astype(np.complex128))
        poles = np.stack([-m1 + root, -m1 - root]) / (2.0 * m2)
        residues = (c[0] + (c[1] + m1 * c[0]) * poles) / (m1 + 2.0 * m2 * poles)
    sound = (delay > 0.0) & (m2 > 0.0) & (m1 > 0.0) & (np.abs(root) > 0.0)
    fallback = np.array([[-1.0 + 1.0j], [-1.0 - 1.0j]])
    scaled_poles = np.where(sound, poles, fallback).astype(np.complex128) / tau
    return scaled_poles, np.where(sound, residues * tau, 0.0).astype(np.complex128)


def transfer(structure: Structure, gain: Array, delay: Array, s: Spectrum) -> Spectrum:
    """Exact transfer function k_p e^(−sτ)/Q(s) from −a_g to the measured displacement [s²]."""
    return transfer_of_shift(structure, gain, np.exp(-s * delay), s)


def transfer_of_shift(structure: Structure, gain: Array, shift: Spectrum, s: Spectrum) -> Spectrum:
    """Return the same of an actuator whose e^(−sτ) is known."""
    w0, xi = structure.circular_frequency, structure.damping_ratio
    alpha = structure.experimental_fraction
    actuator = gain * shift
    return actuator / (s**2 + 2.0 * xi * w0 * s + w0**2 * (1.0 - alpha + alpha * actuator))


def comparison_frequencies(structure: Structure) -> Spectrum:
    """Frequencies s = iω [rad/s] at which the reduction is compared with the exact loop, shape (bands, 1)."""
    return (2j * np.pi * structure.frequency * _COMPARISON_FREQUENCIES[:, np.newaxis]).astype(np.complex128)


def band_edges(structure: Structure) -> Array:
    """Edges [Hz] of the bands in which the reduction is compared with the exact loop."""
    half = np.sqrt(_COMPARISON_FREQUENCIES[1] / _COMPARISON_FREQUENCIES[0])
    return structure.frequency * np.append(_COMPARISON_FREQUENCIES / half, _COMPARISON_FREQUENCIES[-1] * half)


def reduction_loss(
    structure: Structure, gain: Array, delay: Array, loop: DominantPoleLoop
) -> tuple[Array, Array]:
    """Compare the reduced loop with the exact one, band by band.

    Returns `neglected, total`: squared moduli of exact minus reduced transfer function and of x_m − x_I over
    −a_g [s⁴], shape (bands, cells). Weighted by the power of a record in each band their sums give the
    relative error of the deviation's mean square.
    """
    s = comparison_frequencies(structure)
    exact = transfer(structure, gain, delay, s)
    ideal = transfer(structure, np.ones(1), np.zeros(1), s)
    neglected_power = np.abs(exact - loop.transfer(s)) ** 2
    total = np.maximum(np.abs(exact - ideal), _NO_DEVIATION * np.abs(ideal)) ** 2
    return np.where(np.isfinite(neglected_power), neglected_power, np.inf), total


@dataclass(frozen=True, kw_only=True)
class LeadingLoop:
    """Dominant pole pair, feed-through and lead, one entry per cell."""

    # pole, residue: Pole p [1/s] and residue k_p r [s] of k_p times the command's response to −a_g, complex,
    # shape (cells,); their conjugates belong to them
    pole: Spectrum
    residue: Spectrum
    feedthrough: Array  # k_p c, direct term of the other poles [s²], shape (cells,)
    # Lead T by which the measured displacement is ahead [s], positive, shape (cells,)
    lead: Array

    def command(self, gain: Array) -> "LeadingLoop":
        """Take the loop from −a_g to the command, of actuators of given gains [-], shape (cells,)."""
        return LeadingLoop(
            pole=self.pole,
            residue=self.residue / gain,
            feedthrough=self.feedthrough / gain,
            lead=np.zeros_like(self.lead),
        )

    def transfer(self, s: Spectrum) -> Spectrum:
        """Transfer function from −a_g [s²] at frequencies s [rad/s] that broadcast with the cells."""
        pair = self.residue / (s - self.pole) + self.residue.conj() / (s - self.pole.conj())
        return np.asarray(np.exp(s * self.lead) * (pair + self.feedthrough))


def leading_loop(structure: Structure, gain: Array, lead: Array) -> LeadingLoop:
    """Split the loop of a leading actuator into its dominant pair and a feed-through."""
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    loop_gain = alpha * gain * w0**2
    pole, oscillates = pole_or_own(structure, gain, -lead)
    slope = 2.0 * pole + 2.0 * xi * w0 + lead * loop_gain * np.exp(pole * lead)
    residue = np.where(oscillates, gain / slope, 0.0)
    static = gain / ((1.0 - alpha) * w0**2 + loop_gain)
    feedthrough = static + 2.0 * (residue / pole).real
    return LeadingLoop(pole=pole, residue=residue, feedthrough=feedthrough, lead=lead)


_Real = TypeVar("_Real", np.float32, np.float64)

BLOCK_COLUMNS = slice(8, 10)
"""Coefficients with which the record at both ends of a block enters beside the dominant pair."""


def fill_lanes(cells: NDArray[_Real], lanes: int) -> NDArray[_Real]:
    """Fill up the last set of lanes with copies of the last cell; shape (…, multiple of lanes).

    Rows are contiguous, so that kernels are compiled for one layout.
    """
    missing = -cells.shape[-1] % lanes
    copies = np.repeat(cells[..., -1:], missing, axis=-1)
    return np.ascontiguousarray(np.concatenate([cells, copies], axis=-1) if missing else cells)


@dataclass(frozen=True, kw_only=True)
class BlockRecursion:
    """The recursion of cells that look the same number of blocks ahead."""

    cells: NDArray[np.intp]  # Which cells, shape (n,)
    # Blocks by which the displacement is ahead of the exact response; 0 for actuators that are late
    ahead: int
    coefficients: Array  # Shape (12, n), as `recursion` describes them


def recursions(loop: ModalLoop | LeadingLoop, step: float, cells: NDArray[np.intp]) -> list[BlockRecursion]:
    """Recursions of the cells of a reduced loop.

    `step` [s].
    """
    if isinstance(loop, ModalLoop):
        return [BlockRecursion(cells=cells, ahead=0, coefficients=recursion(loop, step))]
    ahead, coefficients = leading_recursion(loop, step)
    return [
        BlockRecursion(cells=cells[equal_steps], ahead=int(count), coefficients=coefficients[:, equal_steps])
        for count in np.unique(ahead)
        for equal_steps in (np.flatnonzero(ahead == count),)
    ]


def leading_recursion(loop: LeadingLoop, step: float) -> tuple[NDArray[np.int64], Array]:
    """Coefficients of the recursion of actuators that lead.

    `step` [s].
    """
    pole, residue = loop.pole, loop.residue
    ahead = np.ceil(loop.lead / step).astype(np.int64)
    back = ahead * step - loop.lead
    decaying = residue * np.exp(-pole * back)
    slow = pair_recursion(np.stack([pole, pole.conj()]), np.stack([decaying, decaying.conj()]), step)
    # ∫₀^θ e^(−p(θ−u))a(u) du of the record's straight line, from its right end backwards
    constant_part = -np.expm1(-pole * back) / pole
    falling = (back - constant_part) / (pole * step)
    share = back / step
    left = 2.0 * (residue * falling).real - loop.feedthrough * share
    right = 2.0 * (residue * (constant_part - falling)).real - loop.feedthrough * (1.0 - share)
    zeros = np.zeros_like(left)
    return ahead, np.concatenate([slow, np.stack([zeros, zeros, left, right, zeros, zeros])])


def recursion(loop: ModalLoop, step: float) -> Array:
    """Coefficients of the recursion of each cell.

    `step` [s].
    Returns shape (12, cells): for the dominant and then the fast pair the coefficients of the last two
    displacements, and of the record at the left and right end of this block and of the one before.
    """
    poles = np.stack([loop.pole, loop.pole.conj()])
    residues = np.stack([loop.residue, loop.residue.conj()])
    dominant = pair_recursion(poles, residues, step)
    return np.concatenate([dominant, pair_recursion(loop.fast_poles, loop.fast_residues, step)])


def pair_recursion(poles: Spectrum, residues: Spectrum, step: float) -> Array:
    """Coefficients of the recursion of the response of two modes to −a_g.

    `poles`, `residues`, `step` [s].
    """
    early, late, decay = ramp_weights(poles, step)
    ahead, late_residues = residues, residues * decay[::-1]
    return np.stack(
        [
            decay.sum(axis=0).real,
            -decay.prod(axis=0).real,
            -(ahead * early).sum(axis=0).real,
            -(ahead * late).sum(axis=0).real,
            (late_residues * early).sum(axis=0).real,
            (late_residues * late).sum(axis=0).real,
        ]
    )


LANES = 64
"""Cells that advance side by side; their state fits the first-level cache."""

_COEFFICIENTS = 12


@compiled
def _four_steps(
    y: float,
    z: float,
    pair: tuple[float, float, float, float, float, float],
    left: tuple[float, float, float, float, float],
    right: tuple[float, float, float, float, float],
) -> tuple[float, float, float, float]:
    """Displacements of a pair at the ends of four blocks; y was the last, z the one before."""
    c1, c2, b0, b1, d0, d1 = pair
    p = c1 * y + c2 * z + b0 * left[1] + b1 * right[1] + d0 * left[0] + d1 * right[0]
    q = c1 * p + c2 * y + b0 * left[2] + b1 * right[2] + d0 * left[1] + d1 * right[1]
    r = c1 * q + c2 * p + b0 * left[3] + b1 * right[3] + d0 * left[2] + d1 * right[2]
    s = c1 * r + c2 * q + b0 * left[4] + b1 * right[4] + d0 * left[3] + d1 * right[3]
    return p, q, r, s


@compiled
def _track_lanes(
    left: Array, right: Array, ideal: Array, before: int, end: float, coefficients: Array
) -> Array:
    """Step one set of lanes from rest through the window; shape (tracks, lanes).

    Vector instructions need arrays that are made here, so that they cannot overlap, and pieces that
    take and return numbers only.
    """
    k = np.empty((_COEFFICIENTS, LANES))
    copy_rows(coefficients, k)
    x, t = np.zeros((4, LANES)), np.zeros((TRACKS, LANES))
    t[LATEST] = np.nan
    i = 0
    while i < left.size:
        if i > before and i + 5 < left.size:
            lefts = (left[i - 1], left[i], left[i + 1], left[i + 2], left[i + 3])
            rights = (right[i - 1], right[i], right[i + 1], right[i + 2], right[i + 3])
            for j in range(LANES):
                slow = (k[0, j], k[1, j], k[2, j], k[3, j], k[4, j], k[5, j])
                fast = (k[6, j], k[7, j], k[8, j], k[9, j], k[10, j], k[11, j])
                p, q, r, s = _four_steps(x[0, j], x[1, j], slow, lefts, rights)
                p2, q2, r2, s2 = _four_steps(x[2, j], x[3, j], fast, lefts, rights)
                x[0, j], x[1, j], x[2, j], x[3, j] = s, r, s2, r2
                p, q, r, s = (
                    p + p2 - ideal[i + 1],
                    q + q2 - ideal[i + 2],
                    r + r2 - ideal[i + 3],
                    s + s2 - ideal[i + 4],
                )
                track = follow_four((t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j]), p, q, r, s)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 4
        else:
            last = i + 1 == left.size
            weight = end_weight(i, left.size, end)
            a0, a1 = left[i], right[i]
            a2, a3 = (left[i - 1], right[i - 1]) if i > 0 else (0.0, 0.0)
            for j in range(LANES):
                track = (t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j])
                difference = x[0, j] + x[2, j] - ideal[i]
                if i == before:
                    track = follow(track, difference, 0.5)
                slow = (
                    k[0, j] * x[0, j]
                    + k[1, j] * x[1, j]
                    + k[2, j] * a0
                    + k[3, j] * a1
                    + k[4, j] * a2
                    + k[5, j] * a3
                )
                fast = (
                    k[6, j] * x[2, j]
                    + k[7, j] * x[3, j]
                    + k[8, j] * a0
                    + k[9, j] * a1
                    + k[10, j] * a2
                    + k[11, j] * a3
                )
                x[0, j], x[1, j], x[2, j], x[3, j] = slow, x[0, j], fast, x[2, j]
                now = slow + fast - ideal[i + 1]
                if i >= before:
                    track = follow(track, difference + end * (now - difference) if last else now, weight)
                t[0, j], t[1, j], t[2, j], t[3, j], t[4, j], t[5, j] = track
            i += 1
    return t


@compiled
def _track(left: Array, right: Array, ideal: Array, before: int, end: float, coefficients: Array) -> Array:
    """Statistics of all cells, whose number is a multiple of the lanes; shape (tracks, cells)."""
    cells = coefficients.shape[1]
    tracks = np.empty((TRACKS, cells))
    for first in range(0, cells, LANES):
        lanes = slice(first, first + LANES)
        copy_rows(_track_lanes(left, right, ideal, before, end, coefficients[:, lanes]), tracks[:, lanes])
    return tracks


def deviation(blocks: Blocks, coefficients: Array, *, ahead: int = 0) -> Deviation:
    """Deviation of the measured displacement from the exact response, for many cells."""
    cells = coefficients.shape[1]
    lane_coefficients = fill_lanes(coefficients, LANES)
    left, right, ideal = blocks.left, blocks.right, blocks.ideal
    if ahead:
        (left, right), ideal = blocks.extend_lines(ahead), np.concatenate([np.zeros(ahead), ideal])
    tracks = _track(left, right, ideal, blocks.before + ahead, blocks.end, lane_coefficients)
    return summary(tracks[:, :cells], blocks.intervals, blocks.ideal_peak)
