"""Specimens: what a force tells about one, and a model that is linear against the linear equation."""

from dataclasses import replace

import numpy as np
import pytest

from rebuilt_error.laboratory import DELAY, RATE, Lab, run, synthetic_ground
from reliab.assessment.inference.uncertain_quantity import PriorKnowledge
from reliab.assessment.modelled_test import ModelledTest, tangent_structure
from reliab.assessment.monitor import Monitor
from reliab.assessment.rebuild import rebuild
from reliab.assessment.rebuilt_error.error_statistics import mean_square
from reliab.assessment.rebuilt_error.size import samples_in_step_of_simulation
from reliab.assessment.rebuilt_error.specimen_check import (
    _cross_validation_residual,
    examine_specimen,
    slider_elongation,
)
from reliab.core.errors import InputError
from reliab.effects.registry import find_effect
from reliab.simulation.hybrid_test.model import HybridTest
from reliab.simulation.hybrid_test.model_file import UpdatedModel
from reliab.structures.frame import Frame, Specimen
from reliab.structures.partition import Partition, whole_structure
from reliab.structures.structure import Structure

STEP = 1.0 / RATE
STRUCTURE = Structure(frequency=1.0, damping_ratio=0.04, experimental_fraction=0.7)
W0 = 2.0 * np.pi
FRICTION = find_effect("coulomb_friction")(force_n=0.15, regularisation_velocity_m_per_s=0.01)


@pytest.fixture(scope="module")
def outcome():
    lab = Lab(1.0, 0.04, 0.7, DELAY, (0.99, 0.003, 0.0, 0.0))
    return run(lab, synthetic_ground(7, 10.0))


def model(**changes):
    specimen = Specimen(stiffness=0.7 * W0**2)
    return replace(HybridTest(structure=STRUCTURE, specimen=specimen), **changes)


def with_model(deviations=None, **changes):
    return UpdatedModel(name="", test=model(**changes), deviations=deviations or {})


def test_a_linear_model_gives_the_error_of_the_linear_equation(outcome):
    linear = rebuild(outcome.command, outcome.measured, STEP, STRUCTURE)
    model_error = rebuild(outcome.command, outcome.measured, STEP, with_model(), draws=4)
    assert model_error.rms.value == pytest.approx(linear.rms.value, rel=3e-3)
    assert model_error.mte.value == pytest.approx(linear.mte.value, rel=2e-3)
    monitor = Monitor(STRUCTURE, STEP)
    monitor.feed(outcome.command, outcome.measured)
    inside = slice(0, -int(0.5 / STEP))  # the motion goes on after the record
    difference = (model_error.displacements[0].error - monitor.error)[inside]
    assert np.abs(difference).max() < 2e-3 * np.abs(monitor.error).max()


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    "tolerances",
    [{"sensor_scale": 0.004}, {"time_shift": 6e-4}, {"sensor_offset": 2e-4}, {"damping_ratio": 0.1}],
)
def test_tolerances_of_a_linear_model_widen_as_those_of_the_linear_equation(outcome, tolerances):
    arguments = (outcome.command, outcome.measured, STEP)
    stated_values = PriorKnowledge(tolerances=tolerances)
    linear = rebuild(*arguments, STRUCTURE, known=stated_values, sensor_offset=0.0, draws=64)
    model_error = rebuild(*arguments, with_model(), known=stated_values, sensor_offset=0.0, draws=32)
    ratio = np.median(model_error.displacements[0].deviation[500:]) / np.median(
        linear.displacements[0].deviation[500:]
    )
    assert ratio == pytest.approx(1.0, abs=0.3)


def draw_models(outcome, deviations, draws):
    updated_model = with_model(deviations, effects=(FRICTION,))
    rebuilt = rebuild(outcome.command, outcome.measured, STEP, updated_model, draws=2)
    test = rebuilt.inferred.test
    assert isinstance(test, ModelledTest)
    return [test.draw_model(draw) for draw in range(draws)]


