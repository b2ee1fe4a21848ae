"""Fitting a candidate model to a block by free-run simulation, with everything else refitted."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.effects.effect import Effect
from reliab.signals.noise import NoiseModel

_STEP, _LEAST_STEP = 1e-3, 1e-6  # of a prior's standard deviation, for derivatives
_FINE = 0.1  # of a parameter's deviation if all others were known, for derivatives near the fit
_NEGLIGIBLE = 0.02  # nats
_BOUND_MARGIN = 1e-6  # from a bound, in standard deviations of the prior
_SMALL = 1.0  # nats
_FIRST_DAMPING, _MOST_DAMPING = 1e-3, 1e6
_MOST_STEPS = 12
_MOST_ROUNDS = 10
_MOST_CORRECTIONS = 4  # of a sketch
_CONVERGENCE = 0.5  # nats


@dataclass(frozen=True, kw_only=True, eq=False)
class Fit:
    """A model fitted to a problem."""

    space: ModelSpace  # Which model
    coordinates: Array  # Most probable coordinates, shape (size,)
    residual: Array  # Whitened residual there, shape (rows,)
    jacobian: Array  # Its derivatives, shape (rows, size)
    noise: NoiseModel  # Noise by which it is whitened
    log_volume: float  # Normalisation of the likelihood

    @cached_property
    def free(self) -> NDArray[np.bool_]:
        """Whether a coordinate lies within its bounds and not on one, shape (size,)."""
        lower, upper = self.space.bounds
        return np.asarray(
            (self.coordinates > lower + _BOUND_MARGIN) & (self.coordinates < upper - _BOUND_MARGIN)
        )

    @cached_property
    def basis(self) -> Array:
        """Orthonormal directions in which free coordinates change the residual, shape (rows, free)."""
        return np.linalg.qr(self.jacobian[:, self.free])[0]

    def neutralise(self, offsets: Sequence[type[Effect]]) -> "Fit":
        """Return the same model, in which the parameters of some offsets are zero."""
        coordinates = self.coordinates.copy()
        for offset in offsets:
            coordinates[self.space.places(offset)] = 0.0
        return replace(self, coordinates=coordinates)

    @cached_property
    def precision(self) -> Array:
        """Inverse covariance of the coordinates, shape (size, size)."""
        return np.asarray(self.jacobian.T @ self.jacobian + np.eye(self.space.size), dtype=np.float64)

    @cached_property
    def covariance(self) -> Array:
        """Covariance of the coordinates, shape (size, size)."""
        return np.asarray(np.linalg.inv(self.precision), dtype=np.float64)

    @property
    def loss(self) -> float:
        """Negative logarithm of the posterior density, up to a constant of the problem and its noise."""
        return _objective(self.residual, self.coordinates)

    @property
    def log_likelihood(self) -> float:
        """Whittle log-likelihood, up to a constant of the problem."""
        return self.log_volume - 0.5 * float(self.residual @ self.residual)

    @property
    def log_evidence(self) -> float:
        """Logarithm of the marginal likelihood, by Laplace's approximation."""
        prior = -0.5 * float(self.coordinates @ self.coordinates)
        return self.log_likelihood + prior - 0.5 * float(np.linalg.slogdet(self.precision)[1])


def fit(problem: Problem, space: ModelSpace, starts: Sequence[Array], noise: NoiseModel) -> Fit:
    """Fit a model from several starts and keep the best."""
    fits = [_fit_from(problem, space, start, noise) for start in starts]
    return min(fits, key=lambda candidate: candidate.loss)


def refine_fit(problem: Problem, fitted_model: Fit) -> Fit:
    """Fit noise and model in turn, until the evidence settles."""
    for _ in range(_MOST_ROUNDS):
        next_fit = improve_fit(problem, reweight_fit(problem, fitted_model))
        is_settled = abs(next_fit.log_evidence - fitted_model.log_evidence) < _CONVERGENCE
        fitted_model = next_fit
        if is_settled:
            break
    return fitted_model


def fit_without_memory(problem: Problem, fitted_model: Fit) -> tuple[Problem, Fit]:
    """Fit the same model to a specimen that knows from the beginning how far it will be moved."""
    forgetful_problem = replace(problem, block=problem.block.without_memory())
    space = ModelSpace(forgetful_problem.block, fitted_model.space.effects)
    rough = fit(forgetful_problem, space, [fitted_model.coordinates], fitted_model.noise)
    return forgetful_problem, refine_fit(forgetful_problem, rough)


