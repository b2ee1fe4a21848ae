"""Every effect against its equation, its registry entry, and its own transfer function."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from reliab.core.errors import InputError
from reliab.effects.effect import LinearEffect, Role, Scales, Setting
from reliab.effects.registry import find_effect, library
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, drive, load, read_displacement
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

STEP = 1e-3
TIME = np.arange(0.0, 8.0, STEP)
X = 0.8 * np.sin(2.0 * np.pi * TIME) * np.sin(np.pi * TIME / 8.0)
NAMES = {
    *("command_saturation", "first_order_lag", "second_order_dynamics", "delay_drift", "rate_limit"),
    *("backlash", "stroke_saturation", "sensor_bias", "sensor_drift", "rectified_sensor", "force_bias"),
    *("cubic_stiffness", "quadratic_stiffness", "coulomb_friction", "directional_friction"),
    *("viscous_damping", "quadratic_damping", "power_law_damping", "hysteresis", "degrading_hysteresis"),
    "hysteresis_with_play",
    *("added_mass", "gap", "series_play", "excitation_scale", "time_step_error", "integration_error"),
}
"""Names that model files and diagnoses of users hold; none of them may change."""


@cache
def motion():
    return Motion3.interpolate(X, STEP)


def force_of(name, **parameters):
    effect = find_effect(name)(**parameters)
    return load(HybridTest(specimen=Specimen(stiffness=50.0), effects=(effect,)), motion()) - 50.0 * X


def moved_by(name, **parameters):
    return drive(HybridTest(effects=(find_effect(name)(**parameters),)), motion()).values[0]


def test_effects_keep_the_names_that_files_hold():
    assert set(library()) >= NAMES


def test_attached_mass_swings_as_its_equation_says():
    rate, ratio = 2.0 * np.pi * 1.3, 0.04
    x = CubicSpline(TIME, X)

    def swing(time, state):
        pull = 2.0 * ratio * rate * (x(time, 1) - state[1]) + rate**2 * (x(time) - state[0])
        return [state[1], pull]

    place = solve_ivp(swing, (0.0, TIME[-1]), [0.0, x(0.0, 1)], t_eval=TIME, rtol=1e-8, atol=1e-10).y
    expected = 3.0 * np.array([swing(*row)[1] for row in zip(TIME, place.T, strict=True)])
    force = force_of("attached_oscillator", mass_kg=3.0, frequency_hz=1.3, damping_ratio=ratio)
    np.testing.assert_allclose(force, expected, atol=2e-3 * np.abs(expected).max())


@pytest.mark.parametrize("name", list(library()))
def test_values_and_coordinates_make_a_round_trip(name):
    effect = library()[name]
    scales = Scales(displacement=0.1, velocity=0.7, acceleration=5.0, force=300.0, duration=40.0)
    for parameter in effect.parameters:
        for start in parameter.starts:
            value = start * parameter.unit(scales)
            assert parameter.value(parameter.coordinate(value, scales), scales) == pytest.approx(value)
            assert parameter.lower <= start <= parameter.upper
    made = effect.from_values(np.array([p.starts[0] * p.unit(scales) or 1.0 for p in effect.parameters]))
    assert np.array_equal(effect.from_values(made.values).values, made.values)


DIMENSIONS = {  # exponents of force, length and time
    "-": (0, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "Hz": (0, 0, -1),
    "s/s": (0, 0, 0),
    "m/s": (0, 1, -1),
    "N": (1, 0, 0),
    "N/m": (1, -1, 0),
    "N/m²": (1, -2, 0),
    "N/m³": (1, -3, 0),
    "N·s/m": (1, -1, 1),
    "N·s²/m²": (1, -2, 2),
    "N·(s/m)^p": (1, -0.5, 0.5),  # about an exponent of one half
    "kg": (1, -1, 2),
}


@pytest.mark.parametrize("name", list(library()))
def test_scales_of_parameters_have_the_dimension_of_their_units(name):
    """In other units of force, length and time a parameter's scale changes as its unit does."""
    force, length, time = 7.0, 3.0, 1.7
    usual = Scales(displacement=0.1, velocity=0.7, acceleration=5.0, force=300.0, duration=40.0)
    other = Scales(
        displacement=0.1 * length,
        velocity=0.7 * length / time,
        acceleration=5.0 * length / time**2,
        force=300.0 * force,
        duration=40.0 * time,
    )
    for parameter in library()[name].parameters:
        if parameter.name == "step_s":  # of an integrator, which no motion scales
            assert parameter.unit(other) == parameter.unit(usual) == 1.0
            continue
        f, m, s = DIMENSIONS[parameter.units]
        expected = force**f * length**m * time**s
        assert parameter.unit(other) / parameter.unit(usual) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("name", "parameter", "most"),
    [
        ("hysteresis", "lost_share", 1.0),
        ("degrading_hysteresis", "lost_share", 1.0),
        ("directional_friction", "asymmetry", 1.0),
        ("directional_damping", "asymmetry", 1.0),
        ("directional_power_law_damping", "asymmetry", 1.0),
        ("hysteresis_with_play", "lost_share", 1.0),
    ],
)
def test_a_share_is_at_most_the_whole(name, parameter, most):
    """A spring loses no more than it had, and friction keeps its sign in both directions."""
    (bounded,) = (each for each in library()[name].parameters if each.name == parameter)
    assert bounded.upper == most
    assert bounded.lower == pytest.approx(-most if parameter == "asymmetry" else 0.0, abs=1e-8)


