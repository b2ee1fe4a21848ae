"""The plane of gains and delays from few poles: basis, responses, and the ellipses in it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.linear_loop.blocks import Blocks, ramp_weights
from reliab.simulation.linear_loop.pole_recursion import (
    BLOCK_COLUMNS,
    LeadingLoop,
    ModalLoop,
    comparison_frequencies,
    dominant_pole,
    leading_recursion,
    modal_loop,
    pair_recursion,
)
from reliab.structures.structure import Structure

FARTHEST, _REGION = 0.5, 0.4
"""Largest |p − p₀|/|p + p̄₀| of a pole that is expanded, and of those from which poles are taken."""

_REGION_GAIN, _REGION_LAG, _REGION_LEAD = 2.2, 1.6, 2.5
"""Actuators from which poles are taken: |ln k_p| up to the first times ξ, delays and leads up to the
others times ξ/ω₀."""

_LEFT_OUT = 2e-5  # of the deviation, at which no further pole is taken
_SMALLEST_DEVIATION = 1e-3  # relative to |p + p̄₀|, below which a deviation need not be resolved
_MOST_POLES = 20
_FAST_PAIRS = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class PoleBasis:
    """Poles and fast pairs in which actuators before one structure are expanded."""

    structure: Structure  # The structure under test
    poles: Spectrum  # Poles p_k [1/s], that of the structure first, shape (poles,)
    fast: ModalLoop  # Reduced loops at gain 1 whose fast pairs are used, shape (pairs,)

    @cached_property
    def orthogonal(self) -> Array:
        """Real and imaginary parts of all φ_k from those of the responses 1/(s − p_k).

        Shape (2 poles, 2 poles): partial fractions, Π_{i<k}(p_j + p̄_i)/Π_{i≤k, i≠j}(p_j − p_i).
        """
        p, count = self.poles, self.poles.size
        fractions = np.zeros((count, count), dtype=np.complex128)
        for k in range(count):
            for j in range(k + 1):
                differences = p[j] - np.delete(p[: k + 1], j)
                fractions[k, j] = np.prod(p[j] + p[:k].conj()) / np.prod(differences)
        return np.block([[fractions.real, -fractions.imag], [fractions.imag, fractions.real]])

    def coefficients(self, pole: Spectrum) -> tuple[Spectrum, Array]:
        """Expand responses 1/(s − p).

        Returns `left_out`: |γ_n|, the share that is left out at every frequency [-], shape (cells,); infinite
        for a pole that is too far from the structure's.
        """
        near = distance(pole, complex(self.poles[0])) <= FARTHEST
        pole = np.where(near, pole, self.poles[0])
        coefficients = np.empty((self.poles.size, pole.size), dtype=np.complex128)
        gamma = np.ones_like(pole)
        for k, basis_pole in enumerate(self.poles):
            coefficients[k] = 2.0 * basis_pole.real * gamma / (pole + basis_pole.conjugate())
            gamma = gamma * (pole - basis_pole) / (pole + basis_pole.conjugate())
        return coefficients, np.where(near, np.abs(gamma), np.inf)

    def fast_coefficients(self, loop: ModalLoop) -> tuple[Array, Array]:
        """Expand the fast pairs of late actuators in those of the basis.

        Returns `left_out`: largest modulus, over the frequencies, of what the expansion leaves out of the
        transfer function from −a_g [s²], shape (cells,).
        """
        frequencies = comparison_frequencies(self.structure)
        exact, basis_transfer = loop.fast_transfer(frequencies), self.fast.fast_transfer(frequencies)
        coefficients = self._fast_inverse @ _parts(exact)
        return coefficients, np.abs(basis_transfer @ coefficients - exact).max(axis=0)

    @cached_property
    def _fast_inverse(self) -> Array:
        basis_parts = _parts(self.fast.fast_transfer(comparison_frequencies(self.structure)))
        return np.asarray(scipy.linalg.pinv(basis_parts, rtol=1e-12), dtype=np.float64)


@lru_cache(maxsize=256)
def pole_basis(structure: Structure) -> PoleBasis:
    """Choose the poles in which actuators before a structure are expanded.

    Returns poles that leave out less than 2e-5 of the deviation of any actuator with an error of up to about
    20 % RMS^R, but no more than twenty.
    """
    natural_pole = structure.pole
    scale = structure.damping_ratio / structure.circular_frequency
    gains = np.exp(structure.damping_ratio * _REGION_GAIN * np.linspace(-1.0, 1.0, 23))
    delays = scale * np.linspace(-_REGION_LEAD, _REGION_LAG, 42)
    gain, delay = (values.ravel() for values in np.meshgrid(gains, delays))
    poles = dominant_pole(structure, gain, delay)
    near = poles[distance(poles, natural_pole) <= _REGION]
    expansion = [natural_pole]
    left_out = (near - natural_pole) / (near + natural_pole.conjugate())
    size = np.maximum(np.abs(left_out), _SMALLEST_DEVIATION)
    while len(expansion) < _MOST_POLES and np.any(np.abs(left_out) > _LEFT_OUT * size):
        worst = complex(near[np.argmax(np.abs(left_out) / size)])
        expansion.append(worst)
        left_out = left_out * (near - worst) / (near + worst.conjugate())
    nodes = scale * _REGION_LAG * np.arange(1, _FAST_PAIRS + 1) / _FAST_PAIRS
    fast = modal_loop(structure, np.ones_like(nodes), nodes)
    return PoleBasis(structure=structure, poles=np.array(expansion), fast=fast)


def distance(pole: Spectrum, reference: complex) -> Array:
    """Distance |p − p₀|/|p + p̄₀| of poles [-], shape (cells,); infinite right of the imaginary axis."""
    with np.errstate(divide="ignore", invalid="ignore"):  # no pole where Newton's iteration did not converge
        ratio = np.abs(pole - reference) / np.abs(pole + reference.conjugate())
        return np.where(pole.real < 0.0, ratio, np.inf)


def _parts(values: Spectrum) -> Array:
    return np.concatenate([values.real, values.imag])


_LANES = 8
_PIECE = 512  # blocks; the functions of a piece stay in the second-level cache


class Sums(NamedTuple):
    """What is summed up over the window."""

    # The matrix G, shape (functions, functions), in the order of `Expansion.weights`
    mean_products: Array
    # Root of the energy of each pole's response, followed to rest, and of the record, over the window's
    # length, shape (poles + 1,), in m s and m/s²
    root_energy: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Responses:
    """Responses of a basis to one record."""

    blocks: Blocks  # Record and window, cut for the structure
    basis: PoleBasis  # Poles and fast pairs

    def sums(self, ahead: int) -> Sums:
        """Sum up products and energies of the responses, once for each number of blocks ahead."""
        if ahead not in self._sums:
            self._sums[ahead] = self._sum_products(ahead)
        return self._sums[ahead]

    @cached_property
    def _sums(self) -> dict[int, Sums]:
        return {}

    def _sum_products(self, ahead: int) -> Sums:
        stepping = _Stepping(self.basis, self.blocks.step)
        pieces = self._early(stepping, ahead) if ahead else self._late(stepping)
        products = _integrate_products(pieces, self.blocks.end) / self.blocks.intervals
        ground = self.blocks.excitation
        energy = np.append(stepping.energy, (ground.acceleration**2).sum() * ground.time_step)
        return Sums(mean_products=products, root_energy=np.sqrt(energy / ground.window_duration))

    def _late(self, stepping: "_Stepping") -> Iterator[Array]:
        """Functions of late actuators inside the window, by pieces: all φ_k and the fast pairs."""
        blocks, lead_blocks = self.blocks, self.blocks.before
        if lead_blocks == 0:
            yield np.zeros((1, 2 * self.basis.poles.size + self.basis.fast.pole.size))
        for begin in range(0, blocks.left.size, _PIECE):
            lines = blocks.left[begin : begin + _PIECE], blocks.right[begin : begin + _PIECE]
            functions = np.concatenate([stepping.modal(*lines), stepping.pairs(*lines)], axis=1)
            yield functions[max(0, lead_blocks - 1 - begin) :]

    def _early(self, stepping: "_Stepping", ahead: int) -> Iterator[Array]:
        """Functions of early actuators inside the window: φ₀, later φ_k, ψ, and the lines of the record."""
        left, right = self.blocks.extend_lines(ahead)
        count = self.basis.poles.size
        initial_decay = np.exp(self.basis.poles[0] * ahead * self.blocks.step)
        earlier = np.zeros((ahead, 2))
        for begin in range(0, left.size, _PIECE):
            lines = left[begin : begin + _PIECE], right[begin : begin + _PIECE]
            modal = stepping.modal(*lines)
            later = modal[:, ::count].copy()
            both = np.concatenate([earlier, later])
            first, earlier = both[: later.shape[0]], both[later.shape[0] :]
            modal[:, ::count] = first
            added_real = later[:, 0] - initial_decay.real * first[:, 0] + initial_decay.imag * first[:, 1]
            added_imag = later[:, 1] - initial_decay.imag * first[:, 0] - initial_decay.real * first[:, 1]
            functions = np.column_stack([modal, added_real, added_imag, *lines])
            yield functions[max(0, self.blocks.before + ahead - 1 - begin) :]


class _Stepping:
    """Poles and fast pairs of a basis on their way through a record, piece by piece from rest."""

    def __init__(self, basis: PoleBasis, step: float) -> None:
        self._basis, self._step = basis, step
        count = basis.poles.size
        lanes = -(-count // _LANES) * _LANES
        early, late, decay = ramp_weights(basis.poles, step)
        self._weights = np.zeros((6, lanes))
        self._weights[:, :count] = [
            component for weight in (decay, early, late) for component in (weight.real, weight.imag)
        ]
        self._state = np.zeros((3, lanes))
        self._mixture = np.zeros((2 * lanes, 2 * count))
        self._mixture[:count], self._mixture[lanes : lanes + count] = np.split(basis.orthogonal.T, 2)
        self._pair_weights = pair_recursion(basis.fast.fast_poles, basis.fast.fast_residues, step)
        self._pair_state = np.zeros((4, self._pair_weights.shape[1]))

    def modal(self, left: Array, right: Array) -> Array:
        """All φ_k after each further block, real parts before imaginary ones, shape (blocks, 2 poles)."""
        responses = np.empty((left.size, self._mixture.shape[0]))
        _step_poles(left, right, self._weights, self._state, responses)
        return np.asarray(responses @ self._mixture)

    def pairs(self, left: Array, right: Array) -> Array:
        """Displacements of the fast pairs after each further block, shape (blocks, pairs)."""
        displacements = np.empty((left.size, self._pair_weights.shape[1]))
        _step_pairs(left, right, self._pair_weights, self._pair_state, displacements)
        return displacements

    @property
    def energy(self) -> Array:
        """Energy of each pole's response to what was stepped so far, followed to rest [m² s³]."""
        poles = self._basis.poles
        real, imag, squares = self._state[:, : poles.size]
        return np.asarray(squares * self._step + (real**2 + imag**2) / (-2.0 * poles.real))


