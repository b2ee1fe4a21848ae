"""The simulator against closed forms, its own refinement and the balance of energy."""

from dataclasses import replace

import numpy as np
import pytest

from blind_campaigns.catalogue import registry, scales_of
from blind_campaigns.march import EXPLICIT_NEWMARK, FORWARD_EULER
from blind_campaigns.simulator import applied_ground, simulate_loop, simulate_prescribed
from blind_campaigns.system import Actuator, Effect, Rig, Specimen, Structure

RATE = 1024.0
STRUCTURE = Structure(frequency_hz=1.3, damping_ratio=0.03, mass_kg=250.0, experimental_fraction=0.7)
SPRING = Specimen(stiffness_n_per_m=STRUCTURE.own_spring)


def effect(name: str, **parameters: float) -> Effect:
    definition = registry()[name]
    assert set(parameters) == set(definition.units)
    return Effect(
        name=name,
        block=definition.block,
        channel=definition.channel,
        parameters=parameters,
        fields=definition.fields,
    )


def rig(*effects: Effect, gain: float = 1.0, delay_s: float = 0.0, structure: Structure = STRUCTURE) -> Rig:
    spring = Specimen(stiffness_n_per_m=structure.own_spring)
    return Rig(
        structure=structure, actuator=Actuator(gain=gain, delay_s=delay_s), specimen=spring, effects=effects
    )


def sine(frequency_hz: float, seconds: float, amplitude: float = 1.0, rate_hz: float = RATE) -> np.ndarray:
    return amplitude * np.sin(2.0 * np.pi * frequency_hz * np.arange(round(seconds * rate_hz) + 1) / rate_hz)


def pulse(seconds: float) -> np.ndarray:
    """A short push, then silence: free vibration."""
    ground = np.zeros(round(seconds * RATE) + 1)
    ground[1:100] = np.hanning(99)
    return ground


def phasor(signal: np.ndarray, frequency_hz: float, cycles: int, rate_hz: float = RATE) -> complex:
    """Amplitude and phase against a sine over the last whole cycles."""
    count = round(cycles * rate_hz / frequency_hz)
    time = np.arange(signal.size)[-count:] / rate_hz
    columns = np.stack(
        [np.sin(2 * np.pi * frequency_hz * time), np.cos(2 * np.pi * frequency_hz * time)], axis=1
    )
    real, imaginary = np.linalg.lstsq(columns, signal[-count:], rcond=None)[0]
    return complex(real, imaginary)


def extremes(signal: np.ndarray) -> np.ndarray:
    turning = np.flatnonzero(np.diff(np.sign(np.diff(signal))) != 0) + 1
    return signal[turning]


def test_step_response_is_the_damped_oscillators() -> None:
    response = simulate_loop(rig(), np.ones(5 * 1024 + 1), rate_hz=RATE)
    time = np.arange(response.command.size) / RATE
    omega, damping = STRUCTURE.omega, STRUCTURE.damping_ratio
    damped_frequency = omega * np.sqrt(1 - damping**2)
    wave = np.cos(damped_frequency * time) + damping * omega / damped_frequency * np.sin(
        damped_frequency * time
    )
    exact = -(1.0 - np.exp(-damping * omega * time) * wave) / omega**2
    assert np.abs(response.command - exact).max() < 1e-11


@pytest.mark.parametrize(
    ("gain", "delay_s", "frequency_hz"), [(1.0, 0.0, 0.9), (0.97, 0.004, 1.2), (1.03, 3e-5, 2.1)]
)
def test_steady_state_of_the_delayed_loop_is_its_transfer_function(
    gain: float, delay_s: float, frequency_hz: float
) -> None:
    structure = replace(STRUCTURE, damping_ratio=0.08)
    loop = rig(gain=gain, delay_s=delay_s, structure=structure)
    response = simulate_loop(loop, sine(frequency_hz, 60.0), rate_hz=RATE)
    s, omega, fraction = 2j * np.pi * frequency_hz, structure.omega, structure.experimental_fraction
    stiffness = omega**2 * (1 - fraction + fraction * gain * np.exp(-s * delay_s))
    exact = -1.0 / (s**2 + 2 * structure.damping_ratio * omega * s + stiffness)
    assert abs(phasor(response.command, frequency_hz, 8) - exact) < 2e-5 * abs(exact)
    response_at_s = exact * gain * np.exp(-s * delay_s)
    assert abs(phasor(response.piston, frequency_hz, 8) - response_at_s) < 2e-5 * abs(exact)