FORCES = [
    ("cubic_stiffness", {"cubic_n_per_m3": 3.0}, lambda x, _v, _a: 3.0 * x**3),
    ("quadratic_stiffness", {"quadratic_n_per_m2": 3.0}, lambda x, _v, _a: 3.0 * x**2),
    ("viscous_damping", {"damping_n_s_per_m": 2.0}, lambda _x, v, _a: 2.0 * v),
    ("quadratic_damping", {"coefficient_n_s2_per_m2": 2.0}, lambda _x, v, _a: 2.0 * v * np.abs(v)),
    ("added_mass", {"mass_kg": 0.3}, lambda _x, _v, a: 0.3 * a),
    (
        "coulomb_friction",
        {"force_n": 4.0, "regularisation_velocity_m_per_s": 0.01},
        lambda _x, v, _a: 4.0 * np.tanh(v / 0.01),
    ),
    (
        "power_law_damping",
        {"coefficient": 2.0, "exponent": 0.5},
        lambda _x, v, _a: 2.0 * np.sign(v) * np.sqrt(np.abs(v)),
    ),
    (
        "directional_damping",
        {"damping_n_s_per_m": 5.0, "asymmetry": 0.4},
        lambda _x, v, _a: np.where(v > 0.0, 7.0, 3.0) * v,
    ),
    (
        "directional_power_law_damping",
        {"coefficient": 2.0, "exponent": 0.5, "asymmetry": -0.25},
        lambda _x, v, _a: np.where(v > 0.0, 1.5, 2.5) * np.sign(v) * np.sqrt(np.abs(v)),
    ),
    (
        "directional_friction",
        {"force_n": 4.0, "regularisation_velocity_m_per_s": 0.01, "asymmetry": 0.25},
        lambda _x, v, _a: np.tanh(v / 0.01) * (4.0 + np.tanh(v / 0.01)),
    ),
    ("gap", {"gap_m": 0.1}, lambda x, _v, _a: -50.0 * np.clip(x, -0.1, 0.1)),
]


@pytest.mark.parametrize(("name", "parameters", "expected"), FORCES)
def test_force_follows_its_equation(name, parameters, expected):
    np.testing.assert_allclose(force_of(name, **parameters), expected(*motion().values), atol=2e-6)


def test_hysteresis_is_elastic_first_and_yields_then():
    force = force_of("hysteresis", force_n=10.0, displacement_m=0.1, gamma=0.5, exponent=2.0)
    early = np.abs(X) < 0.01
    first = early & (TIME < 0.3)
    np.testing.assert_allclose(force[first], 100.0 * X[first], atol=0.05)
    assert np.abs(force).max() == pytest.approx(10.0, rel=0.01)
    dissipated = np.trapezoid(force, X)
    assert dissipated > 10.0


