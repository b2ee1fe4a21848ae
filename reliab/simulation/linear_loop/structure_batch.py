"""Several structures under one record: blocks, drives and late cells of all in two compiled calls.

Between short compiled calls Python holds the interpreter's lock, so that a second thread waits. A sweep
therefore solves what most cells of its structures need (blocks, shared drives, and the cells that these
drive) together, and hands it to the loop of each structure, which solves the rest.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array, Spectrum, read_only
from reliab.core.compiled import compiled, copy_rows
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.block_kernel import cut_records
from reliab.simulation.linear_loop.blocks import Blocks, block_length, mode_weights, spacing
from reliab.simulation.linear_loop.cells import Cells
from reliab.simulation.linear_loop.drive_stepping import DrivenRecord, Single, Stepped, in_units, track
from reliab.simulation.linear_loop.shared_drives import DRIVES, drive_histories, shared_drives

_MOST_BLOCKS = 4_000_000  # of all structures together, of some 50 bytes each


@dataclass(frozen=True, kw_only=True, eq=False)
class Prepared:
    """What was found together with other structures of one structure under a record."""

    cells: Cells  # The cells that were prepared
    blocks: Blocks  # The record, cut for the structure
    driven_record: DrivenRecord  # Its shared drives
    stepped: Stepped  # The cells that they drive


@dataclass(frozen=True, kw_only=True, eq=False)
class StructureBatch:
    """Structures with their cells, and all that does not depend on the record."""

    cells: tuple[Cells, ...]  # The cells of each structure
    steps: Array  # Length of a block of each structure [s], shape (structures,)
    # Pole of each structure [1/s], and weights and decay of its mode over a block, shape (structures, 3)
    poles: Spectrum
    weights: Spectrum
    taps: Array  # Of the shared drives of each structure, shape (structures, 13, drives)
    # Of `drive_kernel.track`, for the driven cells of all structures, filled up to whole lanes, (11, lanes)
    coefficients: NDArray[np.float32]
    first: NDArray[np.int64]  # First lane of each structure, and the end, shape (structures + 1,)

    @classmethod
    def from_cells(cls, cells: Sequence[Cells]) -> "StructureBatch":
        """Bring the cells of several structures together."""
        structures = [cells_of_structure.structure for cells_of_structure in cells]
        steps = [block_length(structure) for structure in structures]
        drives = [shared_drives(structure, step) for structure, step in zip(structures, steps, strict=True)]
        filled = [cells_of_structure.own_driven.coefficients for cells_of_structure in cells]
        poles = [structure.pole for structure in structures]
        return cls(
            cells=tuple(cells),
            steps=np.array(steps),
            poles=np.array(poles),
            weights=np.array([mode_weights(pole, step) for pole, step in zip(poles, steps, strict=True)]),
            taps=np.stack([shared.taps for shared in drives]),
            coefficients=np.concatenate(filled, axis=1),
            first=np.cumsum([0, *(lanes.shape[1] for lanes in filled)]),
        )

    def prepare(self, excitation: Excitation) -> Sequence[Prepared | None]:
        """Cut a record for all structures and step their driven cells.

        Returns one for each structure; None for all where the window is shorter than two blocks of one of
        them, or the record so long that the blocks of all would fill the memory.
        """
        places = [spacing(excitation, step) for step in self.steps.tolist()]
        shortened = any(place.step != step for place, step in zip(places, self.steps.tolist(), strict=True))
        if shortened or sum(place.blocks for place in places) > _MOST_BLOCKS:
            return [None for _ in self.cells]
        h, counts = excitation.time_step, np.array([place.blocks for place in places])
        left, right, ideal = cut_records(
            (read_only(excitation.acceleration[np.newaxis]), h),
            self.poles,
            (np.array([mode_weights(pole, h) for pole in self.poles.tolist()]), self.weights),
            (np.array([place.first for place in places]), self.steps, counts),
        )
        driven = _step_structures(
            (left[0], right[0], ideal[0], counts),
            (np.array([place.before for place in places]), np.array([place.end for place in places])),
            self.taps,
            (self.coefficients, self.first),
            np.float32(1.0),
        )
        prepared, at = [], 0
        for rank, place in enumerate(places):
            blocks = slice(at, at + place.blocks)
            cut = Blocks(
                step=place.step,
                before=place.before,
                end=place.end,
                left=left[0, blocks],
                right=right[0, blocks],
                ideal=ideal[0, at + rank : at + rank + place.blocks + 1],
                excitation=excitation,
                pole=complex(self.poles[rank]),
            )
            prepared.append(self._of_structure(rank, cut, blocks, driven))
            at += place.blocks
        return prepared

    def _of_structure(self, rank: int, cut: Blocks, blocks: slice, driven: "_Driven") -> Prepared:
        drives, scales, squares, peaks = driven
        lanes = slice(self.first[rank], self.first[rank + 1])
        return Prepared(
            cells=self.cells[rank],
            blocks=cut,
            driven_record=DrivenRecord(
                drives=np.ascontiguousarray(drives[:, blocks]), scale=float(scales[rank])
            ),
            stepped=Stepped(squares=squares[lanes], peaks=peaks[lanes]),
        )


_Driven = tuple[NDArray[np.float32], Array, Array, Array]


@compiled
def _step_structures(
    lines: tuple[Array, Array, Array, NDArray[np.int64]],
    bounds: tuple[NDArray[np.int64], Array],
    taps: Array,
    cells: tuple[NDArray[np.float32], NDArray[np.int64]],
    unity: Single,
) -> _Driven:
    """Step the drives of each structure, and the cells that they drive.

    Blocks and cells of all structures stand one after the other.
    """
    (left, right, ideal, counts), (before, end), (coefficients, first) = lines, bounds, cells
    drives, scales = np.empty((DRIVES, left.size), dtype=np.float32), np.empty(counts.size)
    lanes = coefficients.shape[1]
    squares, peaks = np.empty(lanes), np.empty(lanes)
    at = 0
    for k in range(counts.size):
        blocks, exact = slice(at, at + counts[k]), ideal[at + k : at + k + counts[k] + 1]
        histories = drive_histories(left[blocks], right[blocks], exact, taps[k])
        own_drives, scales[k] = in_units(histories)
        own_cells = np.ascontiguousarray(coefficients[:, first[k] : first[k + 1]])
        own_squares, own_peaks = track(own_drives, before[k], end[k], own_cells, unity)
        copy_rows(own_drives, drives[:, blocks])
        for i in range(own_peaks.size):
            squares[first[k] + i], peaks[first[k] + i] = own_squares[i], own_peaks[i]
        at += counts[k]
    return drives, scales, squares, peaks