def test_inertia_on_a_rig_without_delay_adds_to_the_mass() -> None:
    heavier = rig(effect("added_mass", mass_kg=20.0))
    response = simulate_loop(heavier, sine(1.0, 60.0), rate_hz=RATE)
    s, mass = 2j * np.pi * 1.0, STRUCTURE.mass
    damping = 2 * STRUCTURE.damping_ratio * STRUCTURE.omega * mass
    exact = -mass / (s**2 * (mass + 20.0) + s * damping + mass * STRUCTURE.omega**2)
    assert abs(phasor(response.command, 1.0, 8) - exact) < 2e-5 * abs(exact)


def test_a_mass_on_an_oscillator_is_another_spring_damper_and_excitation() -> None:
    mass = STRUCTURE.mass
    ratio = mass / (mass + 20.0)
    ground = pulse(12.0)
    heavier = simulate_loop(rig(effect("added_mass", mass_kg=20.0)), ground, rate_hz=RATE)
    loss = -(1.0 - ratio) * 2.0 * STRUCTURE.damping_ratio * STRUCTURE.omega * mass
    viscous = effect("viscous_damping", damping_n_s_per_m=loss)
    stiff = 1.0 - (1.0 - ratio) / STRUCTURE.experimental_fraction  # of the specimen's spring
    softer = replace(
        rig(viscous),
        specimen=Specimen(stiffness_n_per_m=stiff * STRUCTURE.own_spring),
        excitation_scale=ratio,
    )
    twin = simulate_loop(softer, ground, rate_hz=RATE)
    assert np.abs(twin.piston - heavier.piston).max() < 1e-6 * np.abs(heavier.piston).max()


@pytest.mark.parametrize(("share", "grows"), [(0.97, False), (1.03, True)])
def test_critical_delay_separates_decay_from_growth(share: float, grows: bool) -> None:  # noqa: FBT001
    structure = replace(STRUCTURE, experimental_fraction=1.0)
    omega, damping = structure.omega, structure.damping_ratio
    critical = omega * np.sqrt(-2 * damping**2 + np.sqrt(4 * damping**4 + 1))
    delay = np.arctan2(2 * damping * omega * critical, critical**2) / critical
    response = simulate_loop(rig(delay_s=share * delay, structure=structure), pulse(120.0), rate_hz=RATE)
    early, late = np.abs(response.command[2048:30000]).max(), np.abs(response.command[-28000:]).max()
    assert bool(late > early) == grows


def test_coulomb_friction_takes_the_same_step_from_every_half_cycle() -> None:
    structure = replace(STRUCTURE, damping_ratio=0.0, experimental_fraction=1.0)
    friction = effect("coulomb_friction", force_n=2.0, regularisation_velocity_m_per_s=1e-7)
    response = simulate_loop(rig(friction, structure=structure), pulse(6.0), rate_hz=RATE, finest_hz=65536.0)
    peaks = np.abs(extremes(response.command[100:]))[:8]
    # The peak between two samples differs from the sample by up to x·(ω/2·rate)².
    assert np.diff(peaks) == pytest.approx(-2 * 2.0 / structure.own_spring, abs=2e-5 * peaks[0])


def test_power_law_damping_of_exponent_one_is_viscous() -> None:
    law = effect("power_law_damping", coefficient=15.0, exponent=1.0)
    viscous = effect("viscous_damping", damping_n_s_per_m=15.0)
    power_law, second = (simulate_loop(rig(e), pulse(5.0), rate_hz=RATE).command for e in (law, viscous))
    assert np.abs(power_law - second).max() < 1e-12


def test_hysteresis_is_bounded_and_starts_at_its_elastic_slope() -> None:
    parameters = {"force_n": 5.0, "displacement_m": 1e-3, "beta": 0.6, "exponent": 2.0}
    bare = Rig(specimen=Specimen(stiffness_n_per_m=0.0), effects=(effect("hysteresis", **parameters),))
    response = simulate_prescribed(bare, sine(0.5, 6.0, amplitude=0.02), rate_hz=RATE)
    assert 4.999 < np.abs(response.force).max() <= 5.0 + 1e-12
    small = simulate_prescribed(bare, sine(0.5, 1.0, amplitude=1e-6), rate_hz=RATE)
    assert small.force == pytest.approx(small.piston * 5.0 / 1e-3, rel=1e-5, abs=1e-8)
    # A closed loop of force over displacement dissipates; its area is positive over the last cycle.
    cycle = slice(-2049, None)
    assert np.trapezoid(response.force[cycle], response.piston[cycle]) > 0.5 * 4 * 5.0 * 0.02


def test_gap_carries_no_force_inside_and_the_springs_outside() -> None:
    slack = Rig(specimen=Specimen(stiffness_n_per_m=1e4), effects=(effect("gap", gap_m=2e-3),))
    response = simulate_prescribed(slack, sine(0.5, 4.0, amplitude=0.01), rate_hz=RATE)
    reference = 1e4 * np.sign(response.piston) * np.maximum(np.abs(response.piston) - 2e-3, 0.0)
    assert response.force == pytest.approx(reference, abs=1e-9)