def _integrate_products(pieces: Iterator[Array], end: float) -> Array:
    """Sum of the products of functions, shape (functions, functions), in units of a block.

    Every piece holds one row for each edge of a block; the window ends at a fraction of the last block.
    """
    rows, total, first = np.empty((0, 0)), np.empty((0, 0)), np.empty(0)
    for piece in pieces:
        if rows.size == 0:
            first, rows, total = piece[0], piece[:0], np.zeros((piece.shape[1], piece.shape[1]))
        total += piece.T @ piece
        rows = np.concatenate([rows[-2:], piece[-2:]])
    previous, last = rows[-2:]
    ending = (1.0 - end) * previous + end * last
    for weight, row in ((-0.5, first), (0.5 * end - 0.5, previous), (-1.0, last), (0.5 * end, ending)):
        total += weight * np.outer(row, row)
    return total


@compiled
def _step_poles(left: Array, right: Array, weights: Array, state: Array, responses: Array) -> None:
    """Responses after each block, real parts before imaginary ones; the state is that after the last.

    The state is the real and the imaginary part of each response, and the sum of its squares.
    """
    lane_count = state.shape[1]
    c, s = np.empty((6, _LANES)), np.empty((3, _LANES))
    for first in range(0, lane_count, _LANES):
        copy_rows(weights[:, first:], c)
        copy_rows(state[:, first:], s)
        for i in range(left.size):
            a, b = left[i], right[i]
            for j in range(_LANES):
                real = c[0, j] * s[0, j] - c[1, j] * s[1, j] + (c[2, j] * a + c[4, j] * b)
                imag = c[1, j] * s[0, j] + c[0, j] * s[1, j] + (c[3, j] * a + c[5, j] * b)
                s[0, j], s[1, j] = real, imag
                s[2, j] += real * real + imag * imag
            for j in range(_LANES):
                responses[i, first + j], responses[i, lane_count + first + j] = s[0, j], s[1, j]
        copy_rows(s, state[:, first : first + _LANES])


