"""The loop's engines behind one function: each cell is solved by the fastest engine that is accurate enough.

`pole`
    dominant pole pair, fastest; valid while what it leaves out is below the tolerance for the
    record at hand, which is checked for every cell
`delay`
    the delay equation, for any delay
`spectral`
    frequency domain, exact below the stability limit and for leads; the reference against which the other two
    are tested

An actuator that leads needs future values, so that the delay equation cannot be stepped in time; its bounded
solution is computed with the dominant pole or in the frequency domain.
"""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.core.errors import InputError
from reliab.core.significant_digits import significant
from reliab.simulation.excitation import Deviation, Excitation
from reliab.simulation.linear_loop import delay_stepper, drive_stepping, pole_recursion, spectral
from reliab.simulation.linear_loop.blocks import Blocks, cut
from reliab.simulation.linear_loop.cells import Cells
from reliab.simulation.linear_loop.drive_stepping import DrivenRecord, DriveResponse, shared_drives
from reliab.simulation.linear_loop.pole_plane import Responses, pole_basis
from reliab.simulation.linear_loop.pole_recursion import band_edges
from reliab.structures.structure import Structure

_OFF_SCALE, _ROUGH_TOLERANCE = 2.0, 0.05
"""Beyond the critical delay only the fact that an RMS^R exceeds the first matters: above it the
reduction may err by the second."""


class Engine(StrEnum):
    """How the loop is solved."""

    AUTOMATIC = "automatic"
    POLE = "pole"
    DELAY = "delay"
    SPECTRAL = "spectral"


