"""Fits of models that are linear in their coordinates, where every answer has a closed form."""

from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from scipy import optimize, stats

from reliab.discrepancy.fitting.fit import (
    Fit,
    fit,
    improve_fit,
    jacobian,
    refine_fit,
    sharpen_fit,
    solve_bounded_step,
)
from reliab.discrepancy.fitting.left_out import LeftOut, _is_determined, refit
from reliab.discrepancy.fitting.problem import Problem, observations, real_parts, relative_powers
from reliab.discrepancy.fitting.screening import screen_effects
from reliab.discrepancy.segment import Segment
from reliab.signals.noise import NoiseModel

ROWS, SIZE = 60, 4
RNG = np.random.default_rng(1)
MATRIX = RNG.standard_normal((ROWS, SIZE)) * [3.0, 1.0, 10.0, 0.3]
TARGET = RNG.standard_normal(ROWS) + MATRIX @ [0.5, -1.0, 0.2, 2.0]
NOISE = NoiseModel.white(100.0, 1.0)
BLOCK = SimpleNamespace(offsets=())


class Linear:
    """A problem whose whitened residual is the target minus a matrix times the coordinates."""

    def __init__(self):
        self.simulated = 0

    @property
    def sketch(self):
        return self

    def whiten(self, _space, coordinates, _noise):
        self.simulated += 1
        return TARGET - MATRIX @ coordinates

    def log_volume(self, _noise):
        return -7.0


def space_of(reach=np.inf):
    bounds = (np.full(SIZE, -reach), np.full(SIZE, reach))
    return SimpleNamespace(bounds=bounds, size=SIZE, effects=(), block=BLOCK, places=lambda effect: effect)


def stack_prior():
    """The rows of the data and of the normal prior."""
    return np.vstack([MATRIX, np.eye(SIZE)]), np.concatenate([TARGET, np.zeros(SIZE)])


def test_derivatives_near_a_fit_are_taken_over_a_tenth_of_the_deviations():
    places = []
    point = np.array([0.5, -1.0, 0.2, 2.0])

    class Watched(Linear):
        def whiten(self, _space, coordinates, _noise):
            places.append(coordinates - point)
            return TARGET - 1e3 * MATRIX @ coordinates

    loud = Watched()
    residual = loud.whiten(None, point, None)
    model_fit = Fit(
        space=space_of(), coordinates=point, residual=residual, jacobian=-1e3 * MATRIX, noise=NOISE,
        log_volume=0.0,
    )  # fmt: skip
    sharp = sharpen_fit(loud, model_fit)
    steps = np.abs(places[1:]).max(axis=0)
    np.testing.assert_allclose(steps, 0.1 / (1e3 * np.linalg.norm(MATRIX, axis=0)), rtol=1e-6)
    np.testing.assert_allclose(sharp.jacobian, model_fit.jacobian, rtol=1e-4, atol=1e-2)


@pytest.mark.parametrize(("evidence", "rounds"), [([0.0, 10.0, 10.4, 99.0], 2), ([5.0, 5.4, 99.0], 1)])
def test_noise_and_model_are_fitted_in_turn_until_half_a_nat(evidence, rounds):
    states = [SimpleNamespace(log_evidence=value) for value in evidence]
    following = dict(zip(map(id, states), states[1:], strict=False))
    with (
        patch("reliab.discrepancy.fitting.fit.reweight_fit", lambda _problem, model_fit: model_fit),
        patch(
            "reliab.discrepancy.fitting.fit.improve_fit", lambda _problem, model_fit: following[id(model_fit)]
        ),
    ):
        assert refine_fit(None, states[0]) is states[rounds]


def test_a_linear_model_is_fitted_by_ridge_regression_and_in_few_steps():
    problem = Linear()
    result = fit(problem, space_of(), [np.zeros(SIZE), np.ones(SIZE)], NOISE)
    assert result.coordinates == pytest.approx(np.linalg.lstsq(*stack_prior(), rcond=None)[0], abs=0.05)
    assert result.jacobian == pytest.approx(-MATRIX, abs=1e-8)
    assert result.residual == pytest.approx(TARGET - MATRIX @ result.coordinates)
    assert problem.simulated < 40


