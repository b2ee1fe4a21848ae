"""Tests of what a description states of how exactly a structure is known."""

import numpy as np
import pytest
from pydantic import ValidationError

from reliab.core.errors import InputError
from reliab.simulation.frames.tolerances_table import TolerancesTable


def test_one_number_stands_for_each_storey_by_itself():
    assert TolerancesTable(storey_stiffnesses=0.05).of_parts(2) == {
        "storey_stiffness_1": 0.05,
        "storey_stiffness_2": 0.05,
    }


def test_a_correlation_divides_a_deviation_between_all_and_each():
    parts = TolerancesTable(floor_masses=0.06, storey_correlation=0.25).of_parts(3)
    assert parts["floor_mass"] == pytest.approx(0.03)
    assert np.hypot(parts["floor_mass"], parts["floor_mass_2"]) == pytest.approx(0.06)
    assert TolerancesTable(floor_masses=0.06, storey_correlation=1.0).of_parts(3) == {"floor_mass": 0.06}


def test_a_specimen_that_changes_the_structure_is_a_part_of_it():
    beside = TolerancesTable(specimen_stiffness=0.04)
    within = TolerancesTable(specimen_stiffness=0.04, specimen_changes_structure=True)
    assert (beside.of_specimen_alone, beside.of_parts(2)) == (0.04, {})
    assert (within.of_specimen_alone, within.of_parts(2)) == (0.0, {"specimen_stiffness": 0.04})


def test_numbers_for_each_are_as_many_as_there_are_modes():
    table = TolerancesTable(mode_frequencies=(0.01, 0.02))
    assert table.of_parts(2) == {"mode_frequency_1": 0.01, "mode_frequency_2": 0.02}
    with pytest.raises(InputError, match="2 of mode frequency"):
        table.of_parts(3)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"mode_frequencies": 0.01, "stiffness": 0.02}, "give mode_frequencies, or"),
        ({"mode_frequencies": 0.01, "storey_stiffnesses": 0.02}, "give mode_frequencies, or"),
        ({"damping": 0.1, "damping_ratio": 0.1}, "give one of damping"),
        ({"mode_damping_ratios": 0.1, "storey_dampings": 0.1}, "give one of damping"),
        ({"storey_correlation": 0.5, "storey_stiffnesses": (0.1, 0.2)}, "needs floors or storeys"),
        ({"storey_stiffnesses": 0.4}, "must be below 0.333"),
    ],
)
def test_tolerances_that_contradict_each_other(keys, message):
    with pytest.raises(ValidationError, match=message):
        TolerancesTable(**keys)


def entries(correlation, *places, deviation=0.04):
    table = {"matrix": "stiffness", "places": places, "deviation": deviation, "correlation": correlation}
    return TolerancesTable(entries=[table])


def test_entries_are_named_by_row_and_column_and_share_what_is_correlated():
    assert entries(0.0, ("2", "1")).of_parts(2) == {"stiffness_entry_2_1": 0.04}
    parts = entries(0.25, ("1", "1"), ("1", "2")).of_parts(2)
    assert parts["stiffness_entry_1_1_1_2"] == pytest.approx(0.02)
    assert np.hypot(0.02, parts["stiffness_entry_1_2"]) == pytest.approx(0.04)
    assert entries(1.0, ("1", "1"), ("1", "2")).of_parts(2) == {"stiffness_entry_1_1_1_2": 0.04}


def test_entries_are_found_by_the_names_of_degrees_of_freedom():
    stiffness = np.array([[3.0, -1.0], [-1.0, 1.0]])
    table = entries(0.0, ("roof", "x")).of_structure(("x", "roof"), np.eye(2), np.eye(2), stiffness)
    assert table.of_parts(2) == {"stiffness_entry_2_1": 0.04}


@pytest.mark.parametrize(
    ("stiffness", "places", "deviation", "message"),
    [
        ([[3.0, -1.0], [-1.0, 1.0]], ("x", "y"), 0.04, "Name two of x, roof"),
        ([[3.0, 0.0], [0.0, 1.0]], ("x", "roof"), 0.04, "zero in row 1, column 2"),
        ([[1.05, -1.0], [-1.0, 1.0]], ("x", "roof"), 0.04, "standard deviation of an entry is too large"),
    ],
)
def test_entries_are_those_of_a_structure(stiffness, places, deviation, message):
    table = entries(0.0, places, deviation=deviation)
    with pytest.raises(InputError, match=message):
        table.of_structure(("x", "roof"), np.eye(2), np.eye(2), np.array(stiffness))
