"""Tables that describe a frame."""

import numpy as np
import pytest
from pydantic import ValidationError

from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import frame_of_tables
from reliab.simulation.frames.tolerances_table import TolerancesTable

MASSES, STOREYS = [3.0, 2.0], [500.0, 400.0]
STIFFNESS = [[900.0, -400.0], [-400.0, 400.0]]
FRAME = {"masses_kg": MASSES, "storey_stiffnesses_n_per_m": STOREYS}
SPECIMEN = {"degree_of_freedom": 1, "stiffness_n_per_m": 120.0}


def frame_of(**tables):
    content = {"frame": FRAME, "damping": {"ratio": 0.03}, "specimen": SPECIMEN} | tables
    return frame_of_tables(content, "frame.toml")


@pytest.mark.parametrize(
    "frame",
    [
        {"mass_matrix_kg": [[3.0, 0.0], [0.0, 2.0]], "storey_stiffnesses_n_per_m": STOREYS},
        {"mass_matrix_kg": [[3.0, 0.0], [0.0, 2.0]], "stiffness_matrix_n_per_m": STIFFNESS},
        {"masses_kg": MASSES, "stiffness_matrix_n_per_m": STIFFNESS},
    ],
)
def test_a_frame_may_be_given_as_storeys_or_matrices(frame):
    expected, result = frame_of().partition.frame, frame_of(frame=frame).partition.frame
    for matrix in ("mass", "stiffness", "damping"):
        assert getattr(result, matrix) == pytest.approx(getattr(expected, matrix))


def modal_ratios(frame):
    """Damping ratios and frequencies [Hz] of the modes of a classically damped frame."""
    squares, shapes = np.linalg.eigh(
        np.linalg.inv(np.sqrt(frame.mass)) @ frame.stiffness @ np.linalg.inv(np.sqrt(frame.mass))
    )
    shapes = np.linalg.inv(np.sqrt(frame.mass)) @ shapes
    w = np.sqrt(squares)
    return np.diag(shapes.T @ frame.damping @ shapes) / (2.0 * w), w / (2.0 * np.pi)


def test_damping_is_given_by_one_ratio_by_mode_by_rayleigh_or_as_a_matrix():
    frame = frame_of().partition.frame
    ratios, frequencies = modal_ratios(frame)
    assert ratios == pytest.approx([0.03, 0.03])
    modal_values = frame_of(damping={"ratios": [0.02, 0.05]}).partition.frame
    assert modal_ratios(modal_values)[0] == pytest.approx([0.02, 0.05])
    rayleigh = {"rayleigh_ratios": [0.02, 0.05], "rayleigh_frequencies_hz": frequencies.tolist()}
    assert modal_ratios(frame_of(damping=rayleigh).partition.frame)[0] == pytest.approx([0.02, 0.05])
    matrix = [[0.3, -0.1], [-0.1, 0.1]]
    assert frame_of(damping={"matrix_n_s_per_m": matrix}).partition.frame.damping == pytest.approx(
        np.array(matrix)
    )


def test_a_specimen_beside_the_structure_is_added_to_it():
    is_inside = frame_of().partition
    neighbour = frame_of(specimen=SPECIMEN | {"part_of_structure": False}).partition
    increment = neighbour.frame.stiffness - is_inside.frame.stiffness
    assert increment == pytest.approx(120.0 * np.outer(is_inside.direction, is_inside.direction))


def test_the_place_of_a_specimen_is_a_floor_a_drift_or_a_direction():
    names = {"names": ["first", "roof"]}
    places = {
        (0.0, 1.0): {"degree_of_freedom": "roof"},
        (-1.0, 1.0): {"degree_of_freedom": "roof", "below": "first"},
        (0.5, 0.5): {"direction": [0.5, 0.5]},
    }
    for expected, place in places.items():
        result = frame_of(frame=FRAME | names, specimen=place | {"stiffness_n_per_m": 90.0})
        assert result.partition.direction == pytest.approx(expected)


def test_specimen_damping_ratio_is_of_its_own_oscillator():
    result = frame_of(specimen=SPECIMEN | {"mass_kg": 0.3, "damping_ratio": 0.1}).partition.specimen
    assert result.damping == pytest.approx(2.0 * 0.1 * np.sqrt(120.0 * 0.3))