@dataclass(frozen=True, kw_only=True)
class Loop:
    """One structure under one ground motion, ready to be solved for any actuator.

    >>> import numpy as np
    >>> record = np.sin(2 * np.pi * np.arange(0, 20, 0.01))
    >>> loop = Loop(
    ...     excitation=Excitation(acceleration=record, time_step=0.01),
    ...     structure=Structure(frequency=1.0, damping_ratio=0.05),
    ... )
    >>> found = loop.deviation(loop.cells(gain=[1.0, 0.99], delay=[0.002, 0.0]))
    >>> (found.peak / found.ideal_peak).round(3)
    array([0.142, 0.099])
    """

    excitation: Excitation  # Record and window
    structure: Structure  # The structure under test
    # How the loop is solved; by default the dominant pole where it is valid and the delay equation elsewhere
    engine: Engine = Engine.AUTOMATIC

    def cells(self, *, gain: object, delay: object) -> Cells:
        """Actuators before this structure; gain [-] and delay [s] are broadcast and flattened."""
        gains, delays = np.broadcast_arrays(np.asarray(gain, dtype=float), np.asarray(delay, dtype=float))
        return Cells(structure=self.structure, gain=gains.ravel(), delay=delays.ravel())

    @cached_property
    def blocks(self) -> Blocks:
        """The record cut for the stepping engines."""
        return cut(self.excitation, self.structure)

    @cached_property
    def _band_power(self) -> Array:
        return self.excitation.band_power(band_edges(self.structure))

    def reduction_error(self, cells: Cells) -> Array:
        """Relative error of RMS^R that the reduction to the dominant pole causes [-], shape (cells,).

        Returns error for this record with free vibration until rest; infinite where no dominant pole was
        found.
        """
        neglected_power, total = cells.reduction
        with np.errstate(invalid="ignore"):  # infinite loss in a band without power
            error = np.sqrt(self._band_power @ neglected_power / np.maximum(self._band_power @ total, 1e-300))
        return np.where(np.isnan(error), np.inf, error)

    def reducible(self, cells: Cells) -> NDArray[np.bool_]:
        """Whether the dominant pole is accurate enough to replace the whole loop, shape (cells,)."""
        anyway = cells.reducible_anyway
        return anyway if anyway.all() else self.reduction_error(cells) <= cells.tolerance

    def deviation(self, cells: Cells) -> Deviation:
        """Deviation of the measured displacement from the exact response over the window.

        `cells`: the actuators, before this loop's structure. Returns mean square and peak of each cell, in
        the order of the cells. Raises InputError if the engine was chosen and cannot solve a cell; the
        message says which could.
        """
        if self.engine is Engine.SPECTRAL:
            return spectral.deviation(self.excitation, self.structure, cells.gain, cells.delay)
        if self.engine is Engine.DELAY:
            if cells.leads.any():
                raise InputError(
                    "The engine 'delay' cannot simulate an early actuator (a negative delay)",
                    value=f"a lead of {-1e3 * cells.delay.min():.4g} ms",
                    remedy="Use the engine 'automatic', 'pole' or 'spectral'",
                )
            return delay_stepper.deviation(self.blocks, self.structure, cells.gain, cells.delay)
        reducible = self.reducible(cells)
        if reducible.all():
            return self._solve_reduced(cells)
        error, tolerance = self.reduction_error(cells), cells.tolerance
        if self.engine is Engine.POLE:
            worst = int(np.argmax(error / tolerance))
            raise InputError(
                f"The engine 'pole' would change the RMS error by more than {tolerance[worst]:g}",
                value=f"{significant(error[worst], 2)} at k_p = {cells.gain[worst]:g}, τ = "
                f"{cells.delay[worst]:g} s",
                remedy="Use the engine 'automatic'",
            )
        return self._solve_mixed(cells, reducible, ~cells.stable & (error <= _ROUGH_TOLERANCE))

    @cached_property
    def responses(self) -> Responses:
        """Responses of the structure's basis of poles to the record."""
        return Responses(blocks=self.blocks, basis=pole_basis(self.structure))

    @cached_property
    def driven_record(self) -> DrivenRecord:
        """The structure's shared drives under the record."""
        return DrivenRecord.from_blocks(self.blocks, shared_drives(self.structure, self.blocks.step))

    def _solve_reduced(self, cells: Cells) -> Deviation:
        deviation = Deviation(
            mean_square=np.empty(cells.gain.size),
            peak=np.empty(cells.gain.size),
            ideal_peak=self.blocks.ideal_peak,
        )
        for recursion in cells.recursions(self.blocks.step):
            is_reduced_only = np.ones(recursion.cells.size, dtype=np.bool_)
            if recursion.ahead == 0 and self.driven_record.is_bounded:
                driven, record = cells.driven(self.blocks.step, recursion), self.driven_record
                drive_response = DriveResponse.step_through(self.blocks, record, driven)
                difference, precise = drive_stepping.deviation(self.blocks, record, driven, drive_response)
                deviation.put(recursion.cells[driven.place], difference)
                is_reduced_only[driven.place] = ~precise
            if is_reduced_only.any():
                coefficients = recursion.coefficients[:, is_reduced_only]
                difference = pole_recursion.deviation(self.blocks, coefficients, ahead=recursion.ahead)
                deviation.put(recursion.cells[is_reduced_only], difference)
        return deviation

    def _solve_mixed(self, cells: Cells, reducible: NDArray[np.bool_], rough: NDArray[np.bool_]) -> Deviation:
        """Reduce the loop where that is good enough, and solve the delay equation elsewhere."""
        deviation = self._solve_reduced(cells)
        off_scale = deviation.mean_square > (_OFF_SCALE * deviation.ideal_peak) ** 2
        is_repeated = ~(reducible | (rough & off_scale))
        for is_selected in (is_repeated & ~cells.leads, is_repeated & cells.leads):
            if is_selected.any():
                exact = self._solve_whole(cells.gain[is_selected], cells.delay[is_selected])
                deviation.put(is_selected, exact)
        return deviation

    def _solve_whole(self, gain: Array, delay: Array) -> Deviation:
        """Solve the whole loop for actuators that are all late, or all early."""
        if delay[0] < 0.0:
            return spectral.deviation(self.excitation, self.structure, gain, delay, longest=self.blocks.step)
        return delay_stepper.deviation(self.blocks, self.structure, gain, delay)

    def rest_deviation(self) -> Deviation:
        """Deviation of an actuator that does not move: zero displacement against the exact response."""
        window_response = self.blocks.ideal[self.blocks.before :]
        end = self.blocks.end
        squares = window_response[:-1] ** 2
        last = window_response[-2] + end * (window_response[-1] - window_response[-2])
        total = squares.sum() - 0.5 * squares[0] - 0.5 * squares[-1] + 0.5 * end * (squares[-1] + last**2)
        peak = self.blocks.ideal_peak
        return Deviation(
            mean_square=np.array([total / self.blocks.intervals]), peak=np.array([peak]), ideal_peak=peak
        )
