"""The error of a model on each test when its parameters are fitted to the others, in the channel's own unit.

This is the second measure beside the evidence. It uses no noise model: what a model gains at
frequencies at which the channel hardly moves does not count, and a parameter that only follows one test
costs on the next. Where noise judges, refitting without a test is one Newton step from the fit to all of
them, within the bounds, unless derivatives foresee another error than it leaves; where errors judge, models
are refitted in full, because one step may lead far astray.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.fit import Fit, improve_fit, solve_bounded_step
from reliab.discrepancy.fitting.problem import Problem, relative_powers
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.segment import Segment, energy_of

_RAN_AWAY = 1e300
_PRIOR_SHARE = 0.5  # of a parameter's prior variance: data and prior say as much of it
_STEPS = 2  # of a refit without one test, from the fit to all of them
_UNFORESEEN = 0.05  # share of the energy by which a step leaves more than derivatives foresee


@dataclass(frozen=True, kw_only=True, eq=False)
class LeftOut:
    """Errors on tests, or on quarters of a single one, that were left out one at a time."""

    energies: Array  # Energy of the residual at the judged frequencies of each left-out test, shape (tests,)
    signals: Array  # Energy of the channel there, shape (tests,)
    units: Array  # Energy that counts as one in each test, shape (tests,)
    # Whether the other tests determine the effects, so that the error is one of the model, shape (tests,)
    foretold: NDArray[np.bool_]

    @property
    def relative(self) -> Array:
        """Energy of the residuals over that which counts as one, shape (tests,)."""
        return np.asarray(self.energies / self.units)

    @property
    def energy(self) -> float:
        """Relative energy of the residuals, summed over the tests, which count alike."""
        return float(self.relative.sum())

    @property
    def nrmse(self) -> float:
        """RMS of the residuals over the RMS of the channel, in parts that the others foretell, if any."""
        parts = self.foretold if self.foretold.any() else np.ones_like(self.foretold)
        return float(np.sqrt(self.energies[parts].sum() / max(self.signals[parts].sum(), 1e-300)))

    def is_at_most(self, multiple: float, rival: "LeftOut") -> bool:
        """Whether the error is at most a multiple of another model's, in tests that the others foretell."""
        foretold = self.foretold
        return float(self.relative[foretold].sum()) <= multiple * float(rival.relative[foretold].sum())


def leave_out(problem: Problem, fit: Fit, fixed: tuple[int, ...] = ()) -> LeftOut:
    """Leave out each test in turn, refit the model to the others and predict it.

    Far from the fit, with `fixed` coordinates at zero, one step may be worse than none.
    """
    energies, foretold = [], []
    for members in _parts(problem):
        excluded_rows = np.isin(problem.owners, members)
        segments, trials = [problem.segments[k] for k in members], list[float]()
        if fixed or not problem.flat:
            x = refit(fit, excluded_rows, fixed)
            trials.append(_residual_energy(problem, fit.space, x, segments))
        if fixed:
            x = fit.coordinates.copy()
            x[list(fixed)] = 0.0
            trials.append(_residual_energy(problem, fit.space, x, segments))
        elif problem.flat or trials[0] > (1.0 + _UNFORESEEN) * _foreseen_energy(
            problem, fit, excluded_rows, x
        ):
            x = _refit_fully(problem, fit, excluded_rows, members)
            trials.append(_residual_energy(problem, fit.space, x, segments))
        energies.append(min(trials))
        foretold.append(problem.flat or _is_determined(fit, ~excluded_rows))
    return _errors(problem, energies, foretold)


def _foreseen_energy(
    problem: Problem, fit: Fit, excluded_rows: NDArray[np.bool_], coordinates: Array
) -> float:
    """Energy that derivatives foresee in rows that are left out, at coordinates near the fit."""
    step = coordinates - fit.coordinates
    rows = fit.residual[excluded_rows] + fit.jacobian[excluded_rows] @ step
    return float(rows**2 @ problem.densities(fit.noise)[excluded_rows])


