"""The example behaves as the paper says and as closed forms demand."""

import numpy as np
import pytest
from reliab_studies.paper2017.example import run_paper_example
from reliab_studies.paper2017.records import Cosine, Parabola

from reliab.motions.loading import load_motions
from reliab.motions.motion import Motion
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Ellipse


@pytest.fixture(scope="module")
def example():
    noise = np.random.default_rng(1).normal(size=2000) * np.hanning(2000)
    return run_paper_example(Motion(name="NOISE", acceleration=noise, time_step=0.02))


def test_the_perfect_actuator_makes_no_error(example):
    for name, coordinates in (("error_of_delay", {"long_delay": 0}), ("error_of_gain", {"gain": 20})):
        assert np.abs(example[name].isel(coordinates)).max() < 1e-9


def test_the_map_contains_both_sections(example):
    np.testing.assert_allclose(
        example["error"].isel(delay=0), example["error_of_gain"], rtol=1e-6, atol=1e-12
    )
    section = example["error"].sel(gain=1.0, method="nearest")
    np.testing.assert_allclose(section, example["error_of_delay"].isel(long_delay=slice(21)), rtol=1e-6)


def test_errors_follow_from_the_histories(example):
    exact = example["displacement"].isel(test=0)
    late = example["displacement"].isel(test=1)
    peak = float(np.abs(late - exact).max() / np.abs(exact).max())
    error_of_map = float(example["error_of_delay"].sel(metric="mte").sel(long_delay=5e-3, method="nearest"))
    assert peak == pytest.approx(error_of_map, rel=2e-3)


def test_the_example_of_the_paper(real_motions_folder):
    motion = load_motions(real_motions_folder).select(names=["KOBE/NIS000"])[0]
    results = run_paper_example(motion)
    errors = results["error_of_gain"].sel(gain=0.99, method="nearest")
    assert 100 * float(errors.sel(metric="rms")) == pytest.approx(4.2, rel=0.02)
    assert 100 * float(errors.sel(metric="mte")) == pytest.approx(9.2, rel=0.02)
    contour = Contour(amplitude=results["amplitude_rms"].values, delay=results["delay_rms"].values)
    fit = Ellipse.fit(contour)
    assert (fit.a, fit.b) == (pytest.approx(1.3e-4, rel=0.05), pytest.approx(2.3, rel=0.05))


def test_curves_fit_their_own_points():
    amplitude = np.linspace(0.99, 1.01, 21)
    cosine = Cosine.fit(Contour(amplitude=amplitude, delay=1.6e-3 * np.cos(118.0 * (amplitude - 1.0))))
    assert (cosine.a, cosine.b) == (pytest.approx(1.6), pytest.approx(118.0))
    parabola = Parabola.fit(Contour(amplitude=amplitude, delay=1e-3 * (1.6 - 1e4 * (amplitude - 1.0) ** 2)))
    assert (parabola.a, parabola.b) == (pytest.approx(-1e4), pytest.approx(1.6))
    np.testing.assert_allclose(parabola.delay(np.array([1.0])), 1.6e-3)


@pytest.mark.parametrize(
    ("curve", "delay_on"),
    [(Cosine, lambda a, b, x: a * np.cos(b * x)), (Parabola, lambda a, b, x: a * x**2 + b)],
)
def test_fitting_error_is_of_squared_delays_in_milliseconds(curve, delay_on):
    """Equation (10), with each curve's delay written out from its parameters."""
    offset = np.linspace(-0.008, 0.008, 17)
    delay = 1.5 * np.sqrt(1.0 - (offset / 0.01) ** 2) + 0.02 * np.cos(900.0 * offset)
    result = curve.fit(Contour(amplitude=1.0 + offset, delay=1e-3 * delay))
    curve_values = delay_on(result.a, result.b, offset)
    assert result.n == 17
    assert result.sse == pytest.approx(np.sum((curve_values**2 - delay**2) ** 2), rel=1e-9)
    assert result.delay(1.0 + offset) == pytest.approx(1e-3 * curve_values, rel=1e-9, abs=1e-9)
