"""A structure that is reduced keeps its slow modes and its statics; what has no mass follows."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from reliab.simulation.frames.frame_tables import DampingTable
from reliab.structures.frame import modal_damping, rayleigh_damping
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame


def tall(stories=60):
    """A frame of many stories, of which the third and the fortieth are driven."""
    mass, stiffness = shear_frame(np.linspace(3e3, 2e3, stories).tolist(), [4e7] * stories)
    interface = np.zeros((stories, 2))
    interface[2, 0] = interface[39, 1] = 1.0
    return Partition(
        mass=mass,
        damping=modal_damping(mass, stiffness, 0.03),
        stiffness=stiffness,
        interface=interface,
        specimen_stiffness=np.array([[3e5, 0.0], [0.0, 2e5]]),
    )


def test_modes_below_a_frequency_and_statics_at_the_interface_are_kept():
    complete = tall()
    highest = 0.5 * (complete.natural_frequencies[6] + complete.natural_frequencies[7])
    smaller = complete.reduce_to_modes(7)
    assert 7 + 2 < smaller.size <= 7 + 2 * 2  # a static shape may nearly be one of the modes
    np.testing.assert_allclose(smaller.mass, np.eye(smaller.size), atol=1e-5)
    np.testing.assert_allclose(smaller.natural_frequencies[:7], complete.natural_frequencies[:7], rtol=1e-8)
    assert smaller.natural_frequencies[7] > highest
    np.testing.assert_allclose(smaller.static_transfer, complete.static_transfer, rtol=1e-7)
    for result, mode in zip(smaller.modes, complete.modes, strict=True):
        np.testing.assert_allclose(np.abs(result[..., :7]), np.abs(mode[..., :7]), rtol=1e-5, atol=1e-9)
    inertia = complete.mass @ np.linalg.solve(complete.stiffness, complete.interface)
    first = np.linalg.solve(complete.stiffness, complete.interface).T @ inertia
    reduction = np.linalg.solve(smaller.stiffness, smaller.interface)
    np.testing.assert_allclose(reduction.T @ smaller.mass @ reduction, first, rtol=1e-6)


def test_small_structure_is_not_reduced():
    small, complete = tall(41), tall()
    assert complete.reduce_to_modes(complete.size) is complete
    three_floors = Partition(
        mass=np.diag([4.0, 3.0, 2.0]),
        damping=0.1 * np.eye(3),
        stiffness=np.diag([90.0, 80.0, 70.0]),
        interface=np.eye(3)[:, :2],
        specimen_stiffness=np.eye(2),
    )
    assert three_floors.reduce_to_modes(0) is three_floors
    assert small.reduce_to_modes(2).size == 2 + 4


def test_a_structure_scaled_has_frequencies_damping_and_specimen_of_its_own():
    complete = replace(tall(5 + 40), specimen_damping=np.eye(2) * 7.0, specimen_mass=np.eye(2) * 30.0)
    variant = complete.scale(frequency=1.3, damping_ratio=0.7, share=0.6)
    f, xi, shapes = complete.modes
    new_f, new_xi, new_shapes = variant.modes
    np.testing.assert_allclose(new_f, 1.3 * f, rtol=1e-9)
    np.testing.assert_allclose(new_xi, 0.7 * xi, rtol=1e-9)
    np.testing.assert_allclose(np.abs(new_shapes), np.abs(shapes), atol=1e-9)
    s = 2.0j
    expected = 0.6 * (
        1.3**2 * complete.specimen_stiffness
        + s * (1.3 * complete.specimen_damping + s * complete.specimen_mass)
    )
    np.testing.assert_allclose(variant.impedance(s), expected)


MASS = np.diag([3.0, 0.0, 2.0])
STIFFNESS = np.array([[500.0, -200.0, 0.0], [-200.0, 450.0, -250.0], [0.0, -250.0, 250.0]])


def massless_frame():
    """Mass and stiffness of the first and third degree of freedom, which the second follows."""
    shapes = np.array([[1.0, 0.0], [200.0 / 450.0, 250.0 / 450.0], [0.0, 1.0]])
    return shapes, shapes.T @ MASS @ shapes, shapes.T @ STIFFNESS @ shapes


def test_modal_damping_leaves_massless_parts_undamped():
    _, mass, stiffness = massless_frame()
    result = DampingTable(ratios=(0.02, 0.05)).matrix(MASS, STIFFNESS)
    np.testing.assert_allclose(result[np.ix_([0, 2], [0, 2])], modal_damping(mass, stiffness, (0.02, 0.05)))
    assert not result[1].any()
    assert not result[:, 1].any()


def test_rayleigh_damping_of_massless_parts_follows_stiffness():
    shapes, mass, stiffness = massless_frame()
    frequencies = tuple(np.sqrt(scipy.linalg.eigh(stiffness, mass, eigvals_only=True)) / (2.0 * np.pi))
    result = DampingTable(rayleigh_ratios=(0.03, 0.04), rayleigh_frequencies_hz=frequencies).matrix(
        MASS, STIFFNESS
    )
    reduction = rayleigh_damping(mass, stiffness, (0.03, 0.04), frequencies)
    np.testing.assert_allclose(shapes.T @ result @ shapes, reduction, rtol=1e-9)
    assert result[1, 1] > 0.0


@pytest.mark.parametrize("mass", [MASS, np.diag([3.0, 1.0, 2.0])])
def test_a_stated_damping_matrix_is_taken_as_it_is(mass):
    rows = ((5.0, -1.0, 0.0), (-1.0, 4.0, -2.0), (0.0, -2.0, 3.0))
    np.testing.assert_array_equal(DampingTable(matrix_n_s_per_m=rows).matrix(mass, STIFFNESS), rows)
    complete = np.diag([3.0, 1.0, 2.0])
    np.testing.assert_allclose(
        DampingTable(ratio=0.02).matrix(complete, STIFFNESS), modal_damping(complete, STIFFNESS, 0.02)
    )
