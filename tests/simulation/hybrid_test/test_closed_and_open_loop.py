"""The march of the whole loop against the spectral solution, and against its own blocks run alone."""

import numpy as np
import pytest
from reliab_studies.laboratory.compensators.adaptive_inverse import AdaptiveInverse
from reliab_studies.laboratory.compensators.inverse import InverseCompensation
from reliab_studies.laboratory.compensators.pi_phase_lead import PhaseLeadControl

from reliab.core.errors import InputError
from reliab.effects.registry import find_effect
from reliab.simulation.excitation import Excitation
from reliab.simulation.hybrid_test.closed_loop import run_closed_loop
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, drive, load, read_force
from reliab.simulation.linear_loop import spectral
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

STEP = 1.0 / 512.0
TIME = np.arange(0.0, 20.0, STEP)
GROUND = np.sin(2.0 * np.pi * 0.8 * TIME) * np.exp(-(((TIME - 6.0) / 3.0) ** 2))
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.05, experimental_fraction=0.6)


@pytest.mark.parametrize(("gain", "delay"), [(1.0, 0.0), (1.02, 0.004), (0.98, 0.0125)])
def test_loop_agrees_with_the_spectral_engine(gain, delay):
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(gain=gain, delay=delay))
    result = run_closed_loop(test, GROUND, STEP)
    excitation = Excitation(acceleration=GROUND, time_step=STEP)
    exact, fine = spectral.response(excitation, STRUCTURE, gain, delay)
    samples = np.interp(TIME, fine * np.arange(exact.size), exact)
    assert np.abs(result.measured - samples).max() < 2e-3 * np.abs(samples).max()


def test_open_loop_blocks_repeat_the_closed_loop():
    effects = (
        find_effect("first_order_lag")(time_constant_s=0.01),
        find_effect("coulomb_friction")(force_n=0.05, regularisation_velocity_m_per_s=0.01),
        find_effect("force_bias")(bias_n=0.02),
    )
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(gain=1.01, delay=0.006), effects=effects)
    complete = run_closed_loop(test, GROUND, STEP)
    piston = drive(test, complete.command)
    np.testing.assert_allclose(piston.values[0], complete.piston.values[0], atol=1e-12)
    np.testing.assert_allclose(read_force(test, piston, load(test, piston)), complete.force, atol=1e-9)


@pytest.mark.parametrize("mass", [0.0, 0.1])
def test_loop_force_is_from_stiffness_damping_and_mass(mass):
    specimen = Specimen(stiffness=20.0, damping=0.3, mass=mass)
    test = HybridTest(structure=STRUCTURE, specimen=specimen, actuator=Actuator(delay=0.006))
    complete = run_closed_loop(test, GROUND, STEP)
    x, v, a = complete.piston.values
    expected = 20.0 * x + 0.3 * v + mass * a
    np.testing.assert_allclose(complete.force, expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("delay", [0.0, 0.006])
@pytest.mark.parametrize(
    "compensator",
    [
        InverseCompensation(steps=3.0),
        AdaptiveInverse(steps=3.0, proportional=4e5, integral=4e4),
        PhaseLeadControl(proportional=0.9, integral=20.0, lead=1.1, lead_pole=60.0),
    ],
    ids=lambda compensator: compensator.name,
)
def test_open_loop_compensator_repeats_the_closed_loop(compensator, delay):
    """It has the command of each instant, and what was measured an instant before, which is 0 at first."""
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(delay=delay))
    run = run_closed_loop(test, 0.05 * GROUND[:1024], STEP, compensator=compensator)
    reading = np.concatenate([[0.0], run.piston.values[0, :-1]])
    coefficients, state = compensator.coefficients(STEP), np.zeros(compensator.kernel.states)
    sent = np.ascontiguousarray(run.command.values.T)
    for motion, last in zip(sent, reading, strict=True):
        compensator.kernel(motion, last, STEP, coefficients, state)
    piston = drive(test, Motion3(values=sent.T, step=STEP))
    scale = np.abs(run.piston.values[0]).max()
    np.testing.assert_allclose(piston.values[0], run.piston.values[0], atol=1e-9 * scale)