@pytest.mark.parametrize("reach", [0.1, 0.6])
def test_fit_within_bounds_equals_bounded_least_squares(reach):
    reference = optimize.lsq_linear(*stack_prior(), bounds=(-reach, reach)).x
    result = fit(Linear(), space_of(reach), [np.zeros(SIZE)], NOISE)
    assert result.coordinates == pytest.approx(reference, abs=0.05)
    is_on_bound = np.isclose(np.abs(reference), reach, rtol=1e-6)
    assert (result.free == ~is_on_bound).all()
    assert is_on_bound.any()


def test_the_best_of_several_starts_is_kept_by_likelihood_and_prior():
    """Two optima, of which one fits a little better and the other is far more probable beforehand."""

    class TwoOptima(Linear):
        def whiten(self, _space, coordinates, _noise):
            x = coordinates[0]
            return np.array([10.0 * min(abs(x - 5.0), abs(x - 0.5) + 0.02)])

    bounds = (np.full(1, -9.0), np.full(1, 9.0))
    space = SimpleNamespace(bounds=bounds, size=1, effects=(), block=BLOCK)
    result = fit(TwoOptima(), space, [np.array([4.9]), np.array([0.6])], NOISE)
    assert result.coordinates[0] == pytest.approx(0.5, abs=0.1)


def test_the_evidence_of_a_linear_model_is_the_marginal_density():
    """Of y = A x + e, with normal x and e, the density is that of a normal y with covariance A Aᵀ + 1."""
    best = np.linalg.lstsq(*stack_prior(), rcond=None)[0]
    exact = Fit(
        space=space_of(),
        coordinates=best,
        residual=TARGET - MATRIX @ best,
        jacobian=-MATRIX,
        noise=NOISE,
        log_volume=-0.5 * ROWS * np.log(2.0 * np.pi),
    )
    covariance = MATRIX @ MATRIX.T + np.eye(ROWS)
    assert exact.log_evidence == pytest.approx(stats.multivariate_normal(cov=covariance).logpdf(TARGET))
    assert exact.covariance == pytest.approx(np.linalg.inv(MATRIX.T @ MATRIX + np.eye(SIZE)))
    assert exact.log_likelihood == pytest.approx(stats.norm.logpdf(exact.residual).sum())


def test_derivatives_step_away_from_the_upper_bound():
    steps = []

    class Watched(Linear):
        def whiten(self, space, coordinates, noise):
            steps.append(coordinates)
            return super().whiten(space, coordinates, noise)

    point = np.array([0.5, 0.4995, -0.5, 0.498])
    assert jacobian(Watched(), space_of(0.5), point, NOISE) == pytest.approx(-MATRIX, abs=1e-8)
    displacement = np.array(steps[1:]) - steps[0]
    assert np.diag(displacement) == pytest.approx([-1e-3, -1e-3, 1e-3, 1e-3])


@pytest.mark.parametrize("damping", [0.0, 0.5, 20.0])
def test_a_bounded_step_minimises_the_damped_quadratic_model(damping):
    curvature = MATRIX.T @ MATRIX + np.eye(SIZE)
    slope = np.array([4.0, -9.0, 2.0, 1.0])
    damped_curvature = curvature + damping * np.diag(np.diag(curvature))
    far, near = np.full(SIZE, 99.0), np.array([1e-3, 2e-2, 9.0, 1e-3])
    assert solve_bounded_step(curvature, slope, -far, far, damping) == pytest.approx(
        -np.linalg.solve(damped_curvature, slope)
    )
    result = solve_bounded_step(curvature, slope, -near, near, damping)
    reference = optimize.minimize(
        lambda x: slope @ x + 0.5 * x @ damped_curvature @ x,
        np.zeros(SIZE),
        jac=lambda x: slope + damped_curvature @ x,
        bounds=list(zip(-near, near, strict=True)),
        method="L-BFGS-B",
        options={"ftol": 1e-15, "gtol": 1e-10},
    ).x
    assert result == pytest.approx(reference, abs=1e-6)


