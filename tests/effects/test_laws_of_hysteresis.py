"""Hysteresis by the rule of Masing, and friction that depends on the speed, against what defines them."""

import numpy as np
import pytest

from reliab.effects.hysteresis import Hysteresis
from reliab.effects.masing_hysteresis import MasingHysteresis
from reliab.effects.velocity_dependent_friction import VelocityDependentFriction
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, load
from reliab.structures.frame import Specimen

STEP = 1e-3
FORCE, DISPLACEMENT = 60.0, 0.02


def force_of(effect, path):
    return load(
        HybridTest(specimen=Specimen(stiffness=0.0), effects=(effect,)), Motion3.interpolate(path, STEP)
    )


def ramp(*places, speed=0.05):
    """A path between places at one speed [m/s]."""
    corners = np.cumsum([0.0, *np.abs(np.diff(places)) / speed])
    return np.interp(np.arange(0.0, corners[-1], STEP), corners, places)


def skeleton(x, exponent):
    place = np.abs(x) / DISPLACEMENT
    return FORCE * np.sign(x) * place / (1.0 + place**exponent) ** (1.0 / exponent)


def masing(exponent, **others):
    return MasingHysteresis(force_n=FORCE, displacement_m=DISPLACEMENT, exponent=exponent, **others)


@pytest.mark.parametrize("exponent", [0.7, 1.0, 4.0])
def test_loading_follows_the_skeleton_curve_and_branches_twice_that_curve(exponent):
    path = ramp(0.0, 0.05, -0.05, 0.05)
    force, turn = force_of(masing(exponent), path), np.argmax(path)
    np.testing.assert_allclose(force[:turn], skeleton(path[:turn], exponent), atol=6e-3 * FORCE)
    back = slice(turn, np.argmin(path))
    branch = force[turn] + 2.0 * skeleton(0.5 * (path[back] - path[turn]), exponent)
    np.testing.assert_allclose(force[back], branch, atol=1.2e-2 * FORCE)
    assert force[-1] == pytest.approx(force[turn], abs=6e-3 * FORCE)


def test_a_small_loop_closes_and_the_curve_that_it_interrupted_goes_on():
    straight, interrupted = ramp(0.0, 0.05), ramp(0.0, 0.02, 0.01, 0.05)
    ends = [force_of(masing(1.0), path)[-1] for path in (straight, interrupted)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-4)


def test_small_motions_have_the_stiffness_that_the_spring_has_not_lost():
    path = 1e-5 * ramp(0.0, 0.05, -0.05)
    stiffness = np.polyfit(path, force_of(masing(2.0, lost_share=0.4), path), 1)[0]
    assert stiffness == pytest.approx(0.6 * FORCE / DISPLACEMENT, rel=1e-3)


@pytest.mark.parametrize("share", [-0.8, 0.4])
@pytest.mark.parametrize("speed", [0.002, 0.05, 0.5])
def test_steady_sliding_has_the_friction_of_its_speed(share, speed):
    shape = {"force_n": FORCE, "displacement_m": 1e-4}
    sliding = VelocityDependentFriction(**shape, slow_share=share, speed_m_per_s=0.05)
    path = ramp(0.0, max(200.0 * STEP * speed, 3e-3), speed=speed)
    late = force_of(sliding, path)[path.size // 2 : -5]
    assert late == pytest.approx(FORCE * (1.0 - share * np.exp(-speed / 0.05)), rel=1e-3)


def test_friction_that_does_not_depend_on_the_speed_is_a_hysteresis():
    path, shape = ramp(0.0, 0.05, -0.03, 0.02), {"force_n": FORCE, "displacement_m": 0.01}
    sliding = VelocityDependentFriction(**shape, slow_share=0.0)
    np.testing.assert_array_equal(force_of(sliding, path), force_of(Hysteresis(**shape), path))
