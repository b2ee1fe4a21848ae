"""Uncertain entries of a matrix are drawn with the natural frequency that a test shows."""

import numpy as np
import pytest

from reliab.assessment.rebuilt_error.own_frequency import EntriesOfStructure
from reliab.structures.partition import Partition

STIFFNESS = 900.0 * np.array([[2.0, -1.0], [-1.0, 1.0]])
STRUCTURE = Partition(
    mass=np.eye(2),
    damping=np.eye(2),
    stiffness=STIFFNESS,
    interface=np.array([[1.0], [0.0]]),
    specimen_stiffness=np.array([[500.0]]),
)
ENTRY = "stiffness_entry_1_2"


def lowest(change):
    """Lowest natural frequency with the entry off by a share, over the stated one."""
    stiffness = STIFFNESS * (1.0 + change * np.array([[0.0, 1.0], [1.0, 0.0]]))
    return np.sqrt(np.linalg.eigvalsh(stiffness)[0] / np.linalg.eigvalsh(STIFFNESS)[0])


def test_a_draw_has_the_entries_that_move_its_frequency():
    entries = EntriesOfStructure.from_parts(STRUCTURE, {ENTRY: 0.02})
    trial = np.linspace(-0.04, 0.04, 41)
    target = np.array([-0.03, 0.0, 0.021])
    draws = entries.match_frequencies({ENTRY: trial, "frequency": target, "damping_ratio": np.arange(3.0)})
    factors = np.array([lowest(change) for change in draws[ENTRY]])
    assert factors * (1.0 + draws["frequency"]) == pytest.approx(1.0 + target)
    assert (
        np.abs(draws["frequency"]).max() < 0.6 * np.abs(np.diff([lowest(single) for single in trial])).max()
    )
    assert draws["damping_ratio"].tolist() == [0.0, 1.0, 2.0]


def test_unexplained_deviation_stays_with_the_frequency():
    entries = EntriesOfStructure.from_parts(STRUCTURE, {ENTRY: 0.02})
    draws = entries.match_frequencies({ENTRY: np.array([-0.01, 0.01]), "frequency": np.array([0.2, 0.2])})
    assert draws["frequency"] == pytest.approx(np.full(2, 1.2 / lowest(-0.01) - 1.0))


def test_entries_leave_the_frequency_open():
    slope = (lowest(1e-4) - lowest(-1e-4)) / 2e-4
    deviation = EntriesOfStructure.from_parts(STRUCTURE, {ENTRY: 0.01}).deviation
    assert deviation == pytest.approx(0.01 * abs(slope), rel=0.05)


@pytest.mark.parametrize("parts", [{}, {"damping_entry_1_1": 0.1}, {"floor_mass_1": 0.1}, {ENTRY: 0.0}])
def test_nothing_else_leaves_it_open(parts):
    assert EntriesOfStructure.from_parts(STRUCTURE, parts) is None
