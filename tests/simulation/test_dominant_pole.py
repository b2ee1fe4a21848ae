"""The dominant pole against the characteristic equation and Lambert's function."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.special import lambertw

from reliab.simulation.linear_loop.pole_recursion import dominant_pole, modal_loop, transfer
from reliab.structures.structure import Structure, critical_delay


@given(
    frequency=st.floats(0.2, 4.0),
    damping_ratio=st.floats(0.005, 0.15),
    fraction=st.floats(0.3, 1.0),
    gain=st.floats(0.8, 1.2),
    share=st.floats(0.0, 2.0),
)
def test_pole_solves_the_characteristic_equation(frequency, damping_ratio, fraction, gain, share):
    structure = Structure(frequency=frequency, damping_ratio=damping_ratio, experimental_fraction=fraction)
    delay = min(share * float(critical_delay(structure, gain)), 0.05 / frequency)
    pole = dominant_pole(structure, np.array([gain]), np.array([delay]))
    w0 = structure.circular_frequency
    value = (
        pole**2
        + 2 * damping_ratio * w0 * pole
        + w0**2 * (1 - fraction + fraction * gain * np.exp(-pole * delay))
    )
    assert abs(value[0]) < 1e-10 * w0**2


def test_almost_undamped_pole_is_lamberts():
    structure = Structure(frequency=1.0, damping_ratio=1e-12)
    w0, delay = structure.circular_frequency, np.array([0.001, 0.01, 0.03])
    expected = 2.0 / delay * lambertw(0.5j * delay * w0)
    np.testing.assert_allclose(dominant_pole(structure, np.ones(3), delay), expected, rtol=1e-9)


def test_pole_crosses_the_axis_at_the_critical_delay():
    structure = Structure(frequency=1.3, damping_ratio=0.03)
    gain = np.linspace(0.9, 1.1, 5)
    pole = dominant_pole(structure, gain, critical_delay(structure, gain))
    assert np.abs(pole.real).max() < 1e-12 * structure.circular_frequency


def test_without_delay_the_pair_is_the_whole_loop():
    structure = Structure(frequency=1.0, damping_ratio=0.05)
    loop = modal_loop(structure, np.array([1.02]), np.array([0.0]))
    s = 1j * np.array([0.0, 1.0, 6.0, 30.0])
    exact = transfer(structure, np.array([1.02]), np.array([0.0]), s)
    np.testing.assert_allclose(loop.transfer(s), exact, rtol=1e-10)
    assert not loop.fast_residues.any()


@pytest.mark.parametrize("delay", [1e-5, 0.001, 0.0031, 0.0033, 0.01])
def test_two_pole_pairs_represent_the_loop(delay):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    loop = modal_loop(structure, np.array([1.01]), np.array([delay]))
    s = 2j * np.pi * np.array([0.1, 0.5, 1.0, 2.0, 5.0, 10.0])
    exact = transfer(structure, np.array([1.01]), np.array([delay]), s)
    assert (np.abs(loop.transfer(s) - exact) < 2e-7 + 1e-3 * np.abs(exact)).all()
    assert abs(loop.transfer(s)[2] / exact[2] - 1) < 1e-8


def test_fast_pair_of_a_vanishing_delay_averages_the_record_over_it():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    loop = modal_loop(structure, np.array([1.0]), np.array([0.001]))
    static = -(loop.fast_residues / loop.fast_poles).sum(axis=0).real
    assert static[0] == pytest.approx(0.001**2 / 2, rel=0.01)
