"""From all fitted models of a block to the names that the data support."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fitting.fit import Fit, transferred
from reliab.discrepancy.fitting.left_out import left_out, refitted
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import COST, MATERIAL, Search
from reliab.discrepancy.locating.line_above import line_above
from reliab.discrepancy.locating.locate import locate
from reliab.discrepancy.locating.noise_test import is_noise, structured_share
from reliab.discrepancy.locating.standstill import standstill
from reliab.discrepancy.naming.further_test import expected_error
from reliab.discrepancy.proof import gap, held_out_nrmse, residuals
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Ranked
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.result.missing_effect import Estimate, MissingEffect, Rival, Unknown
from reliab.discrepancy.terms import OutsideTerm, is_outside
from reliab.discrepancy.terms.periodic import Disturbance
from reliab.loop.effects import Effect

Array = NDArray[np.float64]

SURE = 0.9
"""Probability from which an effect is named."""

MOST_SURE = 0.99
"""Largest probability that is stated where what the best model leaves is no noise."""

LARGEST_REMAINDER = 0.25
"""Energy that may remain unexplained, over the energy that the effects took away, where they are `named`.

The remainder is then less than half of what was found, in RMS. Beyond it the verdict is `unknown_effect`."""

SMALLEST_GAP = 0.1
"""RMS of a remainder over that of the signal from which it is called an effect where no effect was found."""

_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_RIVALS = 4
_NOTHING = 1e-8  # SI value of a parameter whose lower bound stands a hair below zero
_SMALLEST_OFFSET = 2e-3  # of the channel's RMS


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Say what a searched block shows.

    Parameters
    ----------
    search : Search
        All fitted models that matter against each of their sub-models.
    proof : Problem
        The same block on held-out tests.

    Returns
    -------
    BlockDiagnosis
        Names, doubts, places and proof.
    """
    problem, calibrated = search.problem, search.null
    ranked = ranking(search)
    best, named, doubtful = _believed(ranked, calibrated)
    judged = _judged_by_noise(problem, best)
    noise = is_noise(*judged)
    most = 1.0 if noise else MOST_SURE
    biases = _offsets(search, best)
    before = residuals(proof, search.plain(), without=biases)
    after = residuals(proof, best)
    proved = gap(proof, before, after)
    bounds = best.space.on_bounds(best.coordinates)
    naming = _Naming(search=search, ranked=ranked, best=best, proof=proof, most=most, bounds=bounds)
    inside = [kind for kind in best.space.effects if not is_outside(kind)]
    return BlockDiagnosis(
        block=problem.block,
        problem=problem,
        proof=proof,
        calibrated=calibrated,
        best=best,
        ranked=ranked,
        effects=(
            *(naming.missing(kind) for kind in inside if kind in named),
            *(naming.offset(kind) for kind in biases),
        ),
        doubtful=tuple(naming.missing(kind) for kind in inside if kind in doubtful),
        unknown=_unexplained(judged, best, proved, noise=noise),
        findings=locate(judged[0], _as_judged(problem, calibrated, *judged), judged[1].noise),
        residuals_before=_by_file(proof, before),
        residuals_after=_by_file(proof, after),
        gap=proved,
        structured_share=structured_share(*judged),
        leaves_noise=noise,
        calibration=_calibration(best),
        further=expected_error(search.error(best)),
    )


def _judged_by_noise(problem: Problem, best: Fit) -> tuple[Problem, Fit]:
    """Return the problem and the model as noise judges them, where they were judged in the channel's unit."""
    if not problem.flat:
        return problem, best
    plain = replace(problem, tempering=(), powers=())
    noise = plain.noise_of(best.space, best.coordinates)
    return plain, transferred(plain, replace(best, noise=noise))


def _as_judged(problem: Problem, calibrated: Fit, plain: Problem, best: Fit) -> Fit:
    """Return the calibrated model with derivatives whitened as noise judges them."""
    factors = np.sqrt(problem.densities(calibrated.noise) / plain.densities(best.noise))
    return replace(calibrated, jacobian=factors[:, np.newaxis] * calibrated.jacobian)


def ranking(search: Search) -> tuple[Ranked, ...]:
    """Fitted models with their probabilities, the most probable first."""
    ordered = sorted(search.fitted.values(), key=search.score, reverse=True)
    weights = np.exp(np.array([search.score(fit) for fit in ordered]) - search.score(ordered[0]))
    shares = (weights / weights.sum()).tolist()
    if search.problem.flat:
        _place(search, ordered)
    return tuple(Ranked(fit=fit, probability=share) for fit, share in zip(ordered, shares, strict=True))