def errors_of_parts(problem: Problem, residual: dict[int, Array]) -> LeftOut:
    """Errors of residuals on tests that took no part in a fit, or on the parts of a single one."""
    segment_energies = [energy_of(segment.spectrum(residual[segment.test])) for segment in problem.segments]
    energies = [sum(segment_energies[k] for k in members) for members in _parts(problem)]
    return _errors(problem, energies, [True] * len(energies))


def _parts(problem: Problem) -> list[list[int]]:
    """Segments of each test, or each segment of a single one."""
    tests = [segment.test for segment in problem.segments]
    groups = tests if len(set(tests)) > 1 else list(range(len(tests)))
    return [[k for k, owner in enumerate(groups) if owner == group] for group in dict.fromkeys(groups)]


def _errors(problem: Problem, energies: Sequence[float], foretold: Sequence[bool]) -> LeftOut:
    """Put energies of residuals beside those of the channel and those that count as one."""
    powers, segments, parts = relative_powers(problem), problem.segments, _parts(problem)
    signal = [energy_of(s.spectrum(problem.measured(s.test))) for s in segments]
    unit = [power * (s.end - s.begin) for power, s in zip(powers, segments, strict=True)]
    signals, units = (np.array([sum(of[k] for k in part) for part in parts]) for of in (signal, unit))
    return LeftOut(energies=np.array(energies), signals=signals, units=units, foretold=np.array(foretold))


def _is_determined(fit: Fit, fitted_rows: NDArray[np.bool_]) -> bool:
    """Whether some rows say more of every parameter of the effects than its prior.

    A limit that a single test reaches follows from that test alone: without it nothing but the prior is left
    to predict it.
    """
    derivatives = fit.jacobian[fitted_rows]
    variances = np.diag(np.linalg.inv(derivatives.T @ derivatives + np.eye(fit.space.size)))
    places = [fit.space.places(effect) for effect in fit.space.effects]
    return all(float(variances[place].max()) < _PRIOR_SHARE for place in places)


def _residual_energy(
    problem: Problem, space: ModelSpace, coordinates: Array, segments: Sequence[Segment]
) -> float:
    """Energy that a model misses of segments of one test; a simulation that runs away misses very much."""
    predictions = problem.block.spectra(space.model(coordinates), segments)
    measured = (s.spectrum(problem.measured(s.test)) for s in segments)
    energy = sum(energy_of(one - other) for one, other in zip(measured, predictions, strict=True))
    return energy if np.isfinite(energy) else _RAN_AWAY


def _refit_fully(
    problem: Problem, fit: Fit, excluded_rows: NDArray[np.bool_], members: Sequence[int]
) -> Array:
    """Coordinates fitted without some segments, in a few steps, shape (size,)."""
    fitted_segments = [k for k in range(len(problem.segments)) if k not in members]
    reduced_problem = replace(
        problem,
        segments=tuple(problem.segments[k] for k in fitted_segments),
        tempering=tuple(problem.tempering[k] for k in fitted_segments if problem.flat),
        powers=tuple(problem.powers[k] for k in fitted_segments if problem.flat),
    )
    rows = ~excluded_rows
    start = replace(fit, residual=fit.residual[rows], jacobian=fit.jacobian[rows])
    return improve_fit(reduced_problem, start, _STEPS, differentiate_last=False).coordinates


def refit(fit: Fit, excluded_rows: NDArray[np.bool_], fixed: tuple[int, ...]) -> Array:
    """Coordinates fitted to the rows that are not left out, from the fit to all rows, shape (size,)."""
    x = fit.coordinates
    derivatives, residual = fit.jacobian[~excluded_rows], fit.residual[~excluded_rows]
    lower, upper = fit.space.bounds
    least, high = lower - x, upper - x
    for place in fixed:
        least[place] = high[place] = -x[place]
    curvature = derivatives.T @ derivatives + np.eye(x.size)
    slope = derivatives.T @ residual + x
    step = solve_bounded_step(curvature, slope, least, np.maximum(high, least + 1e-12), 0.0)
    return np.asarray(np.clip(x + step, lower, upper))