def test_actuator_dynamics_are_their_transfer_functions() -> None:
    s = 2j * np.pi * 3.0
    lag = Rig(effects=(effect("first_order_lag", time_constant_s=0.01),))
    response = simulate_prescribed(lag, sine(3.0, 10.0), rate_hz=RATE)
    assert abs(phasor(response.piston, 3.0, 6) - 1 / (1 + 0.01 * s)) < 1e-6
    servo = Rig(effects=(effect("second_order_dynamics", natural_frequency_hz=12.0, damping_ratio=0.4),))
    response = simulate_prescribed(servo, sine(3.0, 10.0), rate_hz=RATE)
    omega = 2 * np.pi * 12.0
    assert abs(phasor(response.piston, 3.0, 6) - omega**2 / (s**2 + 0.8 * omega * s + omega**2)) < 1e-6


def test_viscoelastic_branch_is_its_transfer_function() -> None:
    branch = effect("viscoelastic_branch", stiffness_n_per_m=400.0, time_s=0.2)
    response = simulate_prescribed(
        Rig(specimen=Specimen(stiffness_n_per_m=1000.0), effects=(branch,)), sine(1.0, 12.0), rate_hz=RATE
    )
    s = 2j * np.pi
    assert abs(phasor(response.force, 1.0, 6) - (1000.0 + 400.0 * 0.2 * s / (1 + 0.2 * s))) < 0.01


def test_drifting_delay_reads_the_command_ever_later() -> None:
    drifting = Rig(
        actuator=Actuator(gain=0.99, delay_s=0.01), effects=(effect("delay_drift", delay_rate_s_per_s=1e-3),)
    )
    response = simulate_prescribed(drifting, sine(1.0, 10.0), rate_hz=RATE)
    time = np.arange(response.piston.size) / RATE
    late = np.maximum(time - 0.01 - 1e-3 * time, 0.0)
    assert response.piston == pytest.approx(0.99 * np.sin(2 * np.pi * late), abs=1e-9)
    rate = np.gradient(response.piston, 1 / RATE)
    assert np.abs(response.velocity - rate)[50:-50].max() < 1e-3


def test_limits_of_the_actuator_hold() -> None:
    command = sine(1.0, 6.0, amplitude=0.1)
    rig_with_limit = Rig(effects=(effect("rate_limit", velocity_limit_m_per_s=0.4),))
    steps = np.diff(simulate_prescribed(rig_with_limit, command, rate_hz=RATE).piston) * RATE
    assert 0.399 < np.abs(steps).max() <= 0.4 + 1e-9
    short = Rig(effects=(effect("stroke_saturation", stroke_m=0.07),))
    clipped_response = simulate_prescribed(short, command, rate_hz=RATE)
    assert clipped_response.piston == pytest.approx(np.clip(command, -0.07, 0.07), abs=1e-12)
    loose = Rig(effects=(effect("backlash", width_m=0.02),))
    displacement = simulate_prescribed(loose, command, rate_hz=RATE).piston
    assert np.abs(displacement).max() == pytest.approx(0.09, abs=1e-7)
    assert np.abs(displacement - command).max() <= 0.01 + 1e-12


def test_slip_grows_with_the_largest_displacement_so_far() -> None:
    slipping = Rig(specimen=Specimen(stiffness_n_per_m=100.0), effects=(effect("slip_lock", ratio=0.2),))
    time = np.arange(6 * 1024 + 1) / RATE
    response = simulate_prescribed(slipping, 0.01 * time * np.sin(2 * np.pi * time), rate_hz=RATE)
    largest = np.maximum.accumulate(np.abs(response.piston))
    reference = 100.0 * np.sign(response.piston) * np.maximum(np.abs(response.piston) - 0.2 * largest, 0.0)
    assert response.force == pytest.approx(reference, abs=1e-4)


def test_excitation_errors_are_another_motion() -> None:
    ground = pulse(8.0)
    wrong = rig(effect("excitation_scale", scale=1.2), effect("time_step_error", ratio=1.1))
    applied_motion = applied_ground(wrong, ground, RATE)
    assert applied_motion.max() == pytest.approx(1.2, rel=1e-3)
    assert np.argmax(applied_motion) == pytest.approx(1.1 * np.argmax(ground), abs=1.0)
    assert np.array_equal(
        simulate_loop(wrong, ground, rate_hz=RATE).command,
        simulate_loop(rig(), applied_motion, rate_hz=RATE).command,
    )