@pytest.mark.parametrize("gamma", [0.6, 0.2, -0.3, -0.7785])
def test_hysteresis_follows_the_general_equation(gamma):
    """z' = (v/d)(1 − |z|ⁿ(sgn(vz) + g)) in its own units, by an adaptive integrator."""
    exponent, force, displacement = 1.5, 10.0, 0.3
    effect = find_effect("hysteresis")(
        force_n=force, displacement_m=displacement, gamma=gamma, exponent=exponent
    )
    ratio = effect.shape_ratio
    unit = (gamma / ratio) ** (1.0 / exponent)
    time = TIME[:1500]
    v = CubicSpline(TIME, X).derivative()

    def rate(t, z):
        return v(t) * unit / displacement * (1.0 - np.abs(z) ** exponent * (np.sign(v(t) * z) + ratio))

    z = solve_ivp(rate, (0.0, time[-1]), [0.0], t_eval=time, rtol=1e-8, atol=1e-10, max_step=0.01).y[0]
    found = force_of(
        "hysteresis", force_n=force, displacement_m=displacement, gamma=gamma, exponent=exponent
    )[:1500]
    np.testing.assert_allclose(found, force * z / unit, atol=2e-3 * np.abs(found).max())


def test_published_hardening_benchmark_is_a_member():
    """The benchmark α 5e4, β 1e3, γ 0.8, δ −1.1, ν 1: ż = αv − β(γ|v|z + δv|z|)."""
    alpha, beta, gamma, delta = 5e4, 1e3, 0.8, -1.1
    motion = Motion3.interpolate(2e-3 * X, STEP)
    v = CubicSpline(TIME, 2e-3 * X).derivative()
    time = TIME[:2500]

    def rate(t, z):
        return alpha * v(t) - beta * (gamma * np.abs(v(t)) * z + delta * v(t) * np.abs(z))

    z = solve_ivp(rate, (0.0, time[-1]), [0.0], t_eval=time, rtol=1e-9, atol=1e-9, max_step=0.01).y[0]
    ratio = delta / gamma
    share = (-(1.0 / ratio + 1.0) - np.sqrt((1.0 / ratio + 1.0) ** 2 + 8.0)) / 4.0
    force = alpha / (beta * gamma) * share / ratio
    part = find_effect("hysteresis")(force_n=force, displacement_m=force / alpha, gamma=share, exponent=1.0)
    found = load(HybridTest(specimen=Specimen(stiffness=0.0), effects=(part,)), motion)[:2500]
    np.testing.assert_allclose(found, z, atol=2e-3 * np.abs(z).max())


def test_hysteresis_starts_unstressed_where_the_record_starts():
    moved = Motion3.interpolate(X + 0.3, STEP)
    part = find_effect("hysteresis")(force_n=10.0, displacement_m=0.1)
    model = HybridTest(specimen=Specimen(stiffness=0.0), effects=(part,))
    np.testing.assert_allclose(load(model, moved), load(model, motion()), atol=1e-9)


def test_degradation_without_loss_is_hysteresis_and_with_loss_weaker():
    shape = {"force_n": 10.0, "displacement_m": 0.1, "gamma": 0.3, "exponent": 1.5}
    plain, same = force_of("hysteresis", **shape), force_of("degrading_hysteresis", **shape)
    np.testing.assert_allclose(same, plain, atol=1e-9)
    late = TIME > 4.0
    weak = force_of("degrading_hysteresis", **shape, strength_loss=0.05)
    assert np.abs(weak[late]).max() < 0.9 * np.abs(plain[late]).max()
    pinched = force_of("degrading_hysteresis", **shape, slip=0.9)
    assert np.trapezoid(pinched, X) < 0.9 * np.trapezoid(plain, X)


@pytest.mark.parametrize(("strength_loss", "stiffness_loss"), [(0.1, 0.0), (0.5, 0.0), (0.2, 0.3)])
def test_a_push_degrades_with_the_energy_that_it_dissipates(strength_loss, stiffness_loss):
    """Baber and Wen's equations over u = x/d: what enters, z, less what is stored, is dissipated."""
    pushed = 0.6 * np.sin(0.25 * np.pi * np.linspace(0.0, 2.0, 4000)) ** 2
    part = find_effect("degrading_hysteresis")(
        force_n=10.0,
        displacement_m=0.1,
        gamma=0.5,
        exponent=2.0,
        strength_loss=strength_loss,
        stiffness_loss=stiffness_loss,
    )
    model = HybridTest(specimen=Specimen(stiffness=0.0), effects=(part,))
    z = load(model, Motion3.interpolate(pushed, STEP)) / 10.0

    def slopes(_, state):
        rise = (1.0 - (1.0 + strength_loss * state[1]) * state[0] ** 2) / (1.0 + stiffness_loss * state[1])
        return [rise, state[0] * (1.0 - rise)]

    exact = solve_ivp(slopes, (0.0, 6.0), [0.0, 0.0], rtol=1e-9).y[0, -1]
    assert z[-1] == pytest.approx(exact, rel=2e-3)


