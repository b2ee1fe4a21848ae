"""Kernels step by step without compilation, with numbers of which none is one."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reliab.core.errors import InputError
from reliab.effects.effect import Parameter, Scales, Setting
from reliab.effects.general.general_terms import general_term
from reliab.effects.registry import find_effect

SETTING = Setting(step=0.04, stiffness=7.0, damping=3.0)


def stepped(name, motions, setting=SETTING, **parameters):
    """What a kernel returns and the motions that it leaves, and its last state."""
    effect = find_effect(name)(**parameters)
    state, coefficients = np.zeros(max(effect.kernel.states, 1)), effect.coefficients(setting)
    returned, left = [], []
    for place, motion in enumerate(motions):
        moved = np.array(motion, dtype=float)
        time = place * setting.step
        returned.append(effect.kernel(moved, time, setting.step, coefficients, state))
        left.append(moved)
    return np.array(returned), np.array(left), state


def test_a_limited_piston_moves_at_the_limit_to_either_side():
    motions = [[3.0, 9.0, 5.0], [3.01, 9.0, 5.0], [4.0, 9.0, 5.0], [2.0, 9.0, 5.0]]
    _, left, _ = stepped("rate_limit", motions, velocity_limit_m_per_s=0.5)
    expected = [[3.0, 9.0, 5.0], [3.01, 9.0, 5.0], [3.03, 0.5, 0.0], [3.01, -0.5, 0.0]]
    np.testing.assert_allclose(left, expected, atol=1e-12)


def test_play_stands_still_while_it_is_crossed():
    motions = [[1.0, 4.0, 2.0], [1.1, 4.0, 2.0], [1.3, 4.0, 2.0], [1.2, -4.0, 2.0], [0.9, -4.0, 2.0]]
    _, left, _ = stepped("backlash", motions, width_m=0.3)
    expected = [[1.0, 4.0, 2.0], [1.0, 0.0, 0.0], [1.15, 4.0, 2.0], [1.15, 0.0, 0.0], [1.05, -4.0, 2.0]]
    np.testing.assert_allclose(left, expected, atol=1e-12)
    returned, beyond, _ = stepped("series_play", motions, width_m=0.3)
    np.testing.assert_allclose(beyond, expected, atol=1e-12)
    asked = np.array(motions)
    rests = np.array([False, True, False, True, False])
    lost = 7.0 * (beyond[:, 0] - asked[:, 0]) - 3.0 * asked[:, 1] * rests
    np.testing.assert_allclose(returned, lost, atol=1e-12)


def test_a_stop_takes_speed_and_acceleration():
    _, left, _ = stepped(
        "stroke_saturation", [[0.2, 4.0, 2.0], [0.4, 4.0, 2.0], [-0.5, -4.0, 2.0]], stroke_m=0.3
    )
    np.testing.assert_array_equal(left, [[0.2, 4.0, 2.0], [0.3, 0.0, 0.0], [-0.3, 0.0, 0.0]])


def test_a_term_that_moves_the_piston_adds_its_speed_and_acceleration():
    kind: Any = general_term("position_dependent_gain")
    time = np.arange(0.0, 2.0, 0.001)
    motions = np.stack([np.sin(3.0 * time), 3.0 * np.cos(3.0 * time), -9.0 * np.sin(3.0 * time)], axis=1)
    coefficients, state = kind(coefficient=0.2).coefficients(SETTING), np.zeros(kind.kernel.states)
    left = motions.copy()
    for moved in left:
        kind.kernel(moved, 0.0, 0.001, coefficients, state)
    x, v, a = motions.T
    expected = motions + 0.2 * np.stack([x**2, 2.0 * x * v, 2.0 * (v**2 + x * a)], axis=1)
    np.testing.assert_allclose(left[2:], expected[2:], atol=0.03)


@pytest.mark.parametrize(
    ("name", "parameters", "system"),
    [
        (
            "first_order_lag",
            {"time_constant_s": 0.1},
            lambda u, v, y: [(u - y[0]) / 0.1, (v - (u - y[0]) / 0.1) / 0.1],
        ),
        (
            "second_order_dynamics",
            {"natural_frequency_hz": 1.5, "damping_ratio": 0.3},
            lambda u, _v, y: [y[1], (3.0 * np.pi) ** 2 * (u - y[0]) - 1.8 * np.pi * y[1]],
        ),
    ],
)
def test_a_servo_follows_a_ramp_with_its_speed_and_acceleration(name, parameters, system):
    """Along a ramp the line that the kernel assumes within a step is exact."""
    rate, time = 1.7, SETTING.step * np.arange(20)
    _, left, _ = stepped(name, [[0.5 + rate * t, rate, 0.0] for t in time], **parameters)

    def slopes(t, y):
        return system(0.5 + rate * t, rate, y)

    start = [0.5, 0.0]
    exact = solve_ivp(slopes, (0.0, time[-1]), start, t_eval=time, rtol=1e-10, atol=1e-12).y
    np.testing.assert_allclose(left[:, 0], exact[0], atol=1e-8)
    np.testing.assert_allclose(
        left[:, 1:], [system(0.5 + rate * t, rate, y) for t, y in zip(time, exact.T, strict=True)], atol=1e-6
    )


PATH = 0.9 * np.sin(np.linspace(0.0, 9.0, 40))
SHAPE = {"force_n": 10.0, "displacement_m": 0.3, "gamma": 0.4, "exponent": 1.7}


def pushed(path, **parameters):
    force, _, state = stepped("degrading_hysteresis", [[x, 0.0, 0.0] for x in path], **SHAPE, **parameters)
    return force, state


@pytest.mark.parametrize("name", ["hysteresis", "degrading_hysteresis"])
def test_a_spring_loses_a_share_of_the_stiffness_that_the_hysteresis_brings(name):
    motions = [[x, 0.0, 0.0] for x in PATH]
    whole, less = (stepped(name, motions, **SHAPE, lost_share=share)[0] for share in (0.0, 0.6))
    np.testing.assert_allclose(whole - less, 0.6 * 10.0 * PATH / 0.3, rtol=1e-9)


def behind_play(path, **parameters):
    return stepped("hysteresis_with_play", [[x, 0.0, 0.0] for x in path], **SHAPE, **parameters)[0]


def test_a_hysteresis_behind_vanishing_play_is_a_hysteresis():
    fine = np.interp(np.linspace(0.0, 39.0, 4000), np.arange(40), PATH)
    alone = stepped("hysteresis", [[x, 0.0, 0.0] for x in fine], **SHAPE)[0]
    np.testing.assert_allclose(behind_play(fine, width_m=1e-9), alone, atol=2e-3)


def test_play_carries_no_force_and_is_crossed_before_the_other_side_is_loaded():
    """A sharp hysteresis of 10 N and 0.3 m: half of the play, load, relief, all of the play, load."""
    path = [0.0, 0.1, 0.4, 1.0, 0.7, 0.5, 0.45, -0.15, -0.5]
    sharp = {"force_n": 10.0, "displacement_m": 0.3, "gamma": 0.5, "exponent": 40.0, "width_m": 0.2}
    fine = np.interp(np.linspace(0.0, len(path) - 1.0, 8001), np.arange(len(path)), path)
    force = stepped("hysteresis_with_play", [[x, 0.0, 0.0] for x in fine], **sharp)[0][::1000]
    np.testing.assert_allclose(force, [0.0, 0.0, 10.0, 10.0, 0.0, 0.0, -10.0 / 6.0, -10.0, -10.0], atol=0.5)


def test_one_direction_yields_later_with_the_same_stiffness():
    path = np.concatenate([np.linspace(0.0, 3.0, 300), np.linspace(3.0, -3.0, 600)])
    force = behind_play(path, width_m=0.2, asymmetry=0.25)
    assert force.max() == pytest.approx(12.5, rel=1e-3)
    assert force.min() == pytest.approx(-7.5, rel=1e-3)
    assert np.diff(force).max() == pytest.approx(10.0 / 0.3 * 0.01, rel=0.02)


@pytest.mark.parametrize("losses", [{}, {"strength_loss": 0.3, "stiffness_loss": 0.2}, {"slip": 0.5}])
def test_long_steps_of_a_hysteresis_are_divided(losses):
    """Force and dissipated energy of steps of several yield displacements are those of small ones."""
    corners = np.array([0.0, 2.0, -1.5, 0.7, 1.4])
    fine = np.concatenate([np.linspace(a, b, 400, endpoint=False) for a, b in pairwise(corners)])
    coarse, state = pushed(corners, **losses)
    steps, last = pushed([*fine, corners[-1]], **losses)
    np.testing.assert_allclose(coarse, [*steps[::400]], rtol=0.01, atol=0.05)
    assert state[3] == pytest.approx(last[3], rel=0.01)


@pytest.mark.parametrize(("gamma", "exponent"), [(-0.65, 2.8), (0.4, 0.5), (0.4, 10.0)])
@pytest.mark.parametrize("losses", [{}, {"stiffness_loss": 0.002}, {"slip": 0.5}])
def test_a_step_of_hundreds_of_yield_displacements_ends_at_the_limit(gamma, exponent, losses):
    """There (β + γ)·|z|ⁿ is one, and the energy of a step is the force times the way."""
    shape = {"force_n": 10.0, "displacement_m": 0.01, "gamma": gamma, "exponent": exponent}
    path = np.array([0.0, 3.0, -4.0, 1.0])
    force, _, state = stepped("degrading_hysteresis", [[x, 0.0, 0.0] for x in path], **shape, **losses)
    limit = (1.0 - 2.0 * min(gamma, 0.0) ** 2) ** (-1.0 / exponent)
    np.testing.assert_allclose(force[1:] / (10.0 * limit), [1.0, -1.0, 1.0], atol=1e-3)
    assert state[3] == pytest.approx(15.0 / 0.01 * limit, rel=0.03)


def test_parameters_are_told_by_their_coordinates():
    scales = Scales(displacement=0.1, velocity=0.7, acceleration=5.0, force=300.0, duration=40.0)
    size = Parameter(
        name="size",
        units="m",
        meaning="a size",
        scale=(("displacement", 1.0),),
        lower=0.2,
        upper=3.0,
        starts=(1.0,),
    )
    sign = Parameter(
        name="sign", units="N", meaning="a force", scale=(("force", 1.0),), signed=True, neutral=0.4,
        typical=0.6, lower=-0.9, upper=0.8, starts=(0.4,),
    )  # fmt: skip
    assert size.coordinate_bounds == pytest.approx((np.log(0.2), np.log(3.0)))
    assert sign.coordinate_bounds == pytest.approx((-1.3, 0.4))
    assert size.coordinate_prior == (0.0, 1.5)
    assert sign.coordinate_prior == (0.0, 0.6)
    for parameter, at in ((size, 0.7), (sign, -0.3)):
        change = parameter.value(at + 1e-6, scales) - parameter.value(at - 1e-6, scales)
        assert parameter.derivative(at, scales) == pytest.approx(change / 2e-6)


@pytest.mark.parametrize(("lower", "upper", "rule"), [(2.0, 1.0, "below the upper"), (0.0, 1.0, "positive")])
def test_bounds_of_a_parameter_are_an_order(lower, upper, rule):
    with pytest.raises(InputError, match=rule):
        Parameter(name="p", units="m", meaning="p", lower=lower, upper=upper, starts=(1.0,))