def damping_of(test):
    """Damping ratio from the decay of a free vibration."""
    pulse = np.where(TIME < 0.04, 1.0, 0.0)
    swing = np.abs(run_closed_loop(test, pulse, STEP).command.values[0])
    early, late = swing[512:1024].max(), swing[1536:2048].max()
    return np.log(early / late) / (4.0 * np.pi)


@pytest.mark.parametrize("increment", [0.005, 0.03, -0.01])
def test_integration_error_adds_its_stated_damping(increment):
    effect = find_effect("integration_error")(numerical_damping_ratio=increment)
    plain = HybridTest(structure=STRUCTURE)
    assert damping_of(plain.adding(effect)) - damping_of(plain) == pytest.approx(increment, rel=0.01)


def test_loop_without_a_structure():
    with pytest.raises(InputError, match="needs a numerical substructure"):
        _ = HybridTest().substructure
    with pytest.raises(InputError, match="mass of the structure must be between"):
        HybridTest(mass=-1.0)


def test_a_delay_of_just_a_step_is_the_limit_of_shorter_ones():
    time = np.arange(4096) / 512.0
    ground = np.sin(2.0 * np.pi * time) * np.exp(-0.3 * time)
    friction = find_effect("hysteresis")(force_n=20.0, displacement_m=0.01, gamma=0.5, exponent=1.5)
    readings = []
    for delay in (0.999999 / 512.0, 1.000001 / 512.0):
        late = HybridTest(
            structure=Structure(frequency=1.0, damping_ratio=0.05), actuator=Actuator(delay=delay),
            effects=(friction,),
        )  # fmt: skip
        readings.append(run_closed_loop(late, ground, 1.0 / 512.0))
    for name in ("measured", "force"):
        shorter, longer = (getattr(reading, name) for reading in readings)
        np.testing.assert_allclose(longer, shorter, atol=1e-4 * np.abs(shorter).max())


@pytest.mark.parametrize("parts", [1, 4])
def test_motion_through_cubic_samples_is_the_cubic(parts):
    time = 0.01 * np.arange(30)
    motion = Motion3.interpolate(2.0 * time**3 - time, 0.01, parts=parts)
    fine = 0.01 / parts * np.arange(29 * parts + 1)
    assert motion.step == pytest.approx(0.01 / parts)
    expected = np.stack([2.0 * fine**3 - fine, 6.0 * fine**2 - 1.0, 12.0 * fine])
    np.testing.assert_allclose(motion.values, expected, atol=1e-9)
    coarse = motion.thin(parts)
    assert coarse.step == pytest.approx(0.01)
    np.testing.assert_allclose(coarse.values[0], 2.0 * time**3 - time, atol=1e-12)


def test_effects_of_a_test_without_specimen_meet_no_stiffness_and_no_damping():
    setting = HybridTest().setting(0.001)
    assert (setting.step, setting.stiffness, setting.damping) == (0.001, 0.0, 0.0)


def test_a_loop_stepped_finely_is_the_loop_of_the_finer_motion():
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(gain=1.01, delay=0.006))
    fine = np.interp(np.arange(4 * (TIME.size - 1) + 1) / 4, np.arange(TIME.size), GROUND)
    expected = run_closed_loop(test, fine, STEP / 4)
    result = run_closed_loop(test, GROUND, STEP, parts=4)
    for name in ("measured", "force"):
        np.testing.assert_allclose(getattr(result, name), getattr(expected, name)[::4], atol=1e-12)
    assert result.command.step == pytest.approx(STEP)
    np.testing.assert_allclose(result.command.values, expected.command.values[:, ::4], atol=1e-12)


def test_diverging_coarse_loop_is_nan_everywhere():
    error = find_effect("integration_error")
    values = {parameter.name: parameter.upper for parameter in error.parameters}
    test = HybridTest(structure=STRUCTURE, actuator=Actuator(delay=0.3), effects=(error(**values),))
    result = run_closed_loop(test, np.tile(1e3 * GROUND, 30), STEP)
    assert result.measured.shape == result.force.shape == (30 * TIME.size,)
    assert result.command.values.shape == (3, 30 * TIME.size)
    assert np.isnan(result.measured).all()
    assert np.isnan(result.piston.values).all()