def _place(search: Search, ordered: list[Fit]) -> None:
    """Let the likelihood of all tests tell where along the block the effects of the first model act.

    Models that differ in nothing but that have the same names and as many parameters. A test in which the
    place shows best is missing where it is left out, so that left-out tests often do not tell; the other
    model then takes the first one's rank, and its own rank goes to that one.
    """
    first = ordered[0]
    names = sorted(effect.label() for effect in first.space.effects)
    for rank, rival in enumerate(ordered[1:], start=1):
        same = sorted(effect.label() for effect in rival.space.effects) == names
        if same and search.error(first).undecided(search.error(rival)):
            if rival.log_evidence > first.log_evidence:
                ordered[0], ordered[rank] = rival, first
            return


def probability(ranked: Sequence[Ranked], effect: type[Effect]) -> float:
    """Probability that an effect acts, in whichever variant: of all models that contain it together."""
    label = effect.label()
    return float(sum(r.probability for r in ranked if label in {e.label() for e in r.fit.space.effects}))


def _believed(ranked: Sequence[Ranked], null: Fit) -> tuple[Fit, set[type[Effect]], set[type[Effect]]]:
    """Return the model that is believed, its effects that are named, and those of which one acts."""
    best = ranked[0].fit
    effects = best.space.effects
    named = {effect for effect in effects if probability(ranked, effect) >= SURE}
    rest = set(effects) - named
    fewer = sum(r.probability for r in ranked if len(r.fit.space.effects) < len(effects))
    doubtful = rest if not named and fewer < _NEGLIGIBLE else set()
    return _fit_with(ranked, named | doubtful) or null, named, doubtful


def _fit_with(ranked: Sequence[Ranked], effects: set[type[Effect]]) -> Fit | None:
    return next((r.fit for r in ranked if set(r.fit.space.effects) == effects), None)


def estimates(effect: type[Effect], fitted: Fit) -> tuple[Estimate, ...]:
    """Parameters of an effect with their standard deviations, SI units."""
    place = fitted.space.places(effect)
    values = fitted.space.values(fitted.coordinates)[place]
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)[place]
    return tuple(
        Estimate(
            name=parameter.name, value=value if abs(value) > _NOTHING else 0.0, sd=sd, units=parameter.units
        )
        for parameter, value, sd in zip(effect.parameters, values.tolist(), spread.tolist(), strict=True)
    )


