"""The effect-to-noise ratio and the rivals against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from blind_campaigns.case import Case, Observation, decibels, root_mean_square
from blind_campaigns.catalogue import registry, scales_of
from blind_campaigns.loop_refit import loop_residual
from blind_campaigns.motions import multisine, synthetic_accelerogram
from blind_campaigns.noise import Noise
from blind_campaigns.ratio import calibrated_residual, effect_change, effect_to_noise, nats
from blind_campaigns.rivals import rival_residuals
from blind_campaigns.system import Actuator, Effect, Rig, Specimen, Structure

RATE = 512.0
NOISE = {"measured_m": 1e-4, "force_n": 10.0}
WHITE = Noise(kind="white", shares={"white": 1.0})
SPRING = Specimen(stiffness_n_per_m=1e5)


def effect(name: str, **parameters: float) -> Effect:
    definition = registry()[name]
    return Effect(
        name=name,
        block=definition.block,
        channel=definition.channel,
        parameters=parameters,
        fields=definition.fields,
    )


def case(rig: Rig, observation: Observation, inputs: list[np.ndarray]) -> Case:
    count = len(inputs)
    return Case(
        rig=rig, observation=observation, rate_hz=RATE, inputs=tuple(inputs), motions=("m",) * count,
        held_out=(False,) * count, numbers=tuple(range(count)), noise=WHITE, noise_rms=NOISE,
    )  # fmt: skip


def open_loop(*effects: Effect, specimen: Specimen | None = None, wave: np.ndarray | None = None) -> Case:
    rng = np.random.default_rng(4)
    waves = (
        [0.02 * multisine(rng, duration_s=20.0, rate_hz=RATE) for _ in range(2)] if wave is None else [wave]
    )
    observation = Observation.ACTUATOR_ONLY if specimen is None else Observation.SPECIMEN_ONLY
    return case(
        Rig(actuator=Actuator(gain=0.98, delay_s=0.01), specimen=specimen, effects=effects),
        observation,
        waves,
    )


def ratio(open_case: Case) -> float:
    hidden = open_case.rig.effects[0]
    change = effect_change(open_case, hidden, open_case.run(1024.0))
    return effect_to_noise(open_case, change, calibrated_residual(change))


def long_sine() -> np.ndarray:
    return 0.01 * np.sin(2 * np.pi * np.arange(40 * 512 + 1) / RATE)


def test_offsets_are_held_against_the_noise_as_they_are() -> None:
    assert ratio(open_loop(effect("sensor_bias", bias_m=3e-4))) == pytest.approx(decibels(3.0), abs=1e-3)


def test_damping_is_held_against_the_noise_after_the_spring_is_refitted() -> None:
    viscous = open_loop(effect("viscous_damping", damping_n_s_per_m=5e3), specimen=SPRING, wave=long_sine())
    reference = 5e3 * 0.98 * 0.01 * 2 * np.pi / np.sqrt(2) / 10.0
    assert ratio(viscous) == pytest.approx(decibels(reference), abs=0.05)


def test_cubic_stiffness_keeps_only_its_third_harmonic_under_a_sine() -> None:
    cubic = open_loop(effect("cubic_stiffness", cubic_n_per_m3=1e10), specimen=SPRING, wave=long_sine())
    reference = 1e10 * 0.0098**3 / 4 / np.sqrt(2) / 10.0
    assert ratio(cubic) == pytest.approx(decibels(reference), abs=0.05)


def test_inertia_is_nothing_but_stiffness_under_a_sine() -> None:
    heavy = effect("added_mass", mass_kg=500.0)
    assert ratio(open_loop(heavy, specimen=SPRING, wave=long_sine())) < -20.0
    assert ratio(open_loop(heavy, specimen=SPRING)) > 10.0


def test_a_lag_is_nearly_a_delay() -> None:
    lag = open_loop(effect("first_order_lag", time_constant_s=0.004))
    change = effect_change(lag, lag.rig.effects[0], lag.run(1024.0))
    raw = root_mean_square([a - b for a, b in zip(change.with_effect, change.without, strict=True)])
    assert root_mean_square(calibrated_residual(change)) < 0.1 * raw


def test_pure_delay_and_gain_leave_nothing() -> None:
    """A drift of nought stands for an effect that is calibration altogether."""
    drift = open_loop(effect("delay_drift", delay_rate_s_per_s=0.0))
    change = effect_change(drift, drift.rig.effects[0], drift.run(1024.0))
    late = [
        0.97 * np.interp(np.arange(p.size) / RATE - 0.003, np.arange(p.size) / RATE, p)
        for p in change.without
    ]
    late_change = replace(change, with_effect=late)
    assert root_mean_square(calibrated_residual(late_change)) < 1e-3 * root_mean_square(late)


def test_quadratic_damping_minus_viscous_is_its_harmonics() -> None:
    quadratic = open_loop(
        effect("quadratic_damping", coefficient_n_s2_per_m2=1e5), specimen=SPRING, wave=long_sine()
    )
    responses = quadratic.run(1024.0)
    change = effect_change(quadratic, quadratic.rig.effects[0], responses)
    scales = scales_of(
        pistons=[responses[0].piston], velocities=[responses[0].velocity],
        forces=[responses[0].force], stiffness=1e5, delay=0.01, duration=40.0, integration_step=1 / 8192,
    )  # fmt: skip
    plain, rivals = rival_residuals(quadratic, quadratic.rig.effects[0], change, responses, scales)
    amplitude = 1e5 * (0.0098 * 2 * np.pi) ** 2
    assert root_mean_square(plain) == pytest.approx(amplitude * np.sqrt(3 / 8), rel=0.01)
    harmonics = np.sqrt(3 / 8 - (8 / (3 * np.pi)) ** 2 / 2)
    assert root_mean_square(rivals["viscous_damping"]) == pytest.approx(amplitude * harmonics, rel=0.01)
    assert root_mean_square(rivals["gap"]) > 0.9 * root_mean_square(plain)


@pytest.mark.slow
def test_a_servo_is_told_from_a_lag_but_a_lag_is_nearly_a_servo() -> None:
    lag = open_loop(effect("first_order_lag", time_constant_s=0.02))
    responses = lag.run(1024.0)
    change = effect_change(lag, lag.rig.effects[0], responses)
    scales = scales_of(
        pistons=[r.piston for r in responses], velocities=[r.velocity for r in responses],
        forces=[r.piston for r in responses], stiffness=1.0, delay=0.01, duration=20.0,
        integration_step=1 / 8192,
    )  # fmt: skip
    plain, rivals = rival_residuals(lag, lag.rig.effects[0], change, responses, scales)
    assert root_mean_square(rivals["second_order_dynamics"]) < 0.3 * root_mean_square(plain)
    assert root_mean_square(rivals["backlash"]) > 0.8 * root_mean_square(plain)


def test_balance_of_forces_holds_the_missing_excitation() -> None:
    structure = Structure(frequency_hz=1.0, damping_ratio=0.05, mass_kg=100.0)
    spring = Specimen(stiffness_n_per_m=structure.own_spring)
    ground = synthetic_accelerogram(np.random.default_rng(2), duration_s=20.0, rate_hz=RATE)
    louder = Rig(structure=structure, specimen=spring, effects=(effect("excitation_scale", scale=1.25),))
    loud = case(louder, Observation.FULL, [ground])
    reference = 0.25 * 100.0 * root_mean_square([ground]) / 10.0
    assert ratio(loud) == pytest.approx(decibels(reference), abs=0.1)


def test_exact_integration_balances_and_a_coarse_one_does_not() -> None:
    structure = Structure(frequency_hz=1.0, damping_ratio=0.08, mass_kg=100.0)
    spring = Specimen(stiffness_n_per_m=structure.own_spring)
    ground = synthetic_accelerogram(np.random.default_rng(2), duration_s=20.0, rate_hz=RATE)
    ratios = []
    for step in (1 / 8192, 8 / 8192, 32 / 8192):
        coarse = effect("integration_error", scheme=1.0, step_s=step, newmark_gamma=0.5)
        ratios.append(
            ratio(
                case(Rig(structure=structure, specimen=spring, effects=(coarse,)), Observation.FULL, [ground])
            )
        )
    assert ratios[1] - ratios[0] == pytest.approx(decibels(8.0), abs=1.0)
    assert ratios[2] - ratios[1] == pytest.approx(decibels(4.0), abs=2.0)


def test_one_channel_refit_finds_calibration_again() -> None:
    structure = Structure(frequency_hz=1.0, damping_ratio=0.05)
    spring = Specimen(stiffness_n_per_m=structure.own_spring)
    ground = 0.5 * synthetic_accelerogram(np.random.default_rng(2), duration_s=20.0, rate_hz=RATE)
    louder = effect("excitation_scale", scale=1.05)
    oscillator = Rig(structure=structure, specimen=spring, effects=(louder,))
    remainder = loop_residual(case(oscillator, Observation.ONE_CHANNEL_OSCILLATOR, [ground]), louder)
    assert root_mean_square(remainder) < 1e-6
    damper = effect("viscous_damping", damping_n_s_per_m=0.02 * 2 * structure.omega)
    damped_rig = Rig(structure=structure, specimen=spring, effects=(damper,))
    remainder = loop_residual(case(damped_rig, Observation.ONE_CHANNEL_OSCILLATOR, [ground]), damper)
    assert root_mean_square(remainder) > 1e-4


def test_nats_of_a_residual_in_white_noise_are_half_its_energy() -> None:
    white = open_loop(effect("sensor_bias", bias_m=1e-4))
    residual = [np.sin(np.arange(4001) * 0.1) * 1e-4]
    assert nats(white, "measured_m", residual, RATE) == pytest.approx(0.5 * 4001 * 0.5, rel=0.01)
