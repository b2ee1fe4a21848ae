"""Tests of structures whose floors, storeys or modes are not as stated."""

import numpy as np
import pytest

from reliab.structures.frame import modal_damping
from reliab.structures.partition import Partition
from reliab.structures.parts_of_structure import change_matrices, is_part, part_and_number
from reliab.structures.planar_frame import shear_frame

MASSES, STOREYS, RATIOS = [1200.0, 1000.0, 700.0], [9e5, 7e5, 5e5], [0.02, 0.03, 0.05]
MASS, STIFFNESS = (np.asarray(matrix) for matrix in shear_frame(MASSES, STOREYS))
DAMPING = np.asarray(modal_damping(MASS, STIFFNESS, RATIOS))


def modes_of(mass, damping, stiffness):
    """Frequencies [rad/s], damping ratios and shapes, each shape with its largest number positive and one."""
    squares, shapes = np.linalg.eig(np.linalg.solve(mass, stiffness))
    order = np.argsort(squares)
    shapes = (
        shapes[:, order]
        / np.take_along_axis(shapes, np.abs(shapes).argmax(axis=0)[np.newaxis], axis=0)[:, order]
    )
    omega = np.sqrt(squares[order])
    modal = np.diag(shapes.T @ mass @ shapes)
    return omega, np.diag(shapes.T @ damping @ shapes) / (2.0 * omega * modal), shapes


@pytest.mark.default_cases(3)
@pytest.mark.parametrize(
    ("changes", "matrix", "reference"),
    [
        (
            {"storey_stiffness_2": 0.1, "storey_stiffness_3": -0.2},
            2,
            shear_frame(MASSES, [9e5, 7.7e5, 4e5])[1],
        ),
        ({"storey_stiffness": 0.1}, 2, 1.1 * STIFFNESS),
        ({"floor_mass_1": 0.25}, 0, np.diag([1500.0, 1000.0, 700.0])),
    ],
    ids=["single storeys", "all storeys", "floor"],
)
def test_storeys_and_floors_of_a_shear_frame_are_changed(changes, matrix, reference):
    variant = change_matrices(MASS, DAMPING, STIFFNESS, changes)[matrix]
    np.testing.assert_allclose(variant, reference, rtol=1e-12)


def test_a_dashpot_of_a_storey_is_stronger():
    dashpots = shear_frame(MASSES, [900.0, 700.0, 500.0])[1]
    variant = change_matrices(MASS, dashpots, STIFFNESS, {"storey_damping_1": 0.5, "damping": 0.1})[1]
    np.testing.assert_allclose(variant, 1.1 * shear_frame(MASSES, [1350.0, 700.0, 500.0])[1], rtol=1e-12)


def test_damping_without_storeys_stays_dissipative():
    changes = {"storey_damping_1": 0.9, "storey_damping_2": -0.9}
    assert np.linalg.eigvalsh(change_matrices(MASS, DAMPING, STIFFNESS, changes)[1]).min() > 0.0


def test_modes_have_other_frequencies_and_ratios_and_the_same_shapes():
    changes = {"mode_frequency_1": 0.05, "mode_damping_ratio_3": 0.4, "mode_damping_ratio_1": -0.1}
    omega, ratios, shapes = modes_of(MASS, DAMPING, STIFFNESS)
    result = modes_of(*change_matrices(MASS, DAMPING, STIFFNESS, changes))
    np.testing.assert_allclose(result[0], omega * [1.05, 1.0, 1.0], rtol=1e-10)
    np.testing.assert_allclose(result[1], ratios * [0.9, 1.0, 1.4], rtol=1e-10)
    np.testing.assert_allclose(np.abs(result[2]), np.abs(shapes), atol=1e-8)


def test_unnamed_parts_stay():
    for first, second in zip(
        (MASS, DAMPING, STIFFNESS), change_matrices(MASS, DAMPING, STIFFNESS, {}), strict=True
    ):
        assert second is first or (second == first).all()


def test_stronger_specimen_leaves_numerical_part():
    interface = np.array([-1.0, 1.0, 0.0])
    complete = Partition(
        mass=MASS,
        damping=DAMPING,
        stiffness=STIFFNESS,
        interface=interface,
        specimen_stiffness=3e5,
        specimen_damping=20.0,
        specimen_mass=10.0,
    )
    variant = complete.change_parts({"specimen_stiffness": 0.2})
    grid = np.outer(interface, interface)
    assert variant.specimen_stiffness == pytest.approx(3.6e5)
    for name in ("mass", "damping", "stiffness"):
        numerical_part = [
            getattr(single, name) - getattr(single, f"specimen_{name}")[0, 0] * grid
            for single in (complete, variant)
        ]
        np.testing.assert_allclose(*numerical_part, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("floor_mass_10", ("floor_mass", "10")),
        ("floor_mass_1_2", None),
        ("floor_mass", None),
        ("time_shift_1", None),
        ("sensor_scale", None),
    ],
)
def test_names_of_parts(name, expected):
    assert part_and_number(name) == expected
    assert is_part(name) == (name in {"floor_mass_10", "floor_mass"})


def test_entries_are_off_with_those_opposite_to_them():
    variant = change_matrices(MASS, DAMPING, STIFFNESS, {"stiffness_entry_1_2_3_3": 0.01})[2] - STIFFNESS
    expected = np.zeros((3, 3))
    expected[0, 1] = expected[1, 0] = 0.01 * STIFFNESS[0, 1]
    expected[2, 2] = 0.01 * STIFFNESS[2, 2]
    np.testing.assert_allclose(variant, expected, atol=1e-9)


def test_entries_leave_a_structure():
    stiffness = np.array([[1.05, -1.0], [-1.0, 1.0]])
    variant = change_matrices(np.eye(2), np.zeros((2, 2)), stiffness, {"stiffness_entry_1_2": 0.2})[2]
    assert 0.0 < np.linalg.eigvalsh(variant)[0] < np.linalg.eigvalsh(stiffness)[0]
