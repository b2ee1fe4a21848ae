"""Actuators pinned to a body in a plane: exact extensions, their inverse, and what is refused."""

from typing import Any

import numpy as np
import pytest
from reliab_studies.marths_benchmark.structure import ANGLE, ARM, to_node

from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import frame_of_tables
from reliab.simulation.frames.transfer_table import PlanarGeometry

BENCHMARK: dict[str, Any] = {
    "motions": ("x", "rotation"),
    "pins": ARM * np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.cos(ANGLE), np.sin(ANGLE)]]),
    "directions": np.array([[1.0, 0.0], [1.0, 0.0]]),
}
PLATE: dict[str, Any] = {
    "motions": ("x", "y", "rotation"),
    "pins": np.array([[0.5, 0.3], [-0.5, 0.3], [0.5, -0.4]]),
    "directions": np.array([[1.0, 0.2], [0.0, 1.0], [0.6, 0.8]]),
    "lengths": np.array([1.5, 2.0, 0.9]),
}


def wandering(motions, size):
    return size * np.random.default_rng(4).uniform(-1.0, 1.0, (motions, 40))


def test_the_benchmark_has_its_printed_inverse():
    geometry, displacement = PlanarGeometry(**BENCHMARK), wandering(2, 0.2)
    np.testing.assert_allclose(to_node(1e3 * geometry.extensions(displacement)), displacement, atol=1e-12)


def test_extensions_are_changes_of_the_distance_between_pins():
    geometry, displacement = PlanarGeometry(**PLATE), wandering(3, 0.2)
    unit = PLATE["directions"] / np.linalg.norm(PLATE["directions"], axis=1)[:, np.newaxis]
    ground = PLATE["pins"] - PLATE["lengths"][:, np.newaxis] * unit
    for (x, y, angle), result in zip(displacement.T, geometry.extensions(displacement).T, strict=True):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        distance = np.linalg.norm(np.array([x, y]) + PLATE["pins"] @ turn.T - ground, axis=1)
        np.testing.assert_allclose(result, distance - PLATE["lengths"], atol=1e-14)


@pytest.mark.parametrize("description", [BENCHMARK, PLATE])
def test_motions_follow_from_extensions_and_small_ones_by_the_matrix(description):
    geometry = PlanarGeometry(**description)
    displacement, little = (
        wandering(len(description["motions"]), 0.2),
        wandering(len(description["motions"]), 1e-7),
    )
    np.testing.assert_allclose(
        geometry.displacements(geometry.extensions(displacement)), displacement, atol=1e-12
    )
    np.testing.assert_allclose(
        geometry.as_small(geometry.extensions(displacement)), geometry.matrix @ displacement, atol=1e-12
    )
    np.testing.assert_allclose(geometry.extensions(little), geometry.matrix @ little, atol=1e-12)


@pytest.mark.parametrize(
    ("variant", "rule"),
    [
        ({"motions": ("x", "x")}, "each once"),
        ({"pins": np.ones((3, 2))}, "one for each motion"),
        ({"directions": np.zeros((2, 2))}, "directions not zero"),
        ({"lengths": np.array([1.0, -1.0])}, "lengths positive"),
    ],
)
def test_impossible_geometries_are_refused(variant, rule):
    with pytest.raises(InputError, match=rule):
        PlanarGeometry(**BENCHMARK | variant)


def test_impossible_extensions_are_refused():
    with pytest.raises(InputError, match="cannot reach these extensions"):
        PlanarGeometry(**BENCHMARK).displacements(np.array([[1.0], [-1.0]]))


TABLES = {
    "frame": {
        "mass_matrix_kg": [[9.0, 0.0], [0.0, 2.0]],
        "stiffness_matrix_n_per_m": [[9e3, 0.0], [0.0, 5e3]],
    },
    "damping": {"ratio": 0.05},
    "specimen": {
        "degrees_of_freedom": ["1", "2"],
        "stiffness_matrix_n_per_m": [[4e3, 0.0], [0.0, 2e3]],
    },
}


def frame_of(**kinematics):
    return frame_of_tables(TABLES | {"kinematics": kinematics}, "frame.toml")


def test_a_file_describes_pins_and_directions():
    description = {"motions": ["x", "rotation"], "pins_m": [[1, -2], [1, 2]], "directions": [[1, 0], [1, 0]]}
    frame = frame_of(geometry=description)
    np.testing.assert_allclose(frame.kinematics, [[1.0, 2.0], [1.0, -2.0]])
    displacement = np.array([[0.1], [0.3]])
    extension = frame.geometry.extensions(displacement)
    np.testing.assert_allclose(frame.to_interface @ frame.straighten(extension), displacement)
    is_interface = frame_of(geometry=description, channels="interface")
    assert is_interface.straighten(extension) is extension


@pytest.mark.parametrize(
    ("kinematics", "rule"),
    [
        ({}, "give matrix or geometry"),
        (
            {"geometry": {"motions": ["x", "y"], "pins_m": [[1, 2], [1, 2]], "directions": [[1, 0], [1, 0]]}},
            "must not be singular",
        ),
        ({"matrix": [[1.0], [2.0]]}, "need 2 columns"),
    ],
)
def test_kinematics_driving_nothing_are_refused(kinematics, rule):
    with pytest.raises(InputError, match=rule):
        frame_of(**kinematics)


def test_unreachable_extensions_are_refused():
    """A pin at the node, which a rotation does not move."""
    geometry = PlanarGeometry(motions=("rotation",), pins=[[0.0, 0.0]], directions=[[1.0, 0.0]])
    with pytest.raises(InputError, match="cannot reach"):
        geometry.displacements(np.array([[0.1]]))
