"""Stability of one mass and of frames."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper
from reliab.simulation.linear_loop.blocks import cut
from reliab.structures.critical_delay import stability_limit
from reliab.structures.partition import Partition
from reliab.structures.structure import Structure, critical_delay, stability_margin

structures = st.builds(
    Structure,
    frequency=st.floats(0.2, 4.0),
    damping_ratio=st.floats(0.005, 0.2),
    experimental_fraction=st.floats(0.5, 1.0),
)


@given(structure=structures, gain=st.floats(0.9, 1.1))
def test_a_root_lies_on_the_imaginary_axis_at_the_critical_delay(structure, gain):
    delay = float(critical_delay(structure, gain))
    w0, xi, alpha = structure.circular_frequency, structure.damping_ratio, structure.experimental_fraction
    omega = np.linspace(0.05, 3.0, 200_001) * w0
    value = (
        -(omega**2) + 2j * xi * w0 * omega + w0**2 * (1 - alpha + alpha * gain * np.exp(-1j * omega * delay))
    )
    assert np.abs(value).min() < 1e-4 * w0**2


def test_limit_without_numerical_stiffness_is_the_printed_formula():
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    gain = np.array([0.9, 1.0, 1.1])
    w0, xi = structure.circular_frequency, 0.05
    omega = w0 * np.sqrt(-2 * xi**2 + np.sqrt(4 * xi**4 + gain**2))
    np.testing.assert_allclose(
        critical_delay(structure, gain), np.arctan2(2 * xi * w0 * omega, omega**2) / omega
    )


def test_enough_damping_and_little_experimental_stiffness_need_no_limit():
    structure = Structure(frequency=1.0, damping_ratio=0.3, experimental_fraction=0.2)
    assert critical_delay(structure) == np.inf
    assert stability_margin(structure, 1.0, 5.0) == 1.0


@pytest.mark.default_cases(10)
@pytest.mark.parametrize("frequency", [0.25, 1.0, 2.0])
@pytest.mark.parametrize("damping_ratio", [0.02, 0.1])
@pytest.mark.parametrize("experimental_fraction", [1.0, 0.6])
@pytest.mark.parametrize("gain", [0.95, 1.0, 1.05])
def test_stepping_engine_decays_below_and_grows_above_the_limit(
    frequency, damping_ratio, experimental_fraction, gain
):
    structure = Structure(
        frequency=frequency, damping_ratio=damping_ratio, experimental_fraction=experimental_fraction
    )
    limit = float(critical_delay(structure, gain))
    pulse = np.zeros(12_001)
    pulse[1] = 1.0
    blocks = cut(Excitation(acceleration=pulse, time_step=0.01 / frequency), structure)

    def growth(delay: float) -> float:
        reading = delay_stepper.response(blocks, structure, gain, delay)[1]
        third = reading.size // 3
        return float(np.abs(reading[2 * third :]).max() / np.abs(reading[third : 2 * third]).max())

    assert growth(0.98 * limit) < 1.0 < growth(1.02 * limit)


def corner_partition(specimen_damping=0.0):
    stiffness = np.array([[3.2e6, -4e5, -1.2e6], [-4e5, 9e5, 2e5], [-1.2e6, 2e5, 1.2e6]])
    mass = np.diag([4000.0, 40.0, 3000.0])
    interface = np.eye(3)[:, :2]
    specimen = np.array([[1.4e6, -3e5], [-3e5, 4e5]])
    damping = 0.9 * mass + 4e-4 * stiffness
    return Partition(
        mass=mass,
        damping=damping,
        stiffness=stiffness,
        interface=interface,
        specimen_stiffness=specimen,
        specimen_damping=specimen_damping * specimen,
        names=("x", "theta"),
    )


def rightmost_root(partition, gains, delay, nodes=24):
    """Rightmost root by Chebyshev collocation of x(t + θ), −τ ≤ θ ≤ 0 (Breda and others 2005)."""
    size = partition.size
    mass, damping, stiffness = partition.mass, partition.damping, partition.stiffness
    gamma = partition.interface
    k, c = (gamma @ m @ gamma.T for m in (partition.specimen_stiffness, partition.specimen_damping))
    kg, cg = (gamma @ m @ gains @ gamma.T for m in (partition.specimen_stiffness, partition.specimen_damping))
    inverse = np.linalg.inv(mass)
    now = np.block(
        [[np.zeros((size, size)), np.eye(size)], [-inverse @ (stiffness - k), -inverse @ (damping - c)]]
    )
    late = np.block([[np.zeros((size, 2 * size))], [-inverse @ kg, -inverse @ cg]])
    places = np.cos(np.pi * np.arange(nodes + 1) / nodes)
    weights = np.where(np.arange(nodes + 1) % nodes == 0, 2.0, 1.0) * (-1.0) ** np.arange(nodes + 1)
    separate = places[:, None] - places + np.eye(nodes + 1)
    differentiation = np.outer(weights, 1.0 / weights) / separate
    differentiation -= np.diag(differentiation.sum(axis=1))
    complete = np.kron(2.0 / delay * differentiation, np.eye(2 * size))
    complete[: 2 * size] = 0.0
    complete[: 2 * size, : 2 * size], complete[: 2 * size, -2 * size :] = now, late
    roots = np.linalg.eigvals(complete)
    return roots[np.argmax(roots.real)]


@pytest.mark.parametrize("specimen_damping", [0.0, 1e-4])
@pytest.mark.parametrize("gains", [np.eye(2), np.array([[0.97, 0.05], [-0.04, 1.02]])])
def test_critical_delay_is_where_a_root_crosses(specimen_damping, gains):
    partition = corner_partition(specimen_damping)
    limit = stability_limit(partition, gains)
    root = rightmost_root(partition, gains, limit.delay)
    assert abs(root.real) < 1e-6 * abs(root)
    assert abs(root.imag) == pytest.approx(2.0 * np.pi * limit.frequency, rel=1e-6)
    assert rightmost_root(partition, gains, 0.98 * limit.delay).real < 0.0
    assert rightmost_root(partition, gains, 1.02 * limit.delay).real > 0.0


def test_one_actuator_has_its_own_critical_delay():
    structure = Structure(frequency=1.3, damping_ratio=0.04, experimental_fraction=0.6)
    partition = Partition.from_structure(structure, 2000.0)
    assert stability_limit(partition).delay == pytest.approx(float(critical_delay(structure)), rel=1e-10)


def test_specimens_with_half_of_the_mass_tolerate_no_delay_whatever_the_number_of_actuators():
    heavy = Partition(
        mass=np.eye(2),
        damping=0.4 * np.eye(2),
        stiffness=40.0 * np.eye(2),
        interface=np.eye(2),
        specimen_stiffness=10.0 * np.eye(2),
        specimen_mass=np.diag([0.1, 0.6]),
    )
    assert stability_limit(heavy).delay == 0.0
    assert rightmost_root(heavy.replace_values(specimen_mass=np.zeros((2, 2))), np.eye(2), 1e-3).real < 0.0


def test_a_specimen_must_be_part_of_the_frame():
    with pytest.raises(InputError, match="must be part of the frame"):
        Partition(
            mass=np.eye(2),
            damping=0.1 * np.eye(2),
            stiffness=np.eye(2),
            interface=np.eye(2),
            specimen_stiffness=2.0 * np.eye(2),
        )


def test_degrees_without_mass_follow_by_statics():
    stiffness = np.array([[3.0, -1.0, -1.0], [-1.0, 2.0, 0.0], [-1.0, 0.0, 1.5]]) * 1e4
    partition = Partition(
        mass=np.diag([10.0, 0.0, 5.0]),
        damping=1e-3 * stiffness,
        stiffness=stiffness,
        interface=np.eye(3)[:, :1],
        specimen_stiffness=np.array([[5e3]]),
    )
    reduction = stiffness[np.ix_([0, 2], [0, 2])] - np.outer(stiffness[[0, 2], 1], stiffness[1, [0, 2]]) / 2e4
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(np.diag([10.0, 5.0]), reduction)).real))
    np.testing.assert_allclose(2.0 * np.pi * partition.natural_frequencies, expected, rtol=1e-10)