def test_immovable_coordinate_stays_while_the_others_step():
    """Bounds that meet, as of a coordinate that lies on the only value it may have."""
    curvature, slope = np.diag([2.0, 5.0]), np.array([-4.0, -10.0])
    least, largest = np.array([-9.0, 0.0]), np.array([9.0, 0.0])
    assert solve_bounded_step(curvature, slope, least, largest, 0.0) == pytest.approx([2.0, 0.0], abs=1e-9)


def fit_at(coordinates):
    return Fit(
        space=space_of(),
        coordinates=coordinates,
        residual=TARGET - MATRIX @ coordinates,
        jacobian=-MATRIX,
        noise=NOISE,
        log_volume=0.0,
    )


def test_a_fit_improves_from_anywhere_and_not_beyond_its_steps():
    start = fit_at(np.full(SIZE, 30.0))
    best = np.linalg.lstsq(*stack_prior(), rcond=None)[0]
    assert improve_fit(Linear(), start).coordinates == pytest.approx(best, abs=0.05)
    assert improve_fit(Linear(), start, 0).coordinates == pytest.approx(start.coordinates)
    problem = Linear()
    improve_fit(problem, fit_at(best))
    assert problem.simulated == 0  # a step from there promises nothing


class Sketched(Linear):
    """A problem with a sketch that errs by a part of every derivative, and by a constant."""

    def __init__(self, share):
        super().__init__()
        self.share = share

    @property
    def sketch(self):
        return SimpleNamespace(
            whiten=lambda _space, x, _noise: TARGET + 2.0 - (MATRIX * (1.0 + self.share)) @ x
        )


def test_fit_by_a_sketch_reaches_the_optimum_with_few_full_simulations():
    """A sketch that is off by 15 % of the derivatives: each correction leaves a part of the way to go."""
    best = np.linalg.lstsq(*stack_prior(), rcond=None)[0]
    problem = Sketched(0.15 * np.cos(np.arange(SIZE)))
    result = fit(problem, space_of(), [np.zeros(SIZE)], NOISE)
    assert result.loss - fit_at(best).loss < 0.1
    assert result.residual == pytest.approx(TARGET - MATRIX @ result.coordinates)
    assert problem.simulated <= 5


def test_misleading_sketch_leaves_a_fit_where_it_was():
    start = fit_at(np.linalg.lstsq(*stack_prior(), rcond=None)[0] + 0.1)
    result = improve_fit(Sketched(-1.5), start)
    assert result.loss <= start.loss


@pytest.mark.parametrize("fixed", [(), (2,)])
def test_without_some_rows_a_linear_model_is_the_ridge_regression_of_the_others(fixed):
    excluded_rows = np.arange(ROWS) % 3 == 0
    rows, target = stack_prior()
    kept_rows = np.concatenate([~excluded_rows, np.ones(SIZE, dtype=bool)])
    free = [k for k in range(SIZE) if k not in fixed]
    reference = np.zeros(SIZE)
    reference[free] = np.linalg.lstsq(rows[kept_rows][:, free], target[kept_rows], rcond=None)[0]
    assert refit(fit_at(np.array([0.3, -0.7, 0.1, 1.0])), excluded_rows, fixed) == pytest.approx(
        reference, abs=1e-8
    )


@pytest.mark.parametrize("reach", [0.4, 0.8])
def test_without_some_rows_a_fit_stays_within_its_bounds(reach):
    excluded_rows = np.arange(ROWS) % 3 == 0
    rows, target = stack_prior()
    kept_rows = np.concatenate([~excluded_rows, np.ones(SIZE, dtype=bool)])
    reference = optimize.lsq_linear(rows[kept_rows], target[kept_rows], bounds=(-reach, reach)).x
    model_fit = replace(fit_at(np.array([0.3, -0.35, 0.1, 0.2])), space=space_of(reach))
    assert refit(model_fit, excluded_rows, ()) == pytest.approx(reference, abs=1e-6)
    assert (np.isclose(np.abs(reference), reach)).any()