def test_play_in_series_leaves_the_specimen_where_it_was_pushed_to():
    play = 0.1
    answered = [0.0]
    for x in X[1:]:
        answered.append(min(max(answered[-1], x - 0.5 * play), x + 0.5 * play))
    np.testing.assert_allclose(
        force_of("series_play", width_m=play), 50.0 * (np.array(answered) - X), atol=1e-9
    )


@pytest.mark.parametrize(
    ("name", "parameters"),
    [
        ("cubic_stiffness", {"cubic_n_per_m3": 40.0}),
        ("hysteresis", {"force_n": 9.0, "displacement_m": 0.05}),
        ("coulomb_friction", {"force_n": 3.0, "regularisation_velocity_m_per_s": 0.01}),
    ],
)
def test_play_is_in_series_with_every_effect_in_the_specimen(name, parameters):
    """Named in any order; the motion beyond the play is that of backlash in the drive."""
    effect, play = find_effect(name)(**parameters), find_effect("series_play")(width_m=0.1)
    specimen = Specimen(stiffness=50.0, damping=2.0)
    beyond = drive(HybridTest(effects=(find_effect("backlash")(width_m=0.1),)), motion())
    expected = load(HybridTest(specimen=specimen, effects=(effect,)), beyond)
    for effects in ((effect, play), (play, effect)):
        found = load(HybridTest(specimen=specimen, effects=effects), motion())
        np.testing.assert_allclose(found[1:], expected[1:], atol=1e-9 * np.abs(expected).max())


def test_play_in_a_closed_loop_is_that_along_the_same_motion():
    effects = (
        find_effect("series_play")(width_m=0.05),
        find_effect("hysteresis")(force_n=9.0, displacement_m=0.05),
    )
    test = HybridTest(
        structure=Structure(frequency=1.0, damping_ratio=0.05),
        actuator=Actuator(delay=0.005),
        effects=effects,
    )
    histories = run_closed_loop(test, np.sin(6.0 * TIME), STEP)
    np.testing.assert_allclose(load(test, histories.piston), histories.force, atol=1e-6)


def test_rectified_sensor_folds_one_side():
    folded = HybridTest(effects=(find_effect("rectified_sensor")(rectified_share=2.0),))
    np.testing.assert_allclose(read_displacement(folded, motion()), np.abs(X), atol=1e-12)


def test_saturation_before_and_after_the_dynamics():
    lag = find_effect("first_order_lag")(time_constant_s=0.05)
    before, after = (find_effect(name)(stroke_m=0.3) for name in ("command_saturation", "stroke_saturation"))
    assert before.label() == after.label() == "stroke_saturation"
    assert (before.position, after.position) == ("before the dynamics", "after the dynamics")
    gain = 1.1
    clipped = Motion3.interpolate(np.clip(X, -0.3 / gain, 0.3 / gain), STEP)
    alone = drive(HybridTest(actuator=Actuator(gain=gain), effects=(lag,)), clipped).values[0]
    found = drive(HybridTest(actuator=Actuator(gain=gain), effects=(lag, before)), motion()).values[0]
    np.testing.assert_allclose(found, alone, atol=1e-3)
    last = drive(HybridTest(effects=(lag, after)), motion()).values[0]
    free = drive(HybridTest(effects=(lag,)), motion()).values[0]
    np.testing.assert_allclose(last, np.clip(free, -0.3, 0.3), atol=1e-12)


def test_stroke_backlash_and_rate_limit():
    assert moved_by("stroke_saturation", stroke_m=0.3) == pytest.approx(np.clip(X, -0.3, 0.3), abs=1e-12)
    played = moved_by("backlash", width_m=0.1)
    assert np.abs(played - X).max() == pytest.approx(0.05, abs=1e-6)
    slow = moved_by("rate_limit", velocity_limit_m_per_s=2.0)
    assert np.abs(np.diff(slow)).max() <= 2.0 * STEP + 1e-12


