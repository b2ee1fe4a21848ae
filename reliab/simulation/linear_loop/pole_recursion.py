"""The recursion of engine `pole`: two pole pairs, exact for a record that is linear in each block.

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
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum
from reliab.simulation.linear_loop.blocks import ramp_weights
from reliab.simulation.linear_loop.dominant_pole import LeadingLoop, ModalLoop

_Real = TypeVar("_Real", np.float32, np.float64)

FROM_BLOCK = slice(8, 10)
"""Coefficients with which the record at both ends of a block enters beside the dominant pair."""


def fill_lanes(cells: NDArray[_Real], lanes: int) -> NDArray[_Real]:
    """Fill up the last set of lanes with copies of the last cell; shape (…, multiple of lanes).

    Rows are contiguous, so that kernels are compiled for one layout.
    """
    missing = -cells.shape[-1] % lanes
    copies = np.repeat(cells[..., -1:], missing, axis=-1)
    return np.ascontiguousarray(np.concatenate([cells, copies], axis=-1) if missing else cells)


@dataclass(frozen=True, kw_only=True)
class Recursion:
    """The recursion of cells that look the same number of blocks ahead."""

    cells: NDArray[np.intp]  # Which cells, shape (n,)
    # Blocks by which the displacement is ahead of the exact response; 0 for actuators that are late
    ahead: int
    coefficients: Array  # Shape (12, n), as `recursion` describes them


def recursions(loop: ModalLoop | LeadingLoop, step: float, cells: NDArray[np.intp]) -> list[Recursion]:
    """Recursions of the cells of a reduced loop.

    `step` [s].
    """
    if isinstance(loop, ModalLoop):
        return [Recursion(cells=cells, ahead=0, coefficients=recursion(loop, step))]
    ahead, coefficients = leading_recursion(loop, step)
    return [
        Recursion(cells=cells[alike], ahead=int(count), coefficients=coefficients[:, alike])
        for count in np.unique(ahead)
        for alike in (np.flatnonzero(ahead == count),)
    ]


def leading_recursion(loop: LeadingLoop, step: float) -> tuple[NDArray[np.int64], Array]:
    """Coefficients of the recursion of actuators that lead.

    `step` [s].
    """
    pole, residue = loop.pole, loop.residue
    ahead = np.ceil(loop.lead / step).astype(np.int64)
    back = ahead * step - loop.lead
    carried = residue * np.exp(-pole * back)
    slow = pair_recursion(np.stack([pole, pole.conj()]), np.stack([carried, carried.conj()]), step)
    # ∫₀^θ e^(−p(θ−u))a(u) du of the record's straight line, from its right end backwards
    whole = -np.expm1(-pole * back) / pole
    falling = (back - whole) / (pole * step)
    share = back / step
    left = 2.0 * (residue * falling).real - loop.feedthrough * share
    right = 2.0 * (residue * (whole - falling)).real - loop.feedthrough * (1.0 - share)
    none = np.zeros_like(left)
    return ahead, np.concatenate([slow, np.stack([none, none, left, right, none, none])])


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
    ahead, behind = residues, residues * decay[::-1]
    return np.stack(
        [
            decay.sum(axis=0).real,
            -decay.prod(axis=0).real,
            -(ahead * early).sum(axis=0).real,
            -(ahead * late).sum(axis=0).real,
            (behind * early).sum(axis=0).real,
            (behind * late).sum(axis=0).real,
        ]
    )