@pytest.mark.parametrize(("size", "is_determined"), [(0.9, False), (1.1, True)])
def test_an_effect_is_determined_where_its_data_say_more_than_its_prior(size, is_determined):
    """A single row of length s leaves the variance 1/(1 + s²) of a prior variance of one."""
    rows = np.zeros((2, SIZE))
    rows[0, 1], rows[1, 3] = size, 9.0
    model_fit = replace(fit_at(np.zeros(SIZE)), jacobian=rows)
    model_fit.space.effects = (slice(1, 2), slice(3, 4))
    assert _is_determined(model_fit, np.ones(2, dtype=bool)) is is_determined
    assert not _is_determined(model_fit, np.array([True, False]))


def errors_of(energies, foretold=(True, True, True)):
    return LeftOut(
        energies=np.array(energies),
        signals=np.array([10.0, 20.0, 70.0]),
        units=np.array([2.0, 4.0, 5.0]),
        foretold=np.array(foretold),
    )


def test_errors_on_left_out_tests_are_relative_to_their_unit():
    error = errors_of([1.0, 3.0, 5.0])
    assert error.relative == pytest.approx([0.5, 0.75, 1.0])
    assert error.energy == pytest.approx(2.25)
    assert error.nrmse == pytest.approx(0.3)
    rival = errors_of([2.0, 4.0, 1.0])
    assert error.is_at_most(1.023, rival)
    assert not error.is_at_most(1.022, rival)
    partly = errors_of([1.0, 3.0, 5.0], foretold=(True, True, False))
    assert partly.is_at_most(0.626, rival)
    assert not partly.is_at_most(0.624, rival)


RATE = 64.0
TIME = np.arange(0.0, 32.0, 1.0 / RATE)


def problem_of(**changes):
    rng = np.random.default_rng(2)
    reading = {0: rng.standard_normal(TIME.size), 1: 3.0 * rng.standard_normal(TIME.size)}
    block = SimpleNamespace(
        rate=RATE,
        measured=reading.__getitem__,
        highest_signal=20.0,
        motions=[
            SimpleNamespace(values=np.stack([np.sin(k * TIME) + 5.0, k * np.cos(k * TIME)]))
            for k in (2.0, 9.0)
        ],
    )
    segments = tuple(
        Segment(test=test, begin=begin, end=end, rate=RATE, highest=15.0)
        for test, begin, end in ((0, 0, 1024), (0, 1024, 2048), (1, 512, 1536))
    )
    return Problem(block=block, segments=segments, **changes)


@pytest.mark.parametrize(("size", "is_kept"), [(1e12, True), (1e60, False), (np.nan, False)])
def test_a_simulation_that_runs_away_is_bad_by_no_more_than_a_limit(size, is_kept):
    """A step towards it would be by 1e-60 of a parameter, and its square is no number."""
    problem = problem_of()
    problem.block.spectra = lambda _model, segments: [np.full(s.bins, size + 0j) for s in segments]
    rows = problem.whiten(SimpleNamespace(model=lambda _: None), np.zeros(SIZE), NoiseModel.white(RATE, 1.0))
    assert rows.size == problem.rows
    assert bool(np.abs(rows).max() > 1e11) is is_kept
    assert np.isfinite(rows @ rows)


def test_swings_are_counted_between_four_and_twenty_four():
    """A sine of ω rad/s swings ω/π times a second; the two tests hold 32 and 16 s of it."""
    counts = observations(problem_of())
    assert counts[0] == pytest.approx(2.0 / np.pi * 32.0, rel=0.01)
    assert counts[1] == 24.0
    first = problem_of()
    assert observations(replace(first, segments=first.segments[:1]))[0] == pytest.approx(
        32.0 / np.pi, rel=0.02
    )
    slow = replace(
        first,
        block=SimpleNamespace(
            **{
                **vars(first.block),
                "motions": [SimpleNamespace(values=np.stack([np.sin(0.1 * TIME), 0.1 * np.cos(0.1 * TIME)]))]
                * 2,
            }
        ),
    )
    assert observations(slow)[0] == 4.0