def test_drifting_delay():
    rate = 0.01
    found = moved_by("delay_drift", delay_rate_s_per_s=rate)
    expected = np.interp(TIME - rate * TIME, TIME, X)
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_readings():
    bias = HybridTest(effects=(find_effect("sensor_bias")(bias_m=0.2),))
    drift = HybridTest(effects=(find_effect("sensor_drift")(drift_m_per_s=0.01),))
    np.testing.assert_allclose(read_displacement(bias, motion()) - X, 0.2, atol=1e-12)
    np.testing.assert_allclose(read_displacement(drift, motion()) - X, 0.01 * TIME, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "values"), [("first_order_lag", [0.02]), ("second_order_dynamics", [8.0, 0.6])]
)
def test_stepping_of_a_linear_effect_agrees_with_its_transfer_function(name, values):
    effect = find_effect(name).from_values(np.array(values))
    assert isinstance(effect, LinearEffect)
    frequency = 20.0
    wave = np.sin(2.0 * np.pi * frequency * TIME)
    found = drive(HybridTest(actuator=Actuator(), effects=(effect,)), Motion3.interpolate(wave, STEP)).values[
        0
    ]
    steady = TIME > 4.0 - 0.5 * STEP
    basis = np.exp(2j * np.pi * frequency * TIME[steady])
    measured = 2j * np.mean(found[steady] * np.conj(basis))
    expected = effect.transfer(np.array([2j * np.pi * frequency]))[0]
    assert measured == pytest.approx(expected, abs=2e-5)


def test_record_is_played_with_another_time_step():
    effect = find_effect("time_step_error")(ratio=1.25)
    applied = effect.applied(X, STEP)
    np.testing.assert_allclose(applied, np.interp(TIME / 1.25, TIME, X), atol=1e-12)


def test_errors_say_what_to_do():
    with pytest.raises(InputError, match="Choose among command_saturation"):
        find_effect("gremlins")
    with pytest.raises(InputError, match=r"gap_m of gap must be positive; found -0\.1"):
        find_effect("gap")(gap_m=-0.1)
    assert find_effect("gap").role is Role.FORCE


def marched(gamma, fine):
    """Displacement of a coarse controller, `fine` samples to a step, and the acceleration asked for."""
    asked = np.exp(-(((np.arange(800) - 400) / 6.0) ** 2))
    x, v, path = 0.0, 0.0, []
    part = np.arange(fine) / fine
    for now, later in pairwise(asked):
        bend = now if gamma is not None else 0.0
        path.append(x + part * v + 0.5 * part**2 * bend)
        x, v = x + v + 0.5 * bend, v + (now if gamma is None else (1.0 - gamma) * now + gamma * later)
    return asked, np.concatenate(path)


@pytest.mark.parametrize(("gamma", "shift"), [(0.5, 0.0), (0.8, 0.3), (1.0, 0.5), (None, -1.0)])
def test_integration_error_has_the_transfer_function_of_its_scheme(gamma, shift):
    fine, omega, step = 16, 0.05, 1.0
    asked, path = marched(gamma, fine)
    effect = find_effect("integration_error")(numerical_damping_ratio=0.5 * omega * shift, step_s=step)
    frequency = np.array([0.01, 0.03, 0.08])
    turns = -2j * np.pi * frequency[:, np.newaxis]
    wanted = np.exp(turns * np.arange(asked.size)) @ asked
    bent = np.diff(path, 2) * fine**2
    moved = np.exp(turns * np.arange(1, bent.size + 1) / fine) @ bent / fine
    moved /= np.sinc(frequency / fine) ** 2  # of the second difference
    assert np.allclose(moved / wanted, effect.transfer(frequency, omega), atol=2e-4)


@pytest.mark.parametrize("exponent", [15.0, 50.0])
@pytest.mark.parametrize("gamma", [-0.5, 0.0, 0.5, 0.9])
def test_a_sharp_hysteresis_stays_within_its_yield_force(exponent, gamma):
    effect = find_effect("hysteresis")(force_n=1.0, displacement_m=1.0, gamma=gamma, exponent=exponent)
    step = getattr(effect.kernel.function, "py_func", effect.kernel.function)
    coefficients, state = effect.coefficients(Setting(step=0.01)), np.zeros(4)
    moved = 10.0 * np.sin(0.05 * np.arange(400))
    forces = [step(np.array([x, 0.0, 0.0]), 0.0, 0.01, coefficients, state) for x in moved]
    assert 0.9 < np.abs(forces).max() < 1.2


@pytest.mark.parametrize("name", ["hysteresis", "degrading_hysteresis"])
def test_an_exponent_that_no_step_follows_is_refused(name):
    with pytest.raises(InputError, match="at most 50"):
        find_effect(name)(force_n=1.0, displacement_m=0.01, exponent=100.0)