@pytest.mark.parametrize(
    ("tables", "messages"),
    [
        ({"frame": {"storey_stiffnesses_n_per_m": STOREYS}}, "give masses_kg or mass_matrix_kg"),
        ({"frame": {"masses_kg": MASSES}}, "stiffness_matrix_n_per_m or the table planar"),
        ({"damping": {}}, "one of ratio, ratios"),
        ({"damping": {"ratio": 0.1, "ratios": [0.1, 0.1]}}, "one of ratio, ratios"),
        ({"damping": {"rayleigh_ratios": [0.1, 0.1]}}, "belong together"),
        ({"specimen": {"stiffness_n_per_m": 1.0}}, "degree_of_freedom or direction"),
        (
            {"specimen": {"directions": [[1.0, 0.0]], "mass_kg": 1.0}},
            "several driven degrees of freedom takes no mass_kg",
        ),
        ({"specimen": {"directions": [[1.0, 0.0]]}}, "need stiffness_matrix_n_per_m"),
        ({"specimen": SPECIMEN | {"names": ["x"]}}, "one driven degree of freedom takes no names"),
        ({"specimen": {"direction": [1.0, 0.0], "below": 0}}, "below needs degree_of_freedom"),
        ({"specimen": SPECIMEN | {"damping_ratio": 0.1, "damping_n_s_per_m": 1.0}}, "or damping_ratio"),
        ({"error": {"of": "drift"}}, 'between belongs to of = "drift"'),
        ({"error": {"of": "roof", "between": ["roof", "first"]}}, 'between belongs to of = "drift"'),
        (
            {"frame": {"masses_kg": MASSES, "stiffness_matrix_n_per_m": [[1.0], [1.0, 2.0]]}},
            "different lengths",
        ),
        (
            {"specimen": {"direction": [1.0], "stiffness_n_per_m": 1.0, "part_of_structure": False}},
            "needs 2 numbers",
        ),
        ({"specimen": None}, "specimen"),
        ({"colour": "red"}, "colour is not a known key"),
    ],
)
def test_invalid_frame_is_refused_with_its_place(tables, messages):
    with pytest.raises(InputError) as refusal:
        frame_of(**tables)
    assert messages in str(refusal.value)
    assert "frame.toml" in str(refusal.value)


def test_missing_table_is_named():
    with pytest.raises(InputError, match="damping is missing"):
        frame_of_tables({"frame": FRAME, "specimen": SPECIMEN}, "frame.toml")


def test_one_number_stands_for_each_storey_by_itself():
    assert TolerancesTable(storey_stiffnesses=0.05).part_deviations(2) == {
        "storey_stiffness_1": 0.05,
        "storey_stiffness_2": 0.05,
    }


def test_a_correlation_divides_a_deviation_between_all_and_each():
    parts = TolerancesTable(floor_masses=0.06, storey_correlation=0.25).part_deviations(3)
    assert parts["floor_mass"] == pytest.approx(0.03)
    assert np.hypot(parts["floor_mass"], parts["floor_mass_2"]) == pytest.approx(0.06)
    assert TolerancesTable(floor_masses=0.06, storey_correlation=1.0).part_deviations(3) == {
        "floor_mass": 0.06
    }


def test_specimen_changing_the_structure_is_part_of_it():
    neighbour = TolerancesTable(specimen_stiffness=0.04)
    motion_variance = TolerancesTable(specimen_stiffness=0.04, specimen_changes_structure=True)
    assert (neighbour.specimen_deviation, neighbour.part_deviations(2)) == (0.04, {})
    assert (motion_variance.specimen_deviation, motion_variance.part_deviations(2)) == (
        0.0,
        {"specimen_stiffness": 0.04},
    )


def test_numbers_for_each_are_as_many_as_there_are_modes():
    table = TolerancesTable(mode_frequencies=(0.01, 0.02))
    assert table.part_deviations(2) == {"mode_frequency_1": 0.01, "mode_frequency_2": 0.02}
    with pytest.raises(InputError, match="2 of mode frequency"):
        table.part_deviations(3)


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
def test_contradictory_tolerances_are_refused(keys, message):
    with pytest.raises(ValidationError, match=message):
        TolerancesTable(**keys)


def entries(correlation, *places, deviation=0.04):
    table = {"matrix": "stiffness", "places": places, "deviation": deviation, "correlation": correlation}
    return TolerancesTable(entries=[table])


def test_entries_are_named_by_place_and_share_correlation():
    assert entries(0.0, ("2", "1")).part_deviations(2) == {"stiffness_entry_2_1": 0.04}
    parts = entries(0.25, ("1", "1"), ("1", "2")).part_deviations(2)
    assert parts["stiffness_entry_1_1_1_2"] == pytest.approx(0.02)
    assert np.hypot(0.02, parts["stiffness_entry_1_2"]) == pytest.approx(0.04)
    assert entries(1.0, ("1", "1"), ("1", "2")).part_deviations(2) == {"stiffness_entry_1_1_1_2": 0.04}


def test_entries_are_found_by_the_names_of_degrees_of_freedom():
    stiffness = np.array([[3.0, -1.0], [-1.0, 1.0]])
    table = entries(0.0, ("roof", "x")).check_structure(("x", "roof"), np.eye(2), np.eye(2), stiffness)
    assert table.part_deviations(2) == {"stiffness_entry_2_1": 0.04}


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
        table.check_structure(("x", "roof"), np.eye(2), np.eye(2), np.array(stiffness))
