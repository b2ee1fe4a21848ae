"""Frames that are scaled, and the damping of parts without mass."""

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
