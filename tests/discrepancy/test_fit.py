"""What fits reuse is what simulating again would give, and they ask for few simulations."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest

from reliab.core.vocabulary import Block
from reliab.discrepancy.blocks.actuator import ActuatorBlock
from reliab.discrepancy.blocks.loop import LoopBlock
from reliab.discrepancy.blocks.specimen import SpecimenBlock
from reliab.discrepancy.campaign.campaign import Campaign, Channel, MeasuredTest
from reliab.discrepancy.fitting.fit import fit, jacobian, refine_fit, reweight_fit, sharpen_fit
from reliab.discrepancy.fitting.left_out import leave_out
from reliab.discrepancy.fitting.problem import Problem, relative_powers
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.segment import cut_segments, motions_of, scales_of
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect, Role, Setting, SteppedEffect
from reliab.effects.general.general_terms import general_terms
from reliab.effects.registry import find_effect, library
from reliab.signals.noise import NoiseModel
from reliab.simulation.hybrid_test.model import Actuator, HybridTest
from reliab.simulation.hybrid_test.open_loop import Motion3, follow, load, read_force
from reliab.structures.frame import Specimen
from reliab.structures.structure import Structure

RATE, NOISE = 1024.0, 2.0
SPECIMEN = Specimen(stiffness=2000.0)
FRICTION = find_effect("coulomb_friction")(force_n=20.0, regularisation_velocity_m_per_s=0.001)


@pytest.fixture(scope="module")
def campaign():
    rng = np.random.default_rng(7)
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    tests = []
    for k in range(4):
        waves = [np.sin(2.0 * np.pi * f * time + rng.uniform(0.0, 7.0)) for f in rng.uniform(0.4, 2.0, 6)]
        displacement = 0.01 * np.sum(waves, axis=0) * np.sin(np.pi * time / time[-1]) ** 2
        force = load(
            HybridTest(specimen=SPECIMEN, effects=(FRICTION,)), Motion3.interpolate(displacement, 1.0 / RATE)
        )
        channels = {
            Channel.COMMAND: displacement,
            Channel.MEASURED: displacement,
            Channel.FORCE: force + NOISE * rng.standard_normal(force.size),
        }
        tests.append(MeasuredTest(file=f"{k}", motion="waves", held_out=k == 3, channels=channels))
    return Campaign(
        name="", structure=None, mass=1.0, actuator=Actuator(delay=0.004), specimen=SPECIMEN, rate=RATE,
        tests=tuple(tests),
    )  # fmt: skip


@pytest.fixture(scope="module")
def block(campaign):
    motions = motions_of(campaign)
    return SpecimenBlock(campaign, scales_of(campaign, motions), motions)


@pytest.fixture(scope="module")
def problem(campaign, block):
    return Problem(
        block=block, segments=cut_segments(campaign.training, RATE, lambda _: 40.0, block.sketch.every)
    )


@pytest.fixture(scope="module")
def model_fit(problem):
    space = ModelSpace(problem.block, (type(FRICTION),))
    bare = ModelSpace(problem.block, ())
    start = next(space.starts(bare, np.zeros(bare.size)))
    return fit(problem, space, [start], NoiseModel.white(RATE, NOISE**2))


def test_forces_of_effects_add_up(block):
    bias = find_effect("force_bias")(bias_n=3.0)
    model = HybridTest(specimen=SPECIMEN, effects=(FRICTION, bias))
    piston = block.motions[0]
    np.testing.assert_allclose(
        block.predict(model, 0), read_force(model, piston, load(model, piston)), rtol=1e-12
    )


LATE = ClockOffset(lag_s=0.003)
PLAY = find_effect("series_play")(width_m=0.002)
ORIFICE = find_effect("quadratic_damping")(coefficient_n_s2_per_m2=900.0)
SLACK = find_effect("gap")(gap_m=0.001)


@pytest.mark.parametrize(
    "effects", [(), (SLACK, FRICTION), (LATE, FRICTION), (ORIFICE, FRICTION, LATE), (PLAY, FRICTION)]
)
@pytest.mark.parametrize("is_smoothed", [False, True])
def test_remembered_spectra_are_those_of_the_predicted_force(campaign, effects, is_smoothed):
    motions = motions_of(campaign)
    block = SpecimenBlock(campaign, scales_of(campaign, motions), motions, is_smoothed=is_smoothed)
    segments = cut_segments(campaign.training[:2], RATE, lambda _: 40.0)
    for factor in (1.0, 1.7):  # the second time from what is remembered
        stiffer = replace(SPECIMEN, stiffness=factor * SPECIMEN.stiffness, mass=0.3)
        model = HybridTest(specimen=stiffer, effects=effects)
        for segment, spectrum in zip(segments, block.spectra(model, segments), strict=True):
            reference = segment.spectrum(block.predict(model, segment.test))
            np.testing.assert_allclose(spectrum, reference, rtol=1e-9, atol=1e-9 * np.abs(reference).max())


LIBRARY: list[type[Effect]] = [
    *library().values(), *general_terms(Block.SPECIMEN)
]  # fmt: skip
FORCES = [
    kind for kind in LIBRARY
    if issubclass(kind, SteppedEffect) and kind.role in (Role.FORCE, Role.FORCE_READING)
]  # fmt: skip


@pytest.mark.parametrize("kind", FORCES, ids=lambda kind: kind.name)
def test_a_kernel_is_proportional_and_blind_to_velocity_where_it_says_so(kind):
    displacement = np.sin(0.3 * np.arange(200.0)) * np.linspace(0.2, 2.0, 200)
    slow = Motion3(
        values=np.stack([displacement, np.gradient(displacement, 0.1), np.cos(displacement)]), step=0.1
    )
    fast = replace(slow, values=slow.values + np.array([[0.0], [0.7], [0.3]]))
    values = np.array([0.37 + 0.11 * place for place in range(len(kind.parameters))])
    numbers = kind.from_values(values).coefficients(Setting(step=0.1, stiffness=5.0))
    force = follow(kind.kernel, tuple(numbers), slow)
    if kind.kernel.by_path:
        np.testing.assert_array_equal(follow(kind.kernel, tuple(numbers), fast), force)
    if kind.kernel.linear is not None:
        numbers[kind.kernel.linear] *= -3.0
        np.testing.assert_allclose(follow(kind.kernel, tuple(numbers), slow), -3.0 * force, rtol=1e-12)


def test_whitened_residuals_have_the_noise_of_the_remainder(problem, model_fit):
    second_noise = problem.noise_of(model_fit.space, model_fit.coordinates)
    np.testing.assert_allclose(
        problem.noise_left(model_fit.residual, model_fit.noise).weights, second_noise.weights
    )


def test_another_noise_needs_no_simulation(problem, model_fit):
    with patch.object(SpecimenBlock, "spectra", side_effect=AssertionError):
        second = reweight_fit(problem, model_fit)
    simulation = problem.whiten(model_fit.space, model_fit.coordinates, second.noise)
    np.testing.assert_allclose(second.residual, simulation, rtol=1e-9, atol=1e-9)
    fresh = jacobian(problem.sketch, model_fit.space, model_fit.coordinates, second.noise)
    assert np.abs(second.jacobian - fresh).max() < 0.05 * np.abs(fresh).max()


def exact_jacobian(problem, space, coordinates, noise, step=1e-3):
    centre = problem.whiten(space, coordinates, noise)
    displacement = coordinates + step * np.eye(space.size)
    return np.stack([(problem.whiten(space, item, noise) - centre) / step for item in displacement], axis=1)


def test_derivatives_of_the_sketch_are_those_of_the_model(problem, model_fit):
    assert problem.sketch.block.every > 1
    sketch_value = jacobian(problem.sketch, model_fit.space, model_fit.coordinates, model_fit.noise)
    exact = exact_jacobian(problem, model_fit.space, model_fit.coordinates, model_fit.noise)
    size = np.linalg.norm(exact, axis=0)
    assert (np.linalg.norm(sketch_value - exact, axis=0) < 0.15 * size).all()
    sharp = sharpen_fit(problem, model_fit).jacobian
    fine = exact_jacobian(problem, model_fit.space, model_fit.coordinates, model_fit.noise, step=1e-6)
    assert (np.linalg.norm(sharp - fine, axis=0) < 1e-3 * size).all()


def test_sketch_of_a_late_actuator_has_its_derivatives(campaign):
    block = ActuatorBlock(campaign, scales_of(campaign, motions_of(campaign)))
    segments = cut_segments(campaign.training, RATE, lambda _: 40.0, block.sketch.every)
    problem, space = Problem(block=block, segments=segments), ModelSpace(block, ())
    noise = NoiseModel.white(RATE, 1e-8)
    sketch_value = jacobian(problem.sketch, space, np.zeros(space.size), noise)
    exact = exact_jacobian(problem, space, np.zeros(space.size), noise)
    assert np.linalg.norm(sketch_value - exact) < 0.02 * np.linalg.norm(exact)


def test_settled_fit_simulates_no_more_than_needed(problem, model_fit):
    settled_fit = refine_fit(problem, model_fit)
    with patch.object(SpecimenBlock, "spectra", autospec=True, side_effect=SpecimenBlock.spectra) as simulate:
        refine_fit(problem, settled_fit)
    assert simulate.call_count <= 2 + settled_fit.space.size


def test_linear_algebra_keeps_to_one_thread_while_fits_run_side_by_side(diagnosis_of, blas_threads):
    diagnosis_of("rig_b")
    assert {threads for pools in blas_threads["before"] for threads in pools} == {2}
    assert {threads for pools in blas_threads["while"] for threads in pools} == {1}
    assert blas_threads["after"] == blas_threads["before"]


def test_coordinates_at_their_bounds_are_the_parameters_bounds(problem):
    space = ModelSpace(problem.block, (type(FRICTION),))
    lower, upper = space.bounds
    for bounds, extreme in ((lower, "lower"), (upper, "upper")):
        values = space.values(bounds)
        reference = [p.coordinate_bounds[extreme == "upper"] for p in space.parameters]
        result = [
            p.coordinate(v, problem.block.scales) for p, v in zip(space.parameters, values, strict=True)
        ]
        assert result == pytest.approx(reference)
    point = 0.3 * np.clip(upper, None, 2.0) + 0.7 * np.clip(lower, -2.0, None)
    assert space.coordinates(space.values(point)) == pytest.approx(point)
    assert space.find_bounds(point) == ()
    keys = space.find_bounds(upper)
    assert len(set(keys)) == space.size
    assert space.find_bounds(upper - 5e-5) == keys
    assert space.find_bounds(upper - 2e-4) == space.find_bounds(lower + 2e-4) == ()
    physical = [p.signed and abs(p.lower) < 1e-9 for p in space.parameters]
    low = tuple(key for key, limit in zip(keys, physical, strict=True) if not limit)
    assert space.find_bounds(lower + 5e-5) == low


def test_standard_deviations_are_those_of_draws_and_of_the_model_error(problem):
    """Small deviations of the coordinates become those of the values; a hundredth of a per cent is added."""
    space = ModelSpace(problem.block, (type(FRICTION),))
    coordinates_drawn = np.full(space.size, 0.2)
    spread = 1e-3 * np.arange(1.0, space.size + 1.0)
    draws = coordinates_drawn + spread * np.random.default_rng(2).standard_normal((2000, space.size))
    spread_of_draws = np.std([space.values(item) for item in draws], axis=0)
    result = space.standard_deviations(coordinates_drawn, np.diag(spread**2))
    assert result == pytest.approx(
        np.hypot(spread_of_draws, 1e-4 * space.values(coordinates_drawn)), rel=0.06
    )
    single = space.standard_deviations(coordinates_drawn, np.zeros((space.size, space.size)))
    assert single == pytest.approx(1e-4 * np.abs(space.values(coordinates_drawn)))


@pytest.mark.parametrize("tests", [(0,), (0, 1), (0, 1, 2)])
def test_tests_are_left_out_one_at_a_time_and_pieces_of_a_single_one(problem, tests):
    subset = replace(problem, segments=tuple(s for s in problem.segments if s.test in tests))
    space = ModelSpace(problem.block, ())
    start = fit(subset, space, [np.zeros(space.size)], NoiseModel.white(RATE, NOISE**2))
    errors = leave_out(subset, start)
    assert errors.energies.size == (len(tests) if len(tests) > 1 else len(subset.segments))
    complete = sum(np.sum(subset.measured(s.test)[s.begin : s.end] ** 2) for s in subset.segments)
    assert errors.signals.sum() == pytest.approx(complete, rel=0.02)
    lengths = [
        power * (s.end - s.begin) for power, s in zip(relative_powers(subset), subset.segments, strict=True)
    ]
    assert errors.units.sum() == pytest.approx(sum(lengths))


@pytest.mark.slow
@pytest.mark.parametrize(("frequency", "fewest"), [(0.8, 120.0), (6.0, 180.0)])
def test_sketch_of_a_closed_loop_has_its_derivatives_at_fewer_steps(frequency, fewest):
    structure = Structure(frequency=frequency, damping_ratio=0.03)
    time = np.arange(0.0, 8.0, 1.0 / RATE)
    ground = np.sin(2.0 * np.pi * 1.3 * time) * np.sin(np.pi * time / time[-1]) ** 2
    channels = {Channel.GROUND: ground, Channel.MEASURED: 0.01 * ground}
    tests = tuple(
        MeasuredTest(file=f"{k}", motion="wave", held_out=k == 1, channels=channels) for k in range(2)
    )
    campaign = Campaign(
        name="", structure=structure, mass=1000.0, actuator=Actuator(delay=0.001), specimen=None, rate=RATE,
        tests=tests,
    )  # fmt: skip
    motions = motions_of(campaign)
    block = LoopBlock(campaign, scales_of(campaign, motions), motions)
    assert fewest <= RATE / block.sketch.every < 0.6 * RATE / block.every
    segments = cut_segments(campaign.training, RATE, lambda _: 10.0, block.sketch.every)
    problem, noise = Problem(block=block, segments=segments), NoiseModel.white(RATE, 1e-8)
    space = ModelSpace(block, ())
    sketch_value, exact = (
        find(problem, space, np.zeros(space.size), noise) for find in (jacobian, exact_jacobian)
    )
    size = np.linalg.norm(exact, axis=0)
    assert (np.linalg.norm(sketch_value - exact, axis=0) < 0.05 * size).all()