@compiled
def _step_pairs(left: Array, right: Array, weights: Array, state: Array, displacements: Array) -> None:
    """Displacements of pairs after each block; the state is that after the last.

    The state is the displacement before the last, the last one, and the two ends of the last block.
    """
    for j in range(weights.shape[1]):
        c1, c2, b0, b1, d0, d1 = weights[:, j]
        previous, now, a0, a1 = state[:, j]
        for i in range(left.size):
            new = c1 * now + c2 * previous + b0 * left[i] + b1 * right[i] + d0 * a0 + d1 * a1
            previous, now, a0, a1 = now, new, left[i], right[i]
            displacements[i, j] = new
        state[0, j], state[1, j], state[2, j], state[3, j] = previous, now, a0, a1


@dataclass(frozen=True, kw_only=True, eq=False)
class Expansion:
    """Weights of actuators that look the same number of blocks ahead."""

    cells: NDArray[np.intp]  # Which cells, shape (n,)
    # Blocks by which the displacement is ahead of the exact response; 0 for actuators that are late
    ahead: int
    weights: Array  # Weight of each function that `Responses` steps, shape (n, functions)
    # Largest displacement that is left out, for responses of size 1 of the poles and, last, for a ground
    # acceleration of size 1, shape (n, poles + 1)
    left_out: Array


