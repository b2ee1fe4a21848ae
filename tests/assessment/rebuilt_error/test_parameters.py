"""Parameters from the test itself, and specimens that are not linear."""

import numpy as np
import pytest

from rebuilt_error.laboratory import (
    COULOMB,
    CUBIC,
    DELAY,
    HYSTERESIS,
    LINEAR,
    RATE,
    Lab,
    noise,
    run,
    synthetic_ground,
)
from reliab.assessment.assess import assess
from reliab.assessment.inference.quantities import QUANTITIES
from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.specimen_check import examine_specimen
from reliab.core.errors import InputError
from reliab.core.stated_value import StatedValue
from reliab.effects.registry import find_effect
from reliab.recordings.recording import Recording
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
RNG = np.random.default_rng(5)


def noisy(values, level=0.01):
    return values + noise("white", values.size, level * float(np.std(values)), RNG)


@pytest.fixture(scope="module", params=[1.0, 0.5])
def channels(request):
    lab = Lab(1.2, 0.03, request.param, DELAY, (0.997, 0.001, 0.0, 0.0))
    return lab, run(lab, synthetic_ground(6, 20.0))


def identify(outcome, structure, *, level=0.0, force_case=True):
    """What noisy channels show of a structure that is stated as exact, and what they contradict."""
    recording = Recording(
        command=outcome.command,
        measured=noisy(outcome.measured, level),
        ground=noisy(outcome.ground, level),
        force=noisy(outcome.force, level) if force_case else None,
        time_step=STEP,
    )
    stated = {"mass": StatedValue(1.0)} if force_case else {}
    equation = assess(recording, structure, stated=stated).equation
    return equation.identified, equation.wrong


@pytest.mark.parametrize("force_case", [True, False])
def test_frequency_and_damping_come_back_from_noisy_channels(channels, force_case):
    lab, outcome = channels
    stated_values = Structure(frequency=1.02 * lab.f, damping_ratio=lab.xi, experimental_fraction=lab.alpha)
    result, wrong = identify(outcome, stated_values, level=0.01, force_case=force_case)
    assert result.frequency.value == pytest.approx(lab.f, rel=0.0005)
    assert result.damping_ratio.value == pytest.approx(lab.xi, rel=0.01)
    assert wrong == ("f",)
    assert result.misfit < 2e-3
    if force_case:
        assert result.experimental_fraction.value == pytest.approx(lab.alpha, abs=0.002)
    else:
        assert result.feedback_lag is None


def test_right_parameters_are_not_contradicted(channels):
    lab, outcome = channels
    stated_values = Structure(frequency=lab.f, damping_ratio=lab.xi, experimental_fraction=lab.alpha)
    result, wrong = identify(outcome, stated_values, level=0.01)
    assert wrong == ()
    assert result.frequency.deviation < 0.002 * lab.f


def test_a_late_force_is_found():
    lab = Lab(1.0, 0.02, 1.0, DELAY, (1.0, 0.0005, 0.0, 0.0), feedback_lag=0.0005)
    outcome = run(lab, synthetic_ground(6, 20.0))
    result, wrong = identify(outcome, Structure(frequency=1.0, damping_ratio=0.02))
    assert result.feedback_lag.value == pytest.approx(0.0005, rel=0.02)
    assert "feedback_lag" in wrong


def specimens():
    k = (2.0 * np.pi) ** 2
    cubic = find_effect("cubic_stiffness")
    return {
        CUBIC: ((40.0, 0.0, 0.0), Specimen(stiffness=k), cubic(**{cubic.parameters[0].name: 40.0 * k})),
        COULOMB: (
            (0.15, 0.01, 0.0),
            Specimen(stiffness=k),
            find_effect("coulomb_friction")(force_n=0.15, regularisation_velocity_m_per_s=0.01),
        ),
        HYSTERESIS: (
            (0.04, 0.3, 2.0),
            Specimen(stiffness=0.3 * k),
            find_effect("hysteresis")(
                force_n=0.7 * k * 0.04, displacement_m=0.04, gamma=0.5, exponent=2.0, lost_share=0.0
            ),
        ),
    }


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("kind", [CUBIC, COULOMB, HYSTERESIS])
def test_a_nonlinear_specimen_is_seen_and_its_model_gives_the_error(kind):
    shape, specimen, effect = specimens()[kind]
    lab = Lab(1.0, 0.03, 1.0, DELAY, (0.995, 0.002, 0.0, 0.0), specimen=kind, shape=shape)
    outcome = run(lab, synthetic_ground(7, 15.0))
    structure = Structure(frequency=1.0, damping_ratio=0.03)
    test = HybridTest(structure=structure, specimen=specimen, effects=(effect,))
    linear = rebuild(outcome.command, noisy(outcome.measured), STEP, structure)
    check = examine_specimen(linear.histories.measured[0], noisy(outcome.force), STEP, 1.0)
    assert check.nonlinear
    model_error = rebuild(outcome.command, outcome.measured, STEP, UpdatedModel(name="", test=test), draws=2)
    assert model_error.rms.value == pytest.approx(outcome.rms, rel=0.01)
    assert abs(linear.rms.value / outcome.rms - 1.0) > 0.03


@pytest.mark.parametrize("kind", ["white", "slow", "mains"])
def test_noise_is_not_called_a_nonlinear_specimen(kind):
    lab = Lab(1.0, 0.03, 1.0, DELAY, (0.995, 0.002, 0.0, 0.0), specimen=LINEAR)
    outcome = run(lab, synthetic_ground(8, 15.0))
    for _ in range(5):
        force = outcome.force + noise(kind, outcome.force.size, 0.02 * float(np.std(outcome.force)), RNG)
        assert not examine_specimen(outcome.measured, force, STEP, 1.0).nonlinear


def test_a_wider_posterior_widens_the_interval():
    shape, specimen, effect = specimens()[COULOMB]
    lab = Lab(1.0, 0.03, 1.0, DELAY, (0.995, 0.002, 0.0, 0.0), specimen=COULOMB, shape=shape)
    outcome = run(lab, synthetic_ground(7, 10.0))
    test = HybridTest(
        structure=Structure(frequency=1.0, damping_ratio=0.03), specimen=specimen, effects=(effect,)
    )
    widths = []
    for share in (0.01, 0.05):
        deviations = {
            "stiffness_n_per_m": share * specimen.stiffness,
            "coulomb_friction.force_n": share * 0.15,
        }
        model = UpdatedModel(name="", test=test, deviations=deviations)
        result = rebuild(outcome.command, outcome.measured, STEP, model, draws=16)
        widths.append(result.rms.high - result.rms.low)
    assert widths[1] > 2.0 * widths[0] > 0.0


@pytest.mark.parametrize("name", ["frequency", "damping_ratio", "experimental_fraction", "sensor_scale"])
def test_relative_tolerances_are_below_one_third(name):
    quantities = {quantity.name: quantity for quantity in QUANTITIES}
    assert quantities[name].stated_prior(0.333).deviation == 0.333
    for value in (1.0 / 3.0, 0.34, -1e-9, np.nan, np.inf):
        with pytest.raises(InputError):
            quantities[name].stated_prior(value)
    assert quantities["time_shift"].stated_prior(0.5).deviation == 0.5
