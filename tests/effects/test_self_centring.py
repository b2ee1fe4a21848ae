"""Self-centring specimens against the corners of the flag and its area, and against the elastic curve."""

import numpy as np
import pytest

from reliab.effects.bilinear_stiffness import BilinearStiffness
from reliab.effects.self_centring import SelfCentring
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen

STEP = 1e-3
TIME = np.arange(0.0, 4.0, STEP)
YIELD_FORCE, YIELD_DISPLACEMENT = 60.0, 0.02
STIFFNESS = YIELD_FORCE / YIELD_DISPLACEMENT
PEAK = 0.05
X = PEAK * np.sin(2.0 * np.pi * 0.5 * TIME)


def force_of(path=X, **shape):
    effect = SelfCentring(force_n=YIELD_FORCE, displacement_m=YIELD_DISPLACEMENT, **shape)
    model = HybridTest(specimen=Specimen(stiffness=STIFFNESS), effects=(effect,))
    return load(model, Motion3.interpolate(path, STEP))


@pytest.mark.parametrize("share", [0.3, 0.8, 1.0])
def test_a_sharp_flag_has_the_corners_and_the_area_of_a_flag(share):
    force = force_of(flag_share=share, exponent=30.0)
    later = TIME >= 2.0  # the second cycle
    corners = {  # place over the yield displacement while it returns: force over the yield force
        2.5 - 0.5 * share: 1.0 - 0.5 * share,
        2.5 - 1.2 * share: 1.0 - share,
        0.5 * (1.0 - share): 0.5 * (1.0 - share),
    }
    returning = (np.gradient(X) < 0.0) & (X > 0.0)
    for place, value in corners.items():
        nearest = np.argmin(np.where(returning, np.abs(X - place * YIELD_DISPLACEMENT), np.inf))
        assert force[nearest] / YIELD_FORCE == pytest.approx(value, abs=0.03)
    area = np.trapezoid(force[later], X[later])
    assert area == pytest.approx(2.0 * share * YIELD_FORCE * (PEAK - YIELD_DISPLACEMENT), rel=0.05)


def test_without_a_flag_the_force_is_that_of_a_spring_that_bends():
    force = force_of(flag_share=0.0, exponent=2.0)
    place = X / YIELD_DISPLACEMENT
    np.testing.assert_allclose(force, YIELD_FORCE * place / np.sqrt(1.0 + place**2), atol=1e-6)
    bent = BilinearStiffness(force_n=YIELD_FORCE, displacement_m=YIELD_DISPLACEMENT, exponent=2.0)
    model = HybridTest(specimen=Specimen(stiffness=STIFFNESS), effects=(bent,))
    np.testing.assert_allclose(load(model, Motion3.interpolate(X, STEP)), force, atol=1e-6)


@pytest.mark.parametrize("share", [0.0, 0.6, 1.0])
def test_a_specimen_released_anywhere_returns_to_where_it_began(share):
    path = np.interp(TIME, [0.0, 1.0, 2.0, 2.5, 3.0, 4.0], [0.0, 0.06, -0.03, 0.01, 0.0, 0.0])
    assert abs(force_of(path, flag_share=share)[-1]) < 0.01 * YIELD_FORCE


def test_small_motions_have_the_stiffness_of_the_spring():
    np.testing.assert_allclose(force_of(1e-3 * X, flag_share=0.5), STIFFNESS * 1e-3 * X, rtol=1e-6, atol=1e-9)


def test_the_force_does_not_depend_on_the_steps_of_the_path():
    fine = force_of(flag_share=0.7)
    coarse = load(
        HybridTest(
            specimen=Specimen(stiffness=STIFFNESS),
            effects=(SelfCentring(force_n=60.0, displacement_m=0.02, flag_share=0.7),),
        ),
        Motion3.interpolate(X[::20], 20.0 * STEP),
    )
    assert np.abs(fine[::20] - coarse).max() < 2e-3 * YIELD_FORCE


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_a_very_sharp_bend_has_a_corner_and_finite_forces(share):
    force = force_of(flag_share=share, exponent=1e4)
    assert force.max() == pytest.approx(YIELD_FORCE, rel=1e-3)
    assert np.isfinite(force).all()