def expansions(
    basis: PoleBasis, parts: Sequence[tuple[NDArray[np.intp], ModalLoop | LeadingLoop]], step: float
) -> list[Expansion]:
    """Expand the deviations of all cells whose poles are near enough to that of the structure.

    `step` [s].
    Returns one for each number of blocks that cells look ahead; cells that cannot be expanded are in none.
    """
    results = []
    for cells, loop in parts:
        if isinstance(loop, ModalLoop):
            results.append(_late(basis, cells, loop))
        else:
            results += _early(basis, cells, loop, step)
    return [expansion for expansion in results if expansion.cells.size]


def _late(basis: PoleBasis, cells: NDArray[np.intp], loop: ModalLoop) -> Expansion:
    shares, left_out = basis.coefficients(loop.pole)
    fast, fast_left_out = basis.fast_coefficients(loop)
    amplitudes = loop.residue * shares
    amplitudes[0] -= 1.0 / (2j * basis.structure.pole.imag)
    weights = np.concatenate([-2.0 * amplitudes.real, 2.0 * amplitudes.imag, fast]).T
    usable = np.isfinite(left_out)
    neglected_part = 2.0 * np.abs(loop.residue * shares) * np.where(usable, left_out, 0.0)
    neglected_part = np.concatenate([neglected_part, fast_left_out[np.newaxis]])
    return Expansion(
        cells=cells[usable], ahead=0, weights=weights[usable].copy(), left_out=neglected_part.T[usable]
    )