def test_draws_of_a_model_have_the_stated_deviations(outcome):
    draws = draw_models(outcome, {"stiffness_n_per_m": 1.5, "coulomb_friction.force_n": 0.01}, 400)
    spread = {
        "stiffness": ([single.specimen.stiffness for single in draws], 0.7 * W0**2, 1.5),
        "force": ([single.effects[0].values[0] for single in draws], 0.15, 0.01),
    }
    for name, (values, mean, deviation) in spread.items():
        assert np.mean(values) == pytest.approx(mean, abs=0.2 * deviation), name
        assert np.std(values) == pytest.approx(deviation, rel=0.15), name
    assert len({float(single.effects[0].values[1]) for single in draws}) == 1


def test_draws_stay_positive(outcome):
    wild = {"stiffness_n_per_m": 1e3, "coulomb_friction.regularisation_velocity_m_per_s": 10.0}
    draws = draw_models(outcome, wild, 50)
    assert min(single.specimen.stiffness for single in draws) == 0.0
    assert min(float(single.effects[0].values[1]) for single in draws) == pytest.approx(0.05 * 0.01)


def test_the_tangent_structure_is_per_unit_mass():
    specimen = Specimen(stiffness=80.0, damping=3.0, mass=0.5)
    tangent = tangent_structure(HybridTest(structure=STRUCTURE, specimen=specimen, mass=4.0))
    assert tangent.mass[0, 0] == pytest.approx(1.0 + 0.125)
    assert tangent.stiffness[0, 0] == pytest.approx(0.3 * W0**2 + 20.0)
    assert tangent.damping[0, 0] == pytest.approx(2.0 * 0.04 * W0 + 0.75)
    coverage = (tangent.specimen_stiffness, tangent.specimen_damping, tangent.specimen_mass)
    assert coverage == pytest.approx((20.0, 0.75, 0.125))


def test_draws_are_simulated_at_200_samples_a_second_and_80_a_period():
    for frequency, stride in ((1.0, 5), (4.0, 3), (40.0, 1)):
        assert samples_in_step_of_simulation(frequency, STEP) == stride


def test_a_slider_holds_at_its_limit_and_returns_elastically():
    path = np.array([0.1, 0.3, 0.5, 0.4, 0.0, -0.3, 0.2])
    assert slider_elongation(path, 0.25) == pytest.approx([0.1, 0.25, 0.25, 0.15, -0.25, -0.25, 0.25])


def test_a_force_of_given_shapes_leaves_what_they_do_not_hold():
    rng = np.random.default_rng(4)
    rows, noise = rng.standard_normal((3, 4000)), 0.1 * rng.standard_normal(4000)
    half = np.arange(4000) % 40 < 20
    target = np.array([2.0, -1.0, 30.0]) @ rows
    assert _cross_validation_residual(rows, target, half) < 1e-6 * (target @ target)
    assert _cross_validation_residual(rows, target + noise, half) == pytest.approx(noise @ noise, rel=0.01)
    assert _cross_validation_residual(rows[:2], target, half) == pytest.approx(
        900.0 * rows[2] @ rows[2], rel=0.01
    )
    assert _cross_validation_residual(1e6 * rows, target + noise, half) == pytest.approx(
        _cross_validation_residual(rows, target + noise, half)
    )


def test_shares_of_a_cubic_force_are_those_of_least_squares():
    time = np.arange(0.0, 40.0, 0.005)
    displacement = 0.03 * np.sin(6.0 * time) * (1.2 + np.sin(0.3 * time))
    cubic = 3e4 * displacement**3
    check = examine_specimen(displacement, 40.0 * displacement + cubic, 0.005, 1.0)
    basis = np.stack([displacement, np.gradient(displacement, 0.005), np.ones(time.size)]).T
    remainder = cubic - basis @ np.linalg.lstsq(basis, cubic, rcond=None)[0]
    power = np.mean((40.0 * displacement + cubic) ** 2)
    assert check.nonlinear
    assert check.share == pytest.approx(np.sqrt(np.mean(remainder**2) / power), rel=0.1)
    assert check.gain > 0.98


@pytest.mark.parametrize("amplitude", [0.3, 3.0])
def test_a_load_cell_that_drifts_shows_no_nonlinear_specimen(amplitude):
    time = np.arange(0.0, 40.0, 0.005)
    displacement = np.sin(6.0 * time) * (1.2 + np.sin(0.3 * time))
    drifting = 40.0 * displacement + amplitude * time / 40.0 + amplitude
    assert not examine_specimen(displacement, drifting, 0.005, 1.0).nonlinear
    assert examine_specimen(displacement, drifting + displacement**3, 0.005, 1.0).nonlinear


