"""Many actuators before one structure: the cells of a grid, solved side by side."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.simulation.linear_loop.blocks import block_length
from reliab.simulation.linear_loop.drive_stepping import DrivenCells, driven_cells, shared_drives
from reliab.simulation.linear_loop.pole_plane import Expansion, expansions, pole_basis
from reliab.simulation.linear_loop.pole_recursion import (
    BlockRecursion,
    LeadingLoop,
    ModalLoop,
    leading_loop,
    modal_loop,
    recursions,
    reduction_loss,
)
from reliab.structures.structure import Structure, critical_delay, refuse_long_leads

REDUCTION_TOLERANCE = 3e-5
"""Largest relative error of RMS^R that the reduction to the dominant pole may cause [-]; the peak,
and with it MTE^R, then stays within 1e-3 of the exact one."""

LEAD_TOLERANCE = 3e-3
"""The same for leads. For a lead the reduction neglects content above the structure's frequency, where the
deviation is very small: RMS^R errs by less than a tenth of this, and MTE^R by less than half."""

UNSTABLE_TOLERANCE = 2e-3
"""The same beyond the critical delay, where the error grows exponentially with the delay."""


@dataclass(frozen=True, kw_only=True)
class Cells:
    """Actuators of given gains and delays before one structure.

    What does not depend on the ground motion (poles, residues, validity of the reduction) is worked
    out once and kept.
    """

    structure: Structure  # The structure under test
    # gain, delay: Actuator gain k_p [-], positive, and delay τ [s], negative for a lead, shape (cells,) each
    gain: Array
    delay: Array

    def __post_init__(self) -> None:
        for name, values, lowest in (("gains", self.gain, 1e-6), ("delays", self.delay, -np.inf)):
            wrong = ~(np.isfinite(values) & (values >= lowest))
            if wrong.any():
                raise InputError(
                    f"Actuator {name} must be finite, and gains positive",
                    value=values[wrong][0],
                    remedy="Give gains as measured over command amplitude and delays in seconds",
                )
        refuse_long_leads(self.structure, self.gain, self.delay)

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the delay of each cell is below the critical delay, as every lead is."""
        return self.delay < critical_delay(self.structure, self.gain)

    @cached_property
    def leads(self) -> NDArray[np.bool_]:
        """Whether the actuator of each cell is early instead of late."""
        return np.asarray(self.delay < 0.0)

    @cached_property
    def reduced_loops(self) -> list[tuple[NDArray[np.intp], ModalLoop | LeadingLoop]]:
        """Cells and the loop of each, reduced to its dominant pole pair: late ones, then early ones."""
        late, early = np.flatnonzero(~self.leads), np.flatnonzero(self.leads)
        parts: list[tuple[NDArray[np.intp], ModalLoop | LeadingLoop]] = []
        if late.size:
            parts.append((late, modal_loop(self.structure, self.gain[late], self.delay[late])))
        if early.size:
            parts.append((early, leading_loop(self.structure, self.gain[early], -self.delay[early])))
        return parts

    def expansions(self, step: float) -> list[Expansion]:
        """Deviations expanded in the structure's basis of poles, for blocks of a given length [s]."""
        return expansions(pole_basis(self.structure), self.reduced_loops, step)

    def recursions(self, step: float) -> list[BlockRecursion]:
        """Recursions of all cells for blocks of a given length [s]."""
        if step == block_length(self.structure):
            return self._own_recursions
        return self._recursions(step)

    @cached_property
    def _own_recursions(self) -> list[BlockRecursion]:
        return self._recursions(block_length(self.structure))

    def driven(self, step: float, late: BlockRecursion) -> DrivenCells:
        """Late cells that respond to the structure's shared drives, for blocks of a given length [s]."""
        if late is self._own_recursions[0]:
            return self.own_driven
        return driven_cells(shared_drives(self.structure, step), late.coefficients)

    @cached_property
    def own_driven(self) -> DrivenCells:
        """Late cells that respond to the shared drives, for blocks of the length that suits the structure."""
        drives = shared_drives(self.structure, block_length(self.structure))
        return driven_cells(drives, self._own_recursions[0].coefficients)

    def _recursions(self, step: float) -> list[BlockRecursion]:
        return [
            recursion for place, loop in self.reduced_loops for recursion in recursions(loop, step, place)
        ]

    @cached_property
    def tolerance(self) -> Array:
        """Largest error of RMS^R that the reduction to the dominant pole may cause [-], shape (cells,)."""
        tolerance = np.where(self.stable, REDUCTION_TOLERANCE, UNSTABLE_TOLERANCE)
        return np.where(self.leads, LEAD_TOLERANCE, tolerance)

    @cached_property
    def reducible_anyway(self) -> NDArray[np.bool_]:
        """Whether the reduction is accurate enough in every band, and so under any record, shape (cells,)."""
        neglected_power, total = self.reduction
        return np.asarray((neglected_power <= self.tolerance**2 * total).all(axis=0))

    @cached_property
    def reduction(self) -> tuple[Array, Array]:
        """Squared error of the reduction and squared deviation, by frequency band, shape (bands, cells)."""
        parts = [
            reduction_loss(self.structure, self.gain[place], self.delay[place], loop)
            for place, loop in self.reduced_loops
        ]
        if len(parts) == 1:
            return parts[0]
        order = np.argsort(np.concatenate([place for place, _ in self.reduced_loops]))
        lost_power, total = (
            np.concatenate(columns, axis=1)[:, order] for columns in zip(*parts, strict=True)
        )
        return lost_power, total