def _early(basis: PoleBasis, cells: NDArray[np.intp], loop: LeadingLoop, step: float) -> list[Expansion]:
    shares, left_out = basis.coefficients(loop.pole)
    ahead, recursion = leading_recursion(loop, step)
    back = ahead * step - loop.lead
    decayed_residue = loop.residue * np.exp(-loop.pole * back)
    amplitudes = decayed_residue * shares
    partial_amplitudes = amplitudes[:1].copy()
    amplitudes[0] *= np.exp(basis.structure.pole * ahead * step)
    amplitudes[0] -= 1.0 / (2j * basis.structure.pole.imag)
    weights = np.concatenate(
        [
            -2.0 * amplitudes.real,
            2.0 * amplitudes.imag,
            -2.0 * partial_amplitudes.real,
            2.0 * partial_amplitudes.imag,
            recursion[BLOCK_COLUMNS],
        ]
    ).T
    usable = np.isfinite(left_out)
    neglected_part = 2.0 * np.abs(decayed_residue * shares) * np.where(usable, left_out, 0.0)
    neglected_part = np.concatenate([neglected_part, np.zeros((1, cells.size))]).T
    groups = []
    for count in np.unique(ahead[usable]):
        has_count = (ahead == count) & usable
        groups.append(
            Expansion(
                cells=cells[has_count],
                ahead=int(count),
                weights=weights[has_count].copy(),
                left_out=neglected_part[has_count],
            )
        )
    return groups


LEFT_OUT = 3e-5
"""Largest share of RMS^R that an expansion may leave out [-]."""


def mean_squares(
    responses: Sequence[Responses], expansions: Sequence[Expansion], motion: NDArray[np.int64]
) -> tuple[Array, NDArray[np.bool_]]:
    """Mean square deviations where the expansion is precise enough under the motion.

    Returns `mean_square`: mean of (x_m − x_I)² over the window [m²], shape (cells,); zero where it is not
    known.
    Returns `precise_cells`: where the expansion leaves out at most `LEFT_OUT` of RMS^R, shape (cells,).
    """
    mean_square, precise_cells = np.zeros(motion.size), np.zeros(motion.size, dtype=np.bool_)
    for expansion in expansions:
        motion_of_cells = motion[expansion.cells]
        motions = np.unique(motion_of_cells)
        place = np.searchsorted(motions, motion_of_cells)
        sums = [responses[k].sums(expansion.ahead) for k in motions]
        products, energy = (np.stack(arrays) for arrays in zip(*sums, strict=True))
        squares = _quadratic_forms(expansion.weights, products, place)
        left_out = np.einsum("ij,ij->i", expansion.left_out, energy[place])
        precise = left_out <= LEFT_OUT * np.sqrt(squares)
        mean_square[expansion.cells[precise]] = squares[precise]
        precise_cells[expansion.cells[precise]] = True
    return mean_square, precise_cells


@compiled
def _quadratic_forms(weights: Array, products: Array, motion_of_cells: NDArray[np.int64]) -> Array:
    """Form wᵀGw with one of several symmetric G for each row w of the weights; never below zero."""
    forms = np.empty(motion_of_cells.size)
    count = weights.shape[1]
    for row in range(motion_of_cells.size):
        w, total = weights[row], 0.0
        for k in range(count):
            g, product = products[motion_of_cells[row], k], 0.0
            for m in range(count):
                product += g[m] * w[m]
            total += w[k] * product
        forms[row] = max(total, 0.0)
    return forms
