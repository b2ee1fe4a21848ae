"""Structures prepared together give what each gives alone, to the bit."""

import numpy as np
import pytest

from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.structure_batch import StructureBatch
from reliab.structures.structure import Structure
from reliab.sweep.grid import ExplicitGrid, ScaledGrid

STRUCTURES = [
    Structure(frequency=0.25, damping_ratio=0.02),
    Structure(frequency=1.3, damping_ratio=0.1, experimental_fraction=0.5),
    Structure(frequency=7.0, damping_ratio=0.005),
]
RECORD = np.random.default_rng(7).standard_normal(1800)


@pytest.mark.parametrize("grid", [ExplicitGrid(), ScaledGrid(gain_steps=5, delay_steps=6, lead_steps=4)])
@pytest.mark.parametrize("window", [(0.0, -1.0), (3.337, 9.1), (17.0, 17.05)])
def test_each_structure_is_solved_as_if_it_were_alone(grid, window):
    excitation = Excitation(acceleration=RECORD, time_step=0.0137, window=window)
    cells = [grid.cells(structure) for structure in STRUCTURES]
    prepared = StructureBatch.from_cells(cells).prepare(excitation)
    for structure, some, beforehand in zip(STRUCTURES, cells, prepared, strict=True):
        together = Loop(excitation=excitation, structure=structure, prepared=beforehand).deviation(some)
        alone = Loop(excitation=excitation, structure=structure).deviation(some)
        assert together.mean_square.tobytes() == alone.mean_square.tobytes()
        assert together.peak.tobytes() == alone.peak.tobytes()
        assert together.ideal_peak == alone.ideal_peak


def test_other_cells_of_a_prepared_loop_are_stepped_anew():
    excitation = Excitation(acceleration=RECORD, time_step=0.01)
    structure = STRUCTURES[1]
    batch = StructureBatch.from_cells([ExplicitGrid().cells(structure)])
    (beforehand,) = batch.prepare(excitation)
    loop = Loop(excitation=excitation, structure=structure, prepared=beforehand)
    other = loop.cells(gain=[0.99, 1.0], delay=[0.001, 0.002])
    alone = Loop(excitation=excitation, structure=structure).deviation(other)
    assert loop.deviation(other).peak.tolist() == alone.peak.tolist()


def test_a_record_that_would_fill_the_memory_is_left_to_each_structure():
    long = Excitation(acceleration=np.zeros(4_100_000), time_step=0.01)
    assert StructureBatch.from_cells([ExplicitGrid().cells(STRUCTURES[0])]).prepare(long) == [None]


def test_a_window_shorter_than_two_blocks_is_left_to_each_structure():
    excitation = Excitation(acceleration=RECORD, time_step=0.01, window=(4.0, 4.015))
    assert StructureBatch.from_cells([ExplicitGrid().cells(STRUCTURES[0])]).prepare(excitation) == [None]
