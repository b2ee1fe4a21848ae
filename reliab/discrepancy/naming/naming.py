"""From all fitted models of a block to the names that the data support."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import COST, Search, score
from reliab.discrepancy.locating.line_above import line_above
from reliab.discrepancy.locating.locate import locate
from reliab.discrepancy.locating.standstill import standstill
from reliab.discrepancy.proof import gap, held_out_nrmse, residuals
from reliab.discrepancy.result import BlockDiagnosis, Estimate, MissingEffect, Ranked, Rival, Unknown
from reliab.discrepancy.terms import OutsideTerm, is_outside
from reliab.discrepancy.terms.periodic import Disturbance
from reliab.loop.effects import Effect

Array = NDArray[np.float64]

SURE = 0.9
"""Probability from which an effect is named."""

_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_RIVALS = 4


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Say what a searched block shows.

    Parameters
    ----------
    search : Search
        All fitted models.
    proof : Problem
        The same block on held-out tests.

    Returns
    -------
    BlockDiagnosis
        Names, doubts, places and proof.
    """
    problem, calibrated = search.problem, search.null
    ranked = ranking(search.fitted.values())
    named, doubtful = _believed(ranked)
    best = _fit_with(ranked, named | doubtful) or calibrated
    biases = [kind for kind in problem.block.offsets if offset_odds(best, kind) > 0.0]
    before = residuals(proof, search.plain(), without=biases)
    after = residuals(proof, best)
    inside = [kind for kind in best.space.effects if not is_outside(kind)]
    outside = [kind for kind in best.space.effects if issubclass(kind, OutsideTerm)]
    error = held_out_nrmse(proof, after)
    recorded = Problem(block=problem.block, segments=problem.segments)
    noise = recorded.noise_of(best.space, best.coordinates)
    return BlockDiagnosis(
        block=problem.block,
        problem=problem,
        proof=proof,
        calibrated=calibrated,
        best=best,
        ranked=ranked,
        effects=(
            *(_missing(kind, best, ranked, proof) for kind in inside if kind in named),
            *(_bias(kind, best) for kind in biases),
        ),
        doubtful=tuple(_missing(kind, best, ranked, proof) for kind in inside if kind in doubtful),
        unknown=_interrupted(problem, best, error)
        or (_unknown(outside, best, error) if outside else _disturbance(problem, best, error)),
        findings=locate(problem, calibrated, best.noise),
        residuals_before=_by_file(proof, before),
        residuals_after=_by_file(proof, after),
        gap=gap(proof, before, after, noise),
    )


def ranking(fits: Iterable[Fit]) -> tuple[Ranked, ...]:
    """Fitted models with their probabilities, the most probable first."""
    ordered = sorted(fits, key=score, reverse=True)
    weights = np.exp(np.array([score(one) for one in ordered]) - score(ordered[0]))
    shares = (weights / weights.sum()).tolist()
    return tuple(Ranked(fit=one, probability=share) for one, share in zip(ordered, shares, strict=True))


def probability(ranked: Sequence[Ranked], effect: type[Effect]) -> float:
    """Probability that an effect acts: of all models that contain it together."""
    return float(sum(one.probability for one in ranked if effect in one.fit.space.effects))


def _believed(ranked: Sequence[Ranked]) -> tuple[set[type[Effect]], set[type[Effect]]]:
    """Effects that are named, and those one of which acts though the data do not tell which."""
    best = ranked[0].fit.space.effects
    named = {effect for effect in best if probability(ranked, effect) >= SURE}
    rest = set(best) - named
    fewer = sum(one.probability for one in ranked if len(one.fit.space.effects) < len(best))
    return named, rest if not named and fewer < _NEGLIGIBLE else set()


def _fit_with(ranked: Sequence[Ranked], effects: set[type[Effect]]) -> Fit | None:
    return next((one.fit for one in ranked if set(one.fit.space.effects) == effects), None)


def estimates(effect: type[Effect], one: Fit) -> tuple[Estimate, ...]:
    """Parameters of an effect with their standard deviations, SI units."""
    place = one.space.places(effect)
    values = one.space.values(one.coordinates)[place]
    spread = one.space.standard_deviations(one.coordinates, one.covariance)[place]
    return tuple(
        Estimate(name=parameter.name, value=value, sd=sd, units=parameter.units)
        for parameter, value, sd in zip(effect.parameters, values.tolist(), spread.tolist(), strict=True)
    )


def _missing(effect: type[Effect], best: Fit, ranked: Sequence[Ranked], proof: Problem) -> MissingEffect:
    return MissingEffect(
        effect=effect,
        probability=probability(ranked, effect),
        estimates=estimates(effect, best),
        rivals=_rivals(effect, best, ranked, proof),
    )


def _rivals(effect: type[Effect], best: Fit, ranked: Sequence[Ranked], proof: Problem) -> tuple[Rival, ...]:
    """Models that hold one other effect in the place of this one."""
    kept = set(best.space.effects) - {effect}
    found: list[Rival] = []
    for one in ranked:
        effects = set(one.fit.space.effects)
        added = effects - kept
        if kept <= effects and len(added) == 1 and effect not in effects:
            error = held_out_nrmse(proof, residuals(proof, one.fit))
            name = str(next(iter(added)).name)
            found.append(Rival(name=name, probability=one.probability, held_out_nrmse=error))
    return tuple(found[:_RIVALS])


def offset_odds(one: Fit, offset: type[Effect]) -> float:
    """Logarithm of the odds that an offset is not zero, by the ratio of Savage and Dickey."""
    place = one.space.places(offset).start
    variance = float(one.covariance[place, place])
    at_zero = -0.5 * float(one.coordinates[place]) ** 2 / variance - 0.5 * np.log(variance)
    return float(-at_zero - COST)


def _bias(offset: type[Effect], best: Fit) -> MissingEffect:
    odds = offset_odds(best, offset)
    sure = 1.0 / (1.0 + float(np.exp(-min(odds, 700.0))))
    return MissingEffect(effect=offset, probability=sure, estimates=estimates(offset, best), rivals=())


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


def _by_file(proof: Problem, left: dict[int, Array]) -> dict[str, Array]:
    return {proof.block.tests[test].file: values for test, values in left.items()}