def test_whitened_noise_has_unit_variance():
    density = np.linspace(1.0, 9.0, 500)
    noise = np.random.default_rng(3).standard_normal((2, 400, 500)) * np.sqrt(0.5 * density)
    rows = np.array(
        [real_parts(real + 1j * imaginary, np.sqrt(density)) for real, imaginary in noise.transpose(1, 0, 2)]
    )
    assert rows.shape == (400, 999)
    assert rows[:, 1:].var(axis=0).mean() == pytest.approx(1.0, rel=0.01)
    assert real_parts(np.array([6.0 + 0j]), np.array([2.0])) == pytest.approx([3.0])


def test_tests_count_alike_but_for_weak_ones():
    problem = problem_of()
    squares = [np.mean(problem.measured(0) ** 2), np.mean(problem.measured(1)[512:1536] ** 2)]
    reference = np.array([squares[0], squares[0], squares[1]]) + 0.05 * squares[1]
    assert relative_powers(problem) == pytest.approx(reference)


def test_tempering_leaves_so_many_observations_in_each_test():
    problem = problem_of()
    tempered_problem = problem.temper({0: 24.0, 1: 1e9})
    rows = 2 * problem.segments[0].bins - 1
    assert problem.rows == 3 * rows
    assert tempered_problem.tempering == pytest.approx((24.0 / (2 * rows), 24.0 / (2 * rows), 1.0))
    assert tempered_problem.powers == pytest.approx(relative_powers(problem))
    assert (problem.flat, tempered_problem.flat) == (False, True)


