"""The closed form of a and b against root-finding on the simulated loop."""

import numpy as np
import pytest
from scipy.optimize import brentq

from reliab.core.vocabulary import Metric
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.linear_loop.spectral import respond
from reliab.structures.structure import Structure
from reliab.tracking.boundary.first_order import ellipse_of_response, first_order_ellipse
from reliab.tracking.indices.response_error import relative_error


@pytest.fixture(scope="module")
def excitation():
    rng = np.random.default_rng(7)
    t = np.arange(0.0, 20.0, 0.01)
    return Excitation(
        acceleration=rng.standard_normal(t.size) * np.exp(-(((t - 8.0) / 4.0) ** 2)), time_step=0.01
    )


def intercepts(excitation, structure, threshold):
    """Squared gain error and squared delay [ms²] at which the simulated error meets the threshold."""
    loop = Loop(excitation=excitation, structure=structure)

    def excess(gain, delay):
        cells = loop.cells(gain=np.array([gain]), delay=np.array([delay]))
        return float(relative_error(loop.deviation(cells), Metric.RMS)[0]) - threshold

    result = [brentq(lambda e, sign=sign: excess(1.0 + sign * e, 0.0), 1e-6, 0.05) for sign in (1.0, -1.0)]
    delay = brentq(lambda d: excess(1.0, d), 1e-7, 0.01)
    return result[0] * result[1], (1e3 * delay) ** 2


@pytest.mark.default_cases(4)
@pytest.mark.parametrize("frequency", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("damping_ratio", [0.02, 0.1])
@pytest.mark.parametrize("fraction", [1.0, 0.4])
def test_small_errors_are_those_of_the_loop(excitation, frequency, damping_ratio, fraction):
    structure = Structure(frequency=frequency, damping_ratio=damping_ratio, experimental_fraction=fraction)
    a, b = intercepts(excitation, structure, 1e-3)
    found_a, found_b = first_order_ellipse(excitation, structure).parameters(1e-3)
    assert found_a == pytest.approx(a, rel=5e-3)
    assert found_b == pytest.approx(b, rel=3e-2)  # one-sided: the delay's second order stays


def test_neglected_part_falls_with_the_error(excitation):
    structure = Structure(frequency=1.0, damping_ratio=0.02)
    ellipse = first_order_ellipse(excitation, structure)
    differences = [
        abs(ellipse.parameters(threshold)[1] / intercepts(excitation, structure, threshold)[1] - 1.0)
        for threshold in (4e-3, 1e-3)
    ]
    assert differences[1] < 0.5 * differences[0]


def test_parameters_grow_with_the_square_of_the_error(excitation):
    ellipse = first_order_ellipse(excitation, Structure(frequency=1.0, damping_ratio=0.05))
    np.testing.assert_allclose(ellipse.parameters(0.1), 4.0 * np.array(ellipse.parameters(0.05)))


@pytest.mark.parametrize("fraction", [1.0, 0.4])
def test_response_and_record_give_the_same_ellipse(excitation, fraction):
    """In the time domain from the response, and from the spectrum of the record."""
    structure = Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=fraction)
    w0, xi = structure.circular_frequency, structure.damping_ratio
    response, step = respond(excitation, lambda s: 1.0 / (s**2 + 2.0 * xi * w0 * s + w0**2))
    record_ellipse = first_order_ellipse(excitation, structure)
    response_ellipse = ellipse_of_response(response, step, structure)
    for name in ("amplitude", "delay", "effective_duration", "duration"):
        assert getattr(response_ellipse, name) == pytest.approx(getattr(record_ellipse, name), rel=2e-3)


def test_free_vibration_after_a_pulse_has_half_of_its_energy_in_the_error():
    """The transient limit g = 1/2 of a = 4 ξ² ε² T/(T_x g)."""
    t, xi = np.arange(0.0, 120.0, 0.002), 0.02
    free = np.exp(-xi * 2.0 * np.pi * t) * np.sin(2.0 * np.pi * t)
    ellipse = ellipse_of_response(free, 0.002, Structure(frequency=1.0, damping_ratio=xi))
    share = 4.0 * xi**2 * ellipse.duration / ellipse.effective_duration / ellipse.amplitude
    assert share == pytest.approx(0.5, rel=0.02)


@pytest.mark.slow
def test_a_steady_response_to_noise_has_half_of_its_energy_in_the_error():
    """The stationary limit, over 2,000 s of white noise."""
    noise = Excitation(acceleration=np.random.default_rng(3).standard_normal(100_000), time_step=0.02)
    xi = 0.05
    ellipse = first_order_ellipse(noise, Structure(frequency=1.0, damping_ratio=xi))
    share = 4.0 * xi**2 * ellipse.duration / ellipse.effective_duration / ellipse.amplitude
    assert share == pytest.approx(0.5, rel=0.15)
