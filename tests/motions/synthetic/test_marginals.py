"""The inverse transforms against SciPy's distributions and against quadrature."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import integrate, stats

from reliab.motions.synthetic import dabaghi_der_kiureghian_2018 as model

_NORMAL = st.floats(-3.5, 3.5)


@given(_NORMAL)
def test_oscillations_are_beta_distributed_between_2_and_3_2(nu: float) -> None:
    expected = stats.beta(1.30326178289206, 3.96858083951547, loc=2.0, scale=1.2).ppf(stats.norm.cdf(nu))
    assert model.oscillations(nu) == pytest.approx(expected, rel=1e-5)


@given(_NORMAL)
def test_logarithm_of_the_bandwidth_is_beta_distributed(nu: float) -> None:
    expected = stats.beta(5.33551936215137, 3.82954843573707, loc=-4.7, scale=4.7).ppf(stats.norm.cdf(nu))
    assert np.log(model.bandwidth(nu)) == pytest.approx(expected, abs=1e-5)


@given(_NORMAL)
def test_phase_is_uniform_over_a_turn(nu: float) -> None:
    assert model.phase(nu) == pytest.approx(2.0 * stats.norm.cdf(nu))


def _slope_density(slope: float) -> float:
    return 4.42179588354923 * np.exp(6.40242376475815 * slope if slope < 0 else -14.2935537214223 * slope)


def test_published_slope_density_has_unit_area() -> None:
    area = integrate.quad(_slope_density, -3.5, 0.0)[0] + integrate.quad(_slope_density, 0.0, 1.5)[0]
    assert area == pytest.approx(1.0, abs=1e-12)


@given(_NORMAL)
def test_slope_inverts_the_integral_of_its_density(nu: float) -> None:
    slope = model.slope(nu)
    share = integrate.quad(_slope_density, -3.5, min(slope, 0.0))[0]
    share += integrate.quad(_slope_density, 0.0, slope)[0] if slope > 0 else 0.0
    assert share == pytest.approx(stats.norm.cdf(nu), abs=1e-6)


@pytest.mark.parametrize("transform", [model.oscillations, model.bandwidth, model.phase, model.slope])
def test_transforms_increase(transform: Callable[[float], float]) -> None:
    values = [transform(nu) for nu in np.linspace(-6.0, 6.0, 101)]
    assert np.all(np.diff(values) >= 0.0)
