"""From all fitted models of a block to the names that the data support."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit, transferred
from reliab.discrepancy.fitting.left_out import refitted
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.locating.locate import locate
from reliab.discrepancy.locating.noise_test import LARGEST_STRUCTURED_SHARE, is_noise, structured_share
from reliab.discrepancy.naming.estimates import calibration, estimates
from reliab.discrepancy.naming.further_test import expected_error
from reliab.discrepancy.naming.offset_rival import OffsetRival, offset_rival
from reliab.discrepancy.naming.offsets import offset_odds, offsets
from reliab.discrepancy.naming.ranking import SURE, believed, probability, ranking
from reliab.discrepancy.naming.unexplained import unexplained
from reliab.discrepancy.proof import gap, held_out_nrmse, residuals
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Ranked
from reliab.discrepancy.result.missing_effect import MissingEffect, Rival
from reliab.discrepancy.terms import is_outside
from reliab.effects import Effect

MOST_SURE = 0.99
"""Largest probability that is stated where what the best model leaves fails the noise test."""

_RIVALS = 4


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Draw the conclusions from the search of a block."""
    problem, calibrated = search.problem, search.null
    ranked = ranking(search)
    best, named, doubtful = believed(ranked, calibrated)
    judged = _judged_by_noise(problem, best)
    noise = is_noise(*judged)
    structured = structured_share(*judged)
    most = 1.0 if structured <= LARGEST_STRUCTURED_SHARE else MOST_SURE
    bounds = best.space.on_bounds(best.coordinates)
    naming = _Naming(search=search, ranked=ranked, best=best, proof=proof, most=most, bounds=bounds)
    shifts = [naming.offset(kind, offset_rival(search, best, kind)) for kind in offsets(search, best)]
    biases = [shift for shift in shifts if shift.probability >= SURE]
    before = residuals(proof, search.plain(), without=[bias.effect for bias in biases])
    after = residuals(proof, best)
    proved = gap(proof, before, after)
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
            *biases,
        ),
        doubtful=tuple(naming.missing(kind) for kind in inside if kind in doubtful),
        uncertain_offsets=tuple(shift for shift in shifts if shift not in biases),
        unknown=unexplained(judged, best, proved, noise=noise),
        findings=locate(judged[0], _as_judged(problem, calibrated, *judged), judged[1].noise),
        residuals_before=_by_file(proof, before),
        residuals_after=_by_file(proof, after),
        gap=proved,
        structured_share=structured,
        leaves_noise=noise,
        calibration=calibration(best),
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

    def offset(self, effect: type[Effect], rival: OffsetRival | None) -> MissingEffect:
        """State an offset against models in which it is zero, with the best other effect in its place."""
        odds = offset_odds(self.best, effect)
        relative = np.exp(np.minimum([0.0, -odds, -np.inf if rival is None else rival.odds], 700.0))
        shares = (relative / relative.sum()).tolist()
        problem = self.search.problem
        neutral = self.best.space.neutralised(self.best.coordinates, [effect])
        place = self.best.space.places(effect).start
        moved = refitted(self.best, np.zeros(problem.rows, dtype=bool), (place,))
        smaller = min((replace(self.best, coordinates=x) for x in (neutral, moved)), key=self._error)
        rivals = () if rival is None else (self._rival(rival.effect.label(), shares[2], rival.fit),)
        return self._stated(effect, shares[0], smaller, rivals)

    def _rival(self, name: str, sure: float, fitted: Fit) -> Rival:
        return Rival(name=name, probability=sure, held_out_nrmse=self._error(fitted))

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
        """Models that hold one other effect in the place of this one.

        The same effect at another place along the block is none of them: left-out tests or the likelihood
        decide where it acts, and no probability is stated of that.
        """
        kept = set(self.best.space.effects) - {effect}
        rivals: list[Rival] = []
        for ranked in self.ranked:
            effects = set(ranked.fit.space.effects)
            added = effects - kept
            names = {rival.label() for rival in added}
            if kept <= effects and len(added) == 1 and names != {effect.label()}:
                (name,) = names
                rivals.append(self._rival(name, ranked.probability, ranked.fit))
            if len(rivals) == _RIVALS:
                break
        return tuple(rivals)


def _by_file(proof: Problem, residuals: dict[int, Array]) -> dict[str, Array]:
    return {proof.block.tests[test].file: values for test, values in residuals.items()}