@pytest.mark.parametrize(
    ("scheme", "gamma", "sign"),
    [(FORWARD_EULER, 0.5, -0.5), (EXPLICIT_NEWMARK, 0.9, 0.2), (EXPLICIT_NEWMARK, 0.5, 0.0)],
)
def test_coarse_integration_adds_its_numerical_damping(scheme: int, gamma: float, sign: float) -> None:
    step = 8.0 / 1024
    coarse = effect("integration_error", scheme=float(scheme), step_s=step, newmark_gamma=gamma)
    structure = replace(STRUCTURE, damping_ratio=0.04)
    response = simulate_loop(rig(coarse, structure=structure), pulse(6.0), rate_hz=RATE)
    peaks = np.abs(extremes(response.command[1024:]))
    decrement = np.log(peaks[0] / peaks[8]) / 8
    total = decrement / np.sqrt(np.pi**2 + decrement**2)
    assert total - 0.04 == pytest.approx(sign * structure.omega * step, abs=2e-3)


def test_force_bias_is_fed_back_and_shifts_the_rest_position() -> None:
    structure = replace(STRUCTURE, damping_ratio=0.2)
    response = simulate_loop(
        rig(effect("force_bias", bias_n=3.0), structure=structure), np.zeros(30 * 1024), rate_hz=RATE
    )
    assert response.command[-1] == pytest.approx(-3.0 / (structure.mass * structure.omega**2), rel=1e-6)


def test_work_of_the_earthquake_is_stored_or_dissipated() -> None:
    structure = replace(STRUCTURE, experimental_fraction=1.0)
    spring, cubic, friction = structure.own_spring, 3e5, 4.0
    nonlinear = rig(
        effect("cubic_stiffness", cubic_n_per_m3=cubic),
        effect("coulomb_friction", force_n=friction, regularisation_velocity_m_per_s=1e-3),
        effect("quadratic_damping", coefficient_n_s2_per_m2=30.0),
        structure=structure,
    )
    rate = 8192.0
    ground = sine(1.1, 5.0, amplitude=2.0, rate_hz=rate)
    response = simulate_loop(nonlinear, ground, rate_hz=rate)
    x, v, mass = response.piston, response.velocity, structure.mass
    stored_energy = 0.5 * mass * v**2 + 0.5 * spring * x**2 + 0.25 * cubic * x**4
    power = (
        2 * structure.damping_ratio * structure.omega * mass * v
        + 30.0 * np.abs(v) * v
        + friction * np.tanh(v / 1e-3)
    ) * v
    work = np.trapezoid(-mass * ground * v, dx=1 / rate)
    assert stored_energy[-1] + np.trapezoid(power, dx=1 / rate) == pytest.approx(work, rel=1e-6)


def test_halving_the_step_divides_the_error_by_sixteen() -> None:
    rng = np.random.default_rng(3)
    ground = np.cumsum(rng.normal(size=1281)) * 0.1
    soft = rig(
        effect("quadratic_damping", coefficient_n_s2_per_m2=40.0),
        effect("cubic_stiffness", cubic_n_per_m3=2e4),
        effect("second_order_dynamics", natural_frequency_hz=20.0, damping_ratio=0.8), delay_s=0.02,
        structure=replace(STRUCTURE, damping_ratio=0.4),
    )  # fmt: skip
    runs = [simulate_loop(soft, ground, rate_hz=64.0, finest_hz=64.0 * 2**k).command for k in (1, 2, 6)]
    errors = [np.abs(run - runs[-1]).max() for run in runs[:-1]]
    assert errors[0] / errors[1] > 11.0


@pytest.mark.slow
@pytest.mark.default_cases(10)
@pytest.mark.parametrize("name", [name for name, d in registry().items() if d.block != "numerical"])
def test_every_effect_converges_at_the_working_step(name: str) -> None:
    definition = registry()[name]
    ground = sine(1.1, 4.0, amplitude=1.0) + 0.3 * sine(3.7, 4.0)
    calm = simulate_loop(rig(delay_s=0.002), ground, rate_hz=RATE)
    scales = scales_of(
        pistons=[calm.piston], velocities=[calm.velocity], forces=[calm.force],
        stiffness=SPRING.stiffness_n_per_m, delay=0.002, duration=4.0, integration_step=1 / 8192,
    )  # fmt: skip
    hidden = rig(definition.make(0.05, scales, np.full(6, 0.3)), delay_s=0.002)
    working = simulate_loop(hidden, ground, rate_hz=RATE)
    finer = simulate_loop(hidden, ground, rate_hz=RATE, finest_hz=32768.0)
    assert working.bounded
    assert np.abs(working.command - finer.command).max() < 1e-5 * np.abs(calm.command).max()
