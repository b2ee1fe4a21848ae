"""The exact stability limit."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop import delay_stepper
from reliab.simulation.linear_loop.blocks import cut
from reliab.structures.stability import critical_delay, stability_margin
from reliab.structures.structure import Structure

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
        measured = delay_stepper.response(blocks, structure, gain, delay)[1]
        third = measured.size // 3
        return float(np.abs(measured[2 * third :]).max() / np.abs(measured[third : 2 * third]).max())

    assert growth(0.98 * limit) < 1.0 < growth(1.02 * limit)