def as_judged_by_noise(problem: Problem, fitted_model: Fit) -> tuple[Problem, Fit]:
    """Return the problem and the model as noise judges them, where they were judged in the channel's unit."""
    if not problem.flat:
        return problem, fitted_model
    plain = replace(problem, tempering=(), powers=())
    noise = plain.noise_of(fitted_model.space, fitted_model.coordinates)
    residual = plain.whiten(fitted_model.space, fitted_model.coordinates, noise)
    return plain, replace(fitted_model, noise=noise, residual=residual)


def reweight_fit(problem: Problem, fitted_model: Fit) -> Fit:
    """Return the same model judged by the noise that it leaves, without simulating it again."""
    noise = problem.noise_left(fitted_model.residual, fitted_model.noise)
    factors = problem.reweighting(fitted_model.noise, noise)
    return replace(
        fitted_model,
        residual=factors * fitted_model.residual,
        jacobian=factors[:, np.newaxis] * fitted_model.jacobian,
        noise=noise,
        log_volume=problem.log_volume(noise),
    )


def _fit_from(problem: Problem, space: ModelSpace, start: Array, noise: NoiseModel) -> Fit:
    """Fit a model to the sketch, where that is faster, and then to the problem itself."""
    sketch, x = problem.sketch, np.clip(start, *space.bounds)
    residual = sketch.whiten(space, x, noise)
    begun = Fit(
        space=space,
        coordinates=x,
        residual=residual,
        jacobian=jacobian(sketch, space, x, noise, residual),
        noise=noise,
        log_volume=problem.log_volume(noise),
    )
    rough = _improve(sketch, begun, _MOST_STEPS)
    if sketch is problem:
        return rough
    return improve_fit(problem, replace(rough, residual=problem.whiten(space, rough.coordinates, noise)))


def improve_fit(
    problem: Problem, fitted_model: Fit, steps: int = _MOST_STEPS, *, differentiate_last: bool = True
) -> Fit:
    """Improve a fit until a step promises less than 0.02, by simulations of the sketch where that is faster.

    What the sketch errs by at the fit is taken off what it predicts nearby, and again where that leads.
    Unless it is to be differentiated, derivatives after the last step are those before it.
    """
    if problem.sketch is problem:
        return _improve(problem, fitted_model, steps, differentiate_last=differentiate_last)
    for _ in range(_MOST_CORRECTIONS):
        near = CorrectedSketch(problem.sketch, fitted_model)
        foreseen = _improve(near, fitted_model, steps, differentiate_last=differentiate_last)
        if foreseen.coordinates is fitted_model.coordinates:
            return foreseen
        residual = problem.whiten(foreseen.space, foreseen.coordinates, foreseen.noise)
        exact = replace(foreseen, residual=residual)
        if not exact.loss < fitted_model.loss:
            break
        fitted_model = exact
        if abs(exact.loss - foreseen.loss) < _NEGLIGIBLE or not differentiate_last:
            break
    return fitted_model


class CorrectedSketch:
    """A problem predicted at fewer instants, without what that errs by at a fitted model."""

    def __init__(self, sketch: Problem, fitted_model: Fit) -> None:
        self._sketch, self._fit = sketch, fitted_model

    @cached_property
    def _error(self) -> Array:
        """What the sketch errs by at the fitted model, shape (rows,); its derivatives are right."""
        fit = self._fit
        return self._sketch.whiten(fit.space, fit.coordinates, fit.noise) - fit.residual

    def whiten(self, space: ModelSpace, coordinates: Array, noise: NoiseModel) -> Array:
        """Residuals of unit variance if the model is right, shape (rows,)."""
        return self._sketch.whiten(space, coordinates, noise) - self._error


