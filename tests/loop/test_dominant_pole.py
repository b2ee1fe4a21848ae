"""The dominant pole against the characteristic equation and Lambert's function."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import lambertw

from reliab.loop.dominant_pole import dominant_pole, modal_loop, transfer
from reliab.loop.stability import critical_delay
from reliab.loop.structure import Structure


@settings(deadline=None)
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
    reduced = loop.residue / (s - loop.pole) + loop.residue.conj() / (s - loop.pole.conj())
    np.testing.assert_allclose(reduced, transfer(structure, np.array([1.02]), np.array([0.0]), s), rtol=1e-10)
    assert loop.quasi_static[0] == 0.0


def test_what_the_pair_leaves_is_about_half_the_squared_delay():
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    loop = modal_loop(structure, np.array([1.0]), np.array([0.002]))
    assert loop.quasi_static[0] == pytest.approx(0.002**2 / 2, rel=0.02)
    assert loop.lag[0] == pytest.approx(0.002 / 3, rel=0.02)
