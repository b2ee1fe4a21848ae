"""The loop with effects agrees with the linear loop where both can answer."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric
from reliab.effects.registry import find_effect
from reliab.simulation.effect_loop import EffectLoop
from reliab.simulation.engine import Loop
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.structures.structure import Structure
from reliab.tracking.boundary.curves import Ellipse
from reliab.tracking.boundary.suite_boundary import motion_contours
from reliab.tracking.indices.response_error import relative_error


@pytest.fixture(scope="module")
def excitation():
    rng = np.random.default_rng(5)
    t = np.arange(0.0, 20.0, 0.01)
    return Excitation(
        acceleration=3.0 * rng.standard_normal(t.size) * np.exp(-(((t - 6.0) / 4.0) ** 2)), time_step=0.01
    )


def effect_loop(excitation, *effects, frequency=1.0, alpha=1.0):
    structure = Structure(frequency=frequency, damping_ratio=0.03, experimental_fraction=alpha)
    return EffectLoop(excitation=excitation, test=HybridTest(structure=structure, effects=effects))


@pytest.mark.default_cases(2)
@pytest.mark.parametrize(("frequency", "alpha"), [(0.3, 1.0), (1.0, 1.0), (2.0, 1.0), (1.0, 0.6)])
@pytest.mark.parametrize("metric", list(Metric))
def test_boundary_without_effects_is_of_the_linear_loop(excitation, frequency, alpha, metric):
    loop = effect_loop(excitation, frequency=frequency, alpha=alpha)
    linear = Loop(excitation=excitation, structure=loop.structure)
    result, exact = (Ellipse.fit(motion_contours(item, (0.05,), metric)[0]) for item in (loop, linear))
    assert result.a == pytest.approx(exact.a, rel=3e-3)
    assert result.b == pytest.approx(exact.b, rel=3e-3)


def test_the_window_is_the_excitations(excitation):
    early = Excitation(acceleration=excitation.acceleration, time_step=0.01, window=(2.0, 9.0))
    loop = effect_loop(early)
    linear = Loop(excitation=early, structure=loop.structure)
    result, exact = (
        relative_error(item.deviation(item.cells(gain=[0.99, 1.0], delay=[0.0, 0.001])), Metric.RMS)
        for item in (loop, linear)
    )
    np.testing.assert_allclose(result, exact, rtol=2e-3)


def test_a_short_lag_spoils_a_test_as_the_same_delay_does(excitation):
    lag = find_effect("first_order_lag")(time_constant_s=0.001)
    late, linear = effect_loop(excitation, lag), effect_loop(excitation)
    lagging = late.deviation(late.cells(gain=1.0, delay=0.0))
    delayed_loop = linear.deviation(linear.cells(gain=1.0, delay=0.001))
    np.testing.assert_allclose(lagging.mean_square, delayed_loop.mean_square, rtol=0.02)


def test_a_lag_takes_its_time_off_the_admissible_delay(excitation):
    lag = find_effect("first_order_lag")(time_constant_s=0.0005)
    late, linear = effect_loop(excitation, lag), effect_loop(excitation)
    (short,), (long,) = motion_contours(late, (0.05,)), motion_contours(linear, (0.05,))
    assert short.delay.max() == pytest.approx(long.delay.max() - 0.0005, rel=0.01)


def test_specimen_behaviour_is_the_reference(excitation):
    friction = find_effect("coulomb_friction")(force_n=0.1, regularisation_velocity_m_per_s=0.001)
    loop = effect_loop(excitation, friction)
    result = loop.deviation(loop.cells(gain=[1.0, 0.99], delay=0.0))
    assert result.mean_square[0] == 0.0
    assert result.mean_square[1] > 0.0


def test_friction_makes_a_test_more_tolerant(excitation):
    friction = find_effect("coulomb_friction")(force_n=0.1, regularisation_velocity_m_per_s=0.001)
    damped_frame, linear = effect_loop(excitation, friction), effect_loop(excitation)
    result, bare = (Ellipse.fit(motion_contours(item)[0]) for item in (damped_frame, linear))
    assert result.a > 1.1 * bare.a
    assert result.b > 1.1 * bare.b


@pytest.mark.slow
def test_where_effects_alone_exceed_the_threshold_no_actuator_is_admitted(excitation):
    lag = find_effect("first_order_lag")(time_constant_s=0.01)
    tight, wide = motion_contours(effect_loop(excitation, lag), (0.05, 0.9))
    no_ellipse = Ellipse.fit(tight)
    assert (no_ellipse.a, no_ellipse.b, no_ellipse.n) == (0.0, 0.0, 0)
    assert np.isnan(no_ellipse.delay(np.array([1.0]))).all()
    assert wide.amplitude.size >= 11


def test_a_loop_needs_a_structure(excitation):
    with pytest.raises(InputError, match=r"\[structure\]"):
        EffectLoop(excitation=excitation, test=HybridTest())
