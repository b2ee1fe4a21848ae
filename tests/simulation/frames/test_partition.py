"""Partitions: shares, what is left to the computer, and what is refused."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.simulation.frames.frame_file import frame_of_tables, read_frame
from reliab.structures.frame import (
    Frame,
    Specimen,
    add_specimen,
    drift_interface,
    floor_interface,
    modal_damping,
)
from reliab.structures.partition import Partition
from reliab.structures.planar_frame import shear_frame


@pytest.fixture
def frame():
    mass, stiffness = shear_frame([1000.0, 1000.0], [2e6, 1e6])
    return Frame(mass=mass, stiffness=stiffness, damping=modal_damping(mass, stiffness, 0.02))


def test_benchmark_shares(benchmark_partition):
    np.testing.assert_allclose(benchmark_partition(1).stiffness_shares, [0.3079, 0.0591, 0.0076], atol=5e-5)


def test_shares_of_a_whole_storey_sum_to_the_energy_in_it(frame):
    interface = drift_interface(frame, 2, 1)
    partition = Partition.from_frame(frame=frame, interface=interface, specimen=Specimen(stiffness=1e6))
    shapes = frame.modes.shapes
    energy = 1e6 * (shapes[1] - shapes[0]) ** 2 / frame.modes.circular_frequency**2
    np.testing.assert_allclose(partition.stiffness_shares, energy)
    np.testing.assert_allclose(partition.numerical_stiffness, np.diag([2e6, 0.0]), atol=1e-6)


def test_shares_in_every_matrix_are_by_their_definition(frame):
    specimen = Specimen(stiffness=1e5, damping=300.0, mass=50.0)
    partition = Partition.from_frame(frame=frame, interface=floor_interface(frame, 1), specimen=specimen)
    shapes, omega = frame.modes.shapes, frame.modes.circular_frequency
    assert (np.abs(omega - 1.0) > 10.0).all()
    modal = (shapes.T @ frame.damping @ shapes).diagonal()
    np.testing.assert_allclose(partition.stiffness_shares, 1e5 * shapes[0] ** 2 / omega**2)
    input_motion, ratios = partition.impedance_shares, frame.damping_ratios
    np.testing.assert_allclose(input_motion.imag / (2.0 * ratios), 300.0 * shapes[0] ** 2 / modal)
    np.testing.assert_allclose(partition.stiffness_shares - input_motion.real, 50.0 * shapes[0] ** 2)


def test_adding_a_specimen_and_taking_it_out_again_is_the_bare_frame(frame):
    interface = floor_interface(frame, 1)
    specimen = Specimen(stiffness=1e5, damping=300.0, mass=50.0)
    complete = add_specimen(frame, interface, specimen)
    partition = Partition.from_frame(frame=complete, interface=interface, specimen=specimen)
    np.testing.assert_allclose(partition.numerical_mass, frame.mass)
    np.testing.assert_allclose(partition.numerical_damping, frame.damping)


@pytest.mark.parametrize(
    ("specimen", "sentence"),
    [
        (Specimen(stiffness=1e5, mass=1000.0), "mass must be smaller than the mass that moves"),
        (Specimen(stiffness=3e6), "must not have a negative stiffness"),
        (Specimen(stiffness=1e5, damping=1e6), "must not have a negative damping"),
        (Specimen(stiffness=0.0), "neither stiffness nor damping nor mass"),
    ],
)
def test_specimen_larger_than_the_structure_is_refused(frame, specimen, sentence):
    with pytest.raises(InputError, match=sentence):
        Partition.from_frame(frame=frame, interface=floor_interface(frame, 1), specimen=specimen)


@pytest.mark.parametrize(
    "specimen",
    [
        Specimen(stiffness=0.0, mass=10.0),
        Specimen(stiffness=0.0, damping=10.0),
        Specimen(stiffness=10.0, damping=10.0),
        Specimen(stiffness=0.0, damping=-10.0, mass=10.0),
    ],
)
def test_any_one_property_makes_a_specimen(frame, specimen):
    assert Partition.from_frame(frame=frame, interface=floor_interface(frame, 1), specimen=specimen)


def test_unfitting_interfaces_are_refused(frame):
    for interface in ([1.0], [0.0, 0.0], [np.nan, 1.0]):
        with pytest.raises(InputError, match="interface needs 2 finite numbers"):
            Partition.from_frame(frame=frame, interface=interface, specimen=Specimen(stiffness=1.0))
    with pytest.raises(InputError, match="two different degrees of freedom"):
        drift_interface(frame, 1, 1)


SOUND = {
    "frame": {"masses_kg": [1000.0, 1000.0], "storey_stiffnesses_n_per_m": [2e6, 1e6]},
    "damping": {"ratio": 0.02},
    "specimen": {"degree_of_freedom": 1, "stiffness_n_per_m": 5e5},
}


def test_a_file_describes_the_benchmark(pytestconfig, benchmark_partition):
    read = read_frame(pytestconfig.rootpath / "datasets/frames/benchmark_case_1.toml")
    partition = benchmark_partition(1)
    np.testing.assert_allclose(read.partition.frame.stiffness, partition.frame.stiffness, rtol=1e-6)
    np.testing.assert_allclose(read.partition.numerical_damping, partition.numerical_damping, rtol=1e-6)
    assert read.output is None


def test_a_file_with_matrices_is_the_same_as_one_with_storeys():
    frame = frame_of_tables(SOUND, "").partition.frame
    matrices = SOUND | {
        "frame": {
            "mass_matrix_kg": frame.mass.tolist(),
            "stiffness_matrix_n_per_m": frame.stiffness.tolist(),
        },
        "damping": {"matrix_n_s_per_m": frame.damping.tolist()},
        "error": {"of": "drift", "between": ["2", "1"]},
    }
    read = frame_of_tables(matrices, "")
    np.testing.assert_allclose(read.partition.frame.poles, frame.poles)
    np.testing.assert_allclose(read.output, [-1.0, 1.0])


@pytest.mark.parametrize(
    ("table", "variant", "sentence"),
    [
        ("frame", {"masses": [1.0]}, "frame.masses is not a known key"),
        ("frame", {"mass_matrix_kg": [[1.0]]}, "give masses_kg or mass_matrix_kg"),
        ("damping", {"ratios": [0.1, 0.1]}, "give one of ratio"),
        ("specimen", {"degree_of_freedom": "9"}, "Name one of 1, 2"),
        ("specimen", {"stiffness_n_per_m": -1.0}, "specimen.stiffness_n_per_m"),
        ("specimen", {"mass_kg": 5000.0}, "mass must be smaller"),
        ("specimen", {"effects": [{"name": "rust"}]}, "Unknown effect; found rust"),
        ("specimen", {"effects": [{"name": "coulomb_friction", "force": 1.0}]}, "parameters of coulomb"),
        ("specimen", {"effects": [{"name": "coulomb_friction"}]}, "needs its parameters"),
    ],
)
def test_bad_files_are_refused_with_their_place(table, variant, sentence):
    content = SOUND | {table: SOUND[table] | variant}
    with pytest.raises(InputError, match=sentence) as refusal:
        frame_of_tables(content, "frame.toml")
    assert refusal.value.where == "frame.toml"