@pytest.mark.parametrize("frequency", [0.7, 1.1])
def test_mass_that_swings_on_a_spring_of_its_own_is_no_spring(frequency):
    time, rate = np.arange(0.0, 40.0, 0.005), 2.0 * np.pi * frequency
    displacement = np.sin(6.0 * time) * np.sin(0.1 * time) ** 2
    speed, place, pulls = 0.0, 0.0, []
    for x, v in zip(displacement.tolist(), np.gradient(displacement, 0.005).tolist(), strict=True):
        pulls.append(0.1 * rate * (v - speed) + rate**2 * (x - place))
        speed += 0.005 * pulls[-1]
        place += 0.005 * speed
    check = examine_specimen(displacement, 40.0 * displacement + 2.0 * np.array(pulls), 0.005, 1.0)
    assert check.nonlinear


def test_force_of_no_specimen_is_refused_or_linear():
    time = np.arange(0.0, 4.0, 0.005)
    displacement = np.sin(6.0 * time)
    nothing = examine_specimen(displacement, np.zeros(time.size), 0.005, 1.0)
    assert (nothing.nonlinear, nothing.share, nothing.gain) == (False, 0.0, 0.0)
    with pytest.raises(InputError, match="the same length"):
        examine_specimen(displacement, displacement[1:], 0.005, 1.0)
    with pytest.raises(InputError, match="at least 4 periods"):
        examine_specimen(displacement[:-1], displacement[:-1], 0.005, 1.0)
    # 0.4 % of the force is the least that is called nonlinear
    time = np.arange(0.0, 40.0, 0.005)
    displacement = np.sin(6.0 * time) * np.sin(0.1 * time)
    for factor, nonlinear in ((0.5, False), (2.0, True)):
        full_test = examine_specimen(displacement, 40.0 * displacement + 1.0 * displacement**3, 0.005, 1.0)
        small = factor * 0.004 / full_test.share
        assert (
            examine_specimen(
                displacement, 40.0 * displacement + small * displacement**3, 0.005, 1.0
            ).nonlinear
            is nonlinear
        )


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ({"damping": np.eye(3)}, "of the same size"),
        ({"stiffness": np.array([[np.nan]])}, "stiffness matrix"),
        ({"interface": np.array([np.inf])}, "finite numbers"),
        ({"specimen_mass": np.nan}, "specimen mass matrix must be"),
        ({"mass": -np.eye(1)}, "must not be negative"),
    ],
)
def test_impossible_structure_is_refused(changes, rule):
    with pytest.raises(InputError, match=rule):
        replace(Partition.from_structure(STRUCTURE), **changes)


def test_a_frame_of_one_degree_of_freedom_is_its_structure():
    spring = Specimen(stiffness=5.0 * STRUCTURE.experimental_fraction * STRUCTURE.circular_frequency**2)
    full_test = Partition.from_frame(Frame.from_structure(STRUCTURE, mass=5.0), np.ones(1), spring)
    single = Partition.from_structure(STRUCTURE)
    assert full_test.natural_frequencies == pytest.approx(single.natural_frequencies)
    s = np.array([1.0 + 3.0j, 20.0j])
    assert full_test.error_transfer(s) == pytest.approx(single.error_transfer(s))
    assert whole_structure(full_test) is full_test


def test_motion_between_simulated_samples_counts(outcome):
    """Simulated at twice the step without anything unknown, the errors are those of all samples."""
    fine = rebuild(outcome.command, outcome.measured, STEP, with_model(), draws=2)
    test = replace(fine.inferred.test, every=2 * fine.inferred.every)
    error, exact = test.on_record(test.solve(fine.inferred.posterior.mode))[:, 0]
    peak = np.abs(fine.displacements[0].reference).max()
    assert np.abs(exact).max() == pytest.approx(peak, rel=2e-3)
    assert np.sqrt(mean_square(error)) / peak == pytest.approx(fine.rms.value, rel=5e-3)