def test_normalisation_equals_that_of_whittles_likelihood():
    """Every complex frequency counts once with its density, the real one at zero by half."""
    noise = NoiseModel(rate=RATE, weights=np.array([2.0, 0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    problem = problem_of()
    density = [segment.density(noise) for segment in problem.segments]
    volumes = [0.5 * np.log(d[0]) + np.log(d[1:]).sum() for d in density]
    assert problem.log_volume(noise) == pytest.approx(-sum(volumes))
    tempered_problem = problem.temper({0: 24.0, 1: 12.0})
    assert tempered_problem.log_volume(noise) == pytest.approx(-np.dot(tempered_problem.tempering, volumes))
    assert problem.densities(noise) == pytest.approx(np.concatenate([[*d, *d[1:]] for d in density]))
    twice = NoiseModel(rate=RATE, weights=4.0 * noise.weights)
    assert problem.reweighting(noise, twice) == pytest.approx(np.full(problem.rows, 0.5))


def test_noise_where_errors_judge_is_their_mean_square_relative_to_the_channel():
    problem = problem_of().temper({0: 24.0, 1: 12.0})
    unit = NoiseModel.white(RATE, 1.0)
    residual = np.random.default_rng(4).standard_normal(problem.rows)
    share = np.array(problem.tempering)[problem.owners]
    # a whitened row is √(share/power) times the error
    reference = np.sum(share * residual**2 / share) / share.sum()
    assert problem.noise_left(residual, unit).weights[0] == pytest.approx(reference)


class Kind(SimpleNamespace):
    __hash__ = object.__hash__


@pytest.mark.parametrize("size", [0.3, 0.02])
def test_promise_is_the_energy_explained_by_a_linear_effect(size, monkeypatch):
    """What is left of its direction beside the free coordinates of the parent, projected on the residual."""
    direction = np.random.default_rng(5).standard_normal(ROWS)
    parent = fit_at(np.linalg.lstsq(MATRIX, TARGET, rcond=None)[0])
    promise = promise_of(parent, size * direction, monkeypatch)
    solution = np.linalg.lstsq(np.column_stack([MATRIX, direction]), TARGET, rcond=None)
    energy = parent.residual @ parent.residual
    assert promise.gain == pytest.approx(0.5 * (energy - solution[1][0]))
    assert size * promise.start[SIZE] == pytest.approx(solution[0][SIZE])
    assert len(promise.others) == 2


def test_effect_without_change_promises_nothing(monkeypatch):
    parent = fit_at(np.linalg.lstsq(MATRIX, TARGET, rcond=None)[0])
    assert promise_of(parent, np.zeros(ROWS), monkeypatch).gain == 0.0


def promise_of(parent, change, monkeypatch):
    """What an effect promises whose coordinate of one changes the predicted rows by `change`."""
    parent.space.block = None
    kind = Kind(parameters=(SimpleNamespace(signed=True),))

    class Problem(Linear):
        def whiten(self, space, coordinates, noise):
            if coordinates.size == SIZE:
                return super().whiten(space, coordinates, noise)
            return super().whiten(space, coordinates[:SIZE], noise) - coordinates[SIZE] * change

    problem = Problem()
    long_segment = SimpleNamespace(
        starts=lambda _space, x: iter([np.append(x, 1.0), np.append(x, 0.5)]),
        scale_size=lambda start, _kind, factor: np.append(start[:SIZE], factor * start[SIZE]),
    )
    monkeypatch.setattr("reliab.discrepancy.fitting.screening.ModelSpace", lambda *_: long_segment)
    (promise,) = screen_effects(problem, parent, [kind], null=None)
    return promise


def test_foreseen_step_needs_no_new_derivatives():
    """From near the optimum one step reaches it, and the derivatives of a linear model have not changed."""
    best = np.linalg.lstsq(*stack_prior(), rcond=None)[0]
    problem, near = Linear(), fit_at(best + 0.05 * np.eye(SIZE)[0])
    result = improve_fit(problem, near)
    assert result.coordinates == pytest.approx(best, abs=2e-4)
    assert problem.simulated == 1


def test_noise_beside_a_converter_excludes_its_steps():
    """Rounding to steps adds a variance of a twelfth of a step's square to that of the noise."""
    rng = np.random.default_rng(8)
    step, noise = 0.01, 0.005
    signal = np.sin(np.linspace(0.0, 60.0, 60_000))
    reading = step * np.round((signal + noise * rng.standard_normal(signal.size)) / step)
    block = SimpleNamespace(measured=lambda _test: reading, interpolate=lambda prediction, _test: prediction)
    problem = Problem(block=block, segments=(SimpleNamespace(test=0),))
    with (
        patch.object(Problem, "predictions", return_value={0: signal}),
        patch(
            "reliab.discrepancy.fitting.problem.expect_rounding_error", return_value=0.0 * signal
        ) as reference,
    ):
        problem.correct_conversion(space_of(), np.zeros(SIZE))
    _, found_step, spread, level = reference.call_args.args
    assert found_step == pytest.approx(step)
    assert spread == pytest.approx(noise, rel=0.008)
    assert level == reading[0]


def test_the_least_noise_beside_a_converter_is_a_share_of_its_error_squared():
    """Two tests with steps of 1 and 3: half of (1² + 3²) twelfths."""
    levels = {test: step * np.tile([0.0, 1.0, 2.0, 1.0], 500) for test, step in enumerate((1.0, 3.0, 7.0))}
    block = SimpleNamespace(measured=levels.get)
    problem = Problem(block=block, segments=tuple(SimpleNamespace(test=test) for test in levels))
    assert problem.least_noise == 0.0
    corrected_value = replace(problem, conversion={0: 0.0, 1: 0.0})
    assert corrected_value.least_noise == pytest.approx(0.2 * 5.0 / 12.0)


def test_starts_are_compared_by_likelihood_and_half_the_square_of_the_coordinates():
    """The far optimum is likelier by 4.7 and less probable beforehand by 3²/2."""

    class TwoValleys(Linear):
        def whiten(self, _space, coordinates, _noise):
            x = coordinates[0]
            far = x > 1.5
            return np.array([1e3 * (x - (3.0 if far else 0.0)), 0.0 if far else np.sqrt(2.0 * 4.7)])

    bounds = (np.full(1, -9.0), np.full(1, 9.0))
    space = SimpleNamespace(bounds=bounds, size=1, effects=(), block=BLOCK)
    result = fit(TwoValleys(), space, [np.array([0.001]), np.array([2.999])], NOISE)
    assert result.coordinates[0] == pytest.approx(3.0, abs=1e-3)
