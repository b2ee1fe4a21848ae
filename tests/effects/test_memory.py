"""Specimens that remember: relaxation, softening, magnetorheological dampers; a delay with a direction."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from reliab.effects.effect import Setting
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, drive, load
from reliab.structures.frame import Specimen

STEP = 1e-3
TIME = np.arange(0.0, 8.0, STEP)
OMEGA = 2.0 * np.pi * 0.7
X = 0.05 * np.sin(OMEGA * TIME)
NONE = Specimen(stiffness=0.0)


@cache
def sine():
    return Motion3.interpolate(X, STEP)


def force_of(name, motion=None, **parameters):
    return load(HybridTest(specimen=NONE, effects=(find_effect(name)(**parameters),)), motion or sine())


def test_branch_under_a_sine_stores_and_dissipates_as_maxwell_s_element():
    """Storage and loss modulus of a spring k behind a dashpot: k (ωT)²/(1 + (ωT)²), k ωT/(1 + (ωT)²)."""
    force = force_of("viscoelastic_branch", stiffness_n_per_m=200.0, time_s=0.4)
    late = TIME > 6.0
    columns = np.stack([np.sin(OMEGA * TIME), np.cos(OMEGA * TIME)], axis=1)[late]
    storage, loss = np.linalg.lstsq(columns, force[late] / 0.05, rcond=None)[0]
    ratio = OMEGA * 0.4
    assert storage == pytest.approx(200.0 * ratio**2 / (1.0 + ratio**2), rel=1e-3)
    assert loss == pytest.approx(200.0 * ratio / (1.0 + ratio**2), rel=1e-3)


def test_held_specimen_relaxes_with_the_sum_of_both_exponentials():
    moved = np.minimum(TIME / STEP, 1.0) * 0.02
    force = force_of(
        "two_viscoelastic_branches",
        Motion3.interpolate(moved, STEP),
        stiffness_n_per_m=100.0,
        time_s=0.2,
        second_stiffness_n_per_m=40.0,
        time_ratio=10.0,
    )
    expected = 0.02 * (100.0 * np.exp(-TIME / 0.2) + 40.0 * np.exp(-TIME / 2.0))
    np.testing.assert_allclose(force[5:], expected[5:], rtol=5e-3)


@pytest.mark.parametrize("stiffness", [2e3, 2e5])
def test_damper_behind_a_spring_is_its_differential_equation(stiffness):
    force = force_of("nonlinear_maxwell", coefficient=60.0, exponent=0.4, series_stiffness_n_per_m=stiffness)

    def rise(time, value):
        speed = np.sign(value) * (np.abs(value) / 60.0) ** 2.5
        return stiffness * (0.05 * OMEGA * np.cos(OMEGA * time) - speed)

    reference = solve_ivp(rise, (0.0, TIME[-1]), [0.0], "LSODA", TIME, rtol=1e-8, atol=1e-8).y[0]
    moving = slice(5, None)  # from rest it jumps to its speed within the first step
    assert np.abs(force - reference)[moving].max() < 1e-3 * np.abs(reference).max()


def test_damage_lowers_the_stiffness_with_the_largest_displacement():
    growing = X * TIME
    largest = np.maximum.accumulate(np.abs(growing))
    force = force_of(
        "damage", Motion3.interpolate(growing, STEP), lost_n_per_m=0.0, power=2.0, damage_n_per_m2=30.0
    )
    np.testing.assert_allclose(force, -30.0 * largest * growing, atol=1e-12)


def test_delay_with_a_direction_is_longer_while_moving_down():
    test = HybridTest(
        actuator=Actuator(delay=0.02), effects=(find_effect("directional_delay")(difference_s=0.01),)
    )
    piston = drive(test, sine()).values[0]
    velocity = np.cos(OMEGA * TIME)
    for moves, delay in ((velocity > 0.2, 0.015), (velocity < -0.2, 0.025)):
        expected = 0.05 * np.sin(OMEGA * (TIME - delay))
        np.testing.assert_allclose(piston[moves & (TIME > 0.1)], expected[moves & (TIME > 0.1)], atol=1e-7)


PARAMETERS = {
    "force_n": 300.0,
    "displacement_m": 0.002,
    "gamma": 0.3,
    "exponent": 1.6,
    "damping_n_s_per_m": 900.0,
}


@pytest.mark.slow
def test_magnetorheological_damper_follows_the_equations_of_spencer():
    inner, outer, beta = PARAMETERS["damping_n_s_per_m"], 2500.0, 1.0 - PARAMETERS["gamma"]

    def speed(z, v):
        return (PARAMETERS["force_n"] * z + inner * v) / (inner + outer)

    def rate(time, state):
        v = 0.05 * OMEGA * np.cos(OMEGA * time)
        relative = v - speed(state[0], v)
        shape = beta * np.sign(relative * state[0]) + PARAMETERS["gamma"]
        size = np.abs(state[0]) ** PARAMETERS["exponent"]
        return [relative / PARAMETERS["displacement_m"] * (1.0 - size * shape)]

    z = solve_ivp(rate, (0.0, TIME[-1]), [0.0], t_eval=TIME, rtol=1e-8, atol=1e-10, max_step=2e-3).y[0]
    expected = outer * speed(z, 0.05 * OMEGA * np.cos(OMEGA * TIME))
    force = force_of("magnetorheological_damper", **PARAMETERS, series_damping_n_s_per_m=outer)
    assert np.abs(force - expected).max() < 0.02 * np.abs(expected).max()
    assert np.std(force - expected) < 0.003 * np.std(expected)


def test_rigid_second_dashpot_leaves_a_hysteresis_and_a_damper_in_parallel():
    shape = {name: value for name, value in PARAMETERS.items() if name != "damping_n_s_per_m"}
    rigid = force_of("magnetorheological_damper", **PARAMETERS, series_damping_n_s_per_m=1e9)
    both = force_of("hysteresis", **shape) + force_of("viscous_damping", damping_n_s_per_m=900.0)
    assert np.abs(rigid - both).max() < 0.02 * np.abs(both).max()


def test_general_terms_are_found_by_name_and_follow_their_expression():
    force = force_of("displacement_dependent_damping", coefficient=7.0)
    np.testing.assert_allclose(force, 7.0 * X**2 * sine().values[1], rtol=1e-12)
    wave = find_effect("periodic_disturbance")(sine=3.0, cosine=0.0, frequency_hz=2.0)
    assert wave.coefficients(Setting(step=STEP)).tolist() == [3.0, 0.0, 2.0]