def _improve(
    problem: Problem | CorrectedSketch, fitted_model: Fit, steps: int, *, differentiate_last: bool = True
) -> Fit:
    """Improve a fit by Levenberg–Marquardt with bounds and the prior.

    It ends, too, after a small step that reached what the quadratic model promised: derivatives have not
    changed, and the next step would be smaller still. Where no step keeps its promise, derivatives are taken
    once more over a part of the deviations that they imply: data may say far more of a parameter than its
    prior.
    """
    space, noise = fitted_model.space, fitted_model.noise
    lower, upper = space.bounds
    x, residual, derivatives = fitted_model.coordinates, fitted_model.residual, fitted_model.jacobian
    value = fitted_model.loss
    damping, is_fine = _FIRST_DAMPING, False
    for number in range(steps):
        curvature = derivatives.T @ derivatives + np.eye(x.size)
        slope = derivatives.T @ residual + x
        is_accepted = is_rejected = foreseen = False
        while damping < _MOST_DAMPING:
            step = solve_bounded_step(curvature, slope, lower - x, upper - x, damping)
            trial = np.clip(x + step, lower, upper)
            promise = -slope @ step - 0.5 * step @ curvature @ step
            if promise < _NEGLIGIBLE:
                break
            residual_after = problem.whiten(space, trial, noise)
            decrease = value - _objective(residual_after, trial)
            if decrease > 0.0:
                x, residual, is_accepted = trial, residual_after, True
                foreseen = bool(promise < _SMALL and abs(decrease - promise) < _NEGLIGIBLE)
                value -= decrease
                damping = max(0.1 * damping, 1e-7)
                break
            is_rejected = True
            damping *= 8.0
        is_stuck = is_rejected and not (is_accepted or is_fine)
        if not (is_accepted or is_stuck) or foreseen or (number + 1 == steps and not differentiate_last):
            break
        if is_stuck:
            damping, is_fine = _FIRST_DAMPING, True
        derivatives = jacobian(problem, space, x, noise, residual, _fine_steps(derivatives))
    return replace(fitted_model, coordinates=x, residual=residual, jacobian=derivatives)


def solve_bounded_step(curvature: Array, slope: Array, least: Array, high: Array, damping: float) -> Array:
    """Damped Newton step: the minimum of the quadratic model within the bounds."""
    damped_curvature = curvature + damping * np.diag(np.diag(curvature))
    step: Array = np.asarray(-np.linalg.solve(damped_curvature, slope), dtype=np.float64)
    if ((step >= least) & (step <= high)).all():
        return step
    root = np.linalg.cholesky(damped_curvature)
    high = np.maximum(high, least + 1e-12)
    target = -np.linalg.solve(root, slope)
    solution = scipy.optimize.lsq_linear(root.T, target, bounds=(least, high), method="bvls")
    return np.asarray(solution.x)


def _objective(residual: Array, coordinates: Array) -> float:
    return 0.5 * float(residual @ residual + coordinates @ coordinates)


def sharpen_fit(problem: Problem, fitted: Fit) -> Fit:
    """Return a fitted model with derivatives of full predictions, for its standard deviations."""
    steps = _fine_steps(fitted.jacobian)
    exact = jacobian(problem, fitted.space, fitted.coordinates, fitted.noise, fitted.residual, steps)
    return replace(fitted, jacobian=exact)


def _fine_steps(derivatives: Array) -> Array:
    """Choose steps for derivatives from derivatives nearby, shape (size,)."""
    deviations = 1.0 / np.maximum(np.linalg.norm(derivatives, axis=0), _FINE)
    return np.asarray(np.clip(_FINE * deviations, _LEAST_STEP, _STEP))


def jacobian(
    problem: Problem | CorrectedSketch,
    space: ModelSpace,
    coordinates: Array,
    noise: NoiseModel,
    centre: Array | None = None,
    steps: Array | None = None,
) -> Array:
    """Differentiate the whitened residual, shape (rows, size).

    `centre`: the one there, shape (rows,), where it was computed; `steps`: over which, shape (size,).
    """
    _, upper = space.bounds
    lengths = np.full(space.size, _STEP) if steps is None else steps
    if centre is None:
        centre = problem.whiten(space, coordinates, noise)
    columns = np.empty((centre.size, space.size))
    offsets = [place for offset in space.block.offsets for place in range(space.size)[space.places(offset)]]
    # Offsets first: the motion that a block simulated last is still remembered, and they leave it as it is.
    for place in dict.fromkeys([*offsets, *range(space.size)]):
        step = lengths[place] if coordinates[place] + lengths[place] < upper[place] else -lengths[place]
        trial = coordinates.copy()
        trial[place] += step
        columns[:, place] = (problem.whiten(space, trial, noise) - centre) / step
    return columns