def _calibration(fitted: Fit) -> tuple[Estimate, ...]:
    """Calibrated values with their standard deviations."""
    values = fitted.space.values(fitted.coordinates)
    spread = fitted.space.standard_deviations(fitted.coordinates, fitted.covariance)
    return tuple(
        Estimate(name=c.parameter.name, value=float(values[k]), sd=float(spread[k]), units=c.parameter.units)
        for k, c in enumerate(fitted.space.block.calibrations)
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Naming:
    """What is needed to state an effect: all models, the believed one, and the held-out tests."""

    search: Search
    ranked: Sequence[Ranked]
    best: Fit
    proof: Problem
    most: float
    bounds: tuple[str, ...]

    def missing(self, effect: type[Effect]) -> MissingEffect:
        """State an effect of the library."""
        smaller = self.search.without(self.best, effect)
        return self._stated(effect, probability(self.ranked, effect), smaller, self._rivals(effect))

    def offset(self, effect: type[Effect]) -> MissingEffect:
        """State an offset; its rivals are models in which it is zero."""
        odds = offset_odds(self.best, effect)
        sure = 1.0 / (1.0 + float(np.exp(-min(odds, 700.0))))
        problem = self.search.problem
        neutral = self.best.space.neutralised(self.best.coordinates, [effect])
        place = self.best.space.places(effect).start
        moved = refitted(self.best, np.zeros(problem.rows, dtype=bool), (place,))
        smaller = min((replace(self.best, coordinates=x) for x in (neutral, moved)), key=self._error)
        return self._stated(effect, sure, smaller, ())

    def _stated(
        self, effect: type[Effect], sure: float, smaller: Fit, rivals: tuple[Rival, ...]
    ) -> MissingEffect:
        key = f"{effect.name}."
        return MissingEffect(
            effect=effect,
            probability=min(sure, self.most),
            estimates=estimates(effect, self.best),
            rivals=rivals,
            error_with=self._error(self.best),
            error_without=self._error(smaller),
            on_bounds=tuple(name.removeprefix(key) for name in self.bounds if name.startswith(key)),
        )

    def _error(self, fitted: Fit) -> float:
        return held_out_nrmse(self.proof, residuals(self.proof, fitted))

    def _rivals(self, effect: type[Effect]) -> tuple[Rival, ...]:
        """Models that hold one other effect in the place of this one."""
        kept = set(self.best.space.effects) - {effect}
        rivals: list[Rival] = []
        for ranked in self.ranked:
            effects = set(ranked.fit.space.effects)
            added = effects - kept
            if kept <= effects and len(added) == 1 and effect not in effects:
                name = next(iter(added)).label()
                rivals.append(
                    Rival(name=name, probability=ranked.probability, held_out_nrmse=self._error(ranked.fit))
                )
            if len(rivals) == _RIVALS:
                break
        return tuple(rivals)


def _offsets(search: Search, best: Fit) -> list[type[Effect]]:
    """Offsets that are significant, large enough to matter, and that help to predict left-out tests."""
    return [kind for kind in search.problem.block.offsets if _is_offset(search, best, kind)]


def _is_offset(search: Search, best: Fit, kind: type[Effect]) -> bool:
    problem = search.problem
    if offset_odds(best, kind) <= 0.0:
        return False
    place = best.space.places(kind).start
    values = np.concatenate([problem.block.measured(s.test)[s.begin : s.end] for s in problem.segments])
    if abs(float(best.space.values(best.coordinates)[place])) < _SMALLEST_OFFSET * float(values.std()):
        return False
    share = 1.0 - MATERIAL if problem.flat else 1.0
    return search.error(best).energy <= share * left_out(problem, best, (place,)).energy


def offset_odds(fitted: Fit, offset: type[Effect]) -> float:
    """Logarithm of the odds that an offset is not zero, by the ratio of Savage and Dickey."""
    place = fitted.space.places(offset).start
    variance = float(fitted.covariance[place, place])
    at_zero = -0.5 * float(fitted.coordinates[place]) ** 2 / variance - 0.5 * np.log(variance)
    return float(-at_zero - COST)


def _unexplained(judged: tuple[Problem, Fit], best: Fit, proved: Gap, *, noise: bool) -> Unknown | None:
    """Return what acts and is none of the library, or a remainder that is too large beside what was found."""
    problem = judged[0]
    outside = [kind for kind in best.space.effects if issubclass(kind, OutsideTerm)]
    interrupted = _interrupted(problem, judged[1], proved.after)
    if interrupted is not None:
        return interrupted
    if outside:
        return _unknown(outside, best, proved.after)
    disturbance = _disturbance(problem, judged[1], proved.after)
    if disturbance is not None:
        return disturbance
    return None if noise else _remainder(problem, best, proved)


def _remainder(problem: Problem, best: Fit, proved: Gap) -> Unknown | None:
    """Return an error of the model that is large beside what was found, or beside the signal."""
    large = proved.unexplained_share > LARGEST_REMAINDER if best.space.effects else True
    if not (large and proved.model_error > SMALLEST_GAP):
        return None
    return Unknown(
        block=str(problem.block.block),
        expression="",
        description="what remains follows the motion, and no effect or term that was tried explains it",
        held_out_nrmse=proved.after,
    )


def _unknown(outside: Sequence[type[OutsideTerm]], best: Fit, error: float) -> Unknown:
    terms = []
    for effect in outside:
        values = ", ".join(f"{e.name} = {e.value:.4g} {e.units}" for e in estimates(effect, best))
        terms.append(f"{effect.expression} ({values})")
    description = "; ".join(effect.description for effect in outside)
    return Unknown(
        block=str(outside[0].block),
        expression=" + ".join(terms),
        description=description,
        held_out_nrmse=error,
    )


def _interrupted(problem: Problem, best: Fit, error: float) -> Unknown | None:
    """Return what is seen of a reading that stands still now and then."""
    seen = standstill(problem, best)
    if seen is None:
        return None
    return Unknown(
        block=str(problem.block.block),
        expression=f"{problem.block.channel} held {seen.events} times, for {seen.seconds:.3g} s as a rule",
        description="the reading stands still now and then while the model moves on: the sensor drops out",
        held_out_nrmse=error,
    )


def _disturbance(problem: Problem, best: Fit, error: float) -> Unknown | None:
    """Return what is seen of a disturbance at frequencies that are too high to judge models."""
    line = line_above(problem, best)
    if line is None:
        return None
    return Unknown(
        block=str(problem.block.block),
        expression=f"{line.amplitude:.4g} N sin(2π {line.frequency:.4g} Hz t + phase)",
        description=Disturbance.description,
        held_out_nrmse=error,
    )


def _by_file(proof: Problem, residuals: dict[int, Array]) -> dict[str, Array]:
    return {proof.block.tests[test].file: values for test, values in residuals.items()}
