"""Descriptions of frames: every way of giving the same frame, and rules for those that are no frame."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import frame_of_tables

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
    expected, found = frame_of().partition.frame, frame_of(frame=frame).partition.frame
    for matrix in ("mass", "stiffness", "damping"):
        assert getattr(found, matrix) == pytest.approx(getattr(expected, matrix))


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
    by_mode = frame_of(damping={"ratios": [0.02, 0.05]}).partition.frame
    assert modal_ratios(by_mode)[0] == pytest.approx([0.02, 0.05])
    rayleigh = {"rayleigh_ratios": [0.02, 0.05], "rayleigh_frequencies_hz": frequencies.tolist()}
    assert modal_ratios(frame_of(damping=rayleigh).partition.frame)[0] == pytest.approx([0.02, 0.05])
    matrix = [[0.3, -0.1], [-0.1, 0.1]]
    assert frame_of(damping={"matrix_n_s_per_m": matrix}).partition.frame.damping == pytest.approx(
        np.array(matrix)
    )


def test_a_specimen_beside_the_structure_is_added_to_it():
    inside = frame_of().partition
    beside = frame_of(specimen=SPECIMEN | {"part_of_structure": False}).partition
    added = beside.frame.stiffness - inside.frame.stiffness
    assert added == pytest.approx(120.0 * np.outer(inside.direction, inside.direction))


def test_the_place_of_a_specimen_is_a_floor_a_drift_or_a_direction():
    names = {"names": ["first", "roof"]}
    places = {
        (0.0, 1.0): {"degree_of_freedom": "roof"},
        (-1.0, 1.0): {"degree_of_freedom": "roof", "below": "first"},
        (0.5, 0.5): {"direction": [0.5, 0.5]},
    }
    for expected, place in places.items():
        found = frame_of(frame=FRAME | names, specimen=place | {"stiffness_n_per_m": 90.0})
        assert found.partition.direction == pytest.approx(expected)


def test_a_damping_ratio_of_the_specimen_is_that_of_its_own_oscillator():
    found = frame_of(specimen=SPECIMEN | {"mass_kg": 0.3, "damping_ratio": 0.1}).partition.specimen
    assert found.damping == pytest.approx(2.0 * 0.1 * np.sqrt(120.0 * 0.3))


@pytest.mark.parametrize(
    ("tables", "said"),
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
        ({"frame": {"masses_kg": MASSES, "stiffness_matrix_n_per_m": [[1.0], [1.0, 2.0]]}}, "one length"),
        (
            {"specimen": {"direction": [1.0], "stiffness_n_per_m": 1.0, "part_of_structure": False}},
            "needs 2 numbers",
        ),
        ({"specimen": None}, "specimen"),
        ({"colour": "red"}, "colour is not a known key"),
    ],
)
def test_what_is_no_frame_is_refused_with_its_place(tables, said):
    with pytest.raises(InputError) as refused:
        frame_of(**tables)
    assert said in str(refused.value)
    assert "frame.toml" in str(refused.value)


def test_a_table_that_is_missing_is_named():
    with pytest.raises(InputError, match="damping is missing"):
        frame_of_tables({"frame": FRAME, "specimen": SPECIMEN}, "frame.toml")
