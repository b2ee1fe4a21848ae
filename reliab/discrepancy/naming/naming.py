"""From all fitted models of a block to the names that the data support, by how probable each is."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import stats

from reliab.core.significant_digits import counted, percent
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.fit import Fit, as_judged_by_noise, fit, reweighted
from reliab.discrepancy.fitting.left_out import LeftOut, left_out, refitted
from reliab.discrepancy.fitting.noise_test import (
    LARGEST_STRUCTURED_SHARE,
    is_noise,
    noise_like_tests,
    structured_share,
)
from reliab.discrepancy.fitting.prior import COST
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import screened
from reliab.discrepancy.fitting.search import MATERIAL, Search
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.locating.locate import Finding, locate
from reliab.discrepancy.naming.choice import (
    SURE,
    Choice,
    best_rival,
    choose,
    explains_more_than_left,
    names_of,
    probability,
    ranking,
    remarks_on,
)
from reliab.discrepancy.naming.unexplained import unexplained
from reliab.discrepancy.proof import gap, held_out_nrmse, residuals
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Ranked
from reliab.discrepancy.result.gap import FurtherError, Gap
from reliab.discrepancy.result.missing_effect import (
    Estimate,
    MissingEffect,
    Rival,
    Unknown,
    calibration,
    estimates,
    widened,
)
from reliab.discrepancy.terms.stated_damping import StatedDamping
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import GeneralTerm, is_general
from reliab.effects.stroke_saturation import StrokeSaturation
from reliab.effects.viscous_damping import ViscousDamping

MOST_SURE = 0.99
"""Largest probability that is stated where what the best model leaves fails the noise test."""

_RIVALS = 4
_MISSTATED = 0.5  # of a stated damping, by which it may be off
_LEAST_PROBABLE = 1e-3  # model that counts where parameters differ between models
_FEWEST = 3  # left-out tests from which the error on a further one is foretold
_TAILS = 0.05
_SMALLEST_OFFSET = 2e-3  # of the channel's RMS


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Draw the conclusions from the search of a block."""
    ranked = ranking(search, proof)
    choice = choose(search, ranked, proof)
    best = choice.best.fit
    restated = frozenset({StatedDamping}) & choice.sure  # a contradiction of what is stated, and no effect
    calibrated = search.fitted.get(frozenset(str(kind.name) for kind in restated), search.null)
    judged = as_judged_by_noise(search.problem, best)
    noise, structured = is_noise(*judged), structured_share(*judged)
    naming = _Naming(search=search, ranked=ranked, choice=choice, proof=proof, structured=structured)
    effects, doubtful, uncertain = naming.settled()
    offsets = [effect.effect for effect in effects if effect.effect in best.space.block.offsets]
    before = residuals(proof, search.plain(calibrated), without=offsets)
    after = residuals(proof, best)
    measured = gap(proof, before, after, noise_like_tests(proof, judged[1]))
    missing = bool(set(best.space.effects) - restated or offsets)
    proved = naming.beside_others(replace(measured, missing=missing))
    is_named = bool(effects) and (isinstance(search, ErrorSearch) or not doubtful)
    unknown = naming.unknown(judged, proved, is_named=is_named, is_noise=noise)
    return BlockDiagnosis(
        problem=search.problem,
        proof=proof,
        calibrated=calibrated,
        ranked=ranked,
        effects=effects,
        doubtful=doubtful,
        uncertain_offsets=uncertain,
        unknown=unknown,
        findings=_located(search.problem, calibrated, judged),
        residuals_before={proof.block.tests[test].file: values for test, values in before.items()},
        residuals_after={proof.block.tests[test].file: values for test, values in after.items()},
        gap=replace(proved, missing=bool(proved.missing or unknown)),
        structured_share=structured,
        leaves_noise=noise,
        calibration=calibration(best, restated=bool(restated)),
        further=expected_error(naming.errors_as_recorded),
        believed=choice.best,
        choice_remarks=tuple(remarks_on(choice)),
        linear=naming.linear,
        refining=tuple(choice.refining),
    )


def _located(problem: Problem, fitted: Fit, judged: tuple[Problem, Fit]) -> tuple[Finding, ...]:
    """Find what the residual of a model varies with, as noise judges it."""
    plain, best = judged
    factors = np.sqrt(problem.densities(fitted.noise) / plain.densities(best.noise))
    whitened = replace(fitted, jacobian=factors[:, np.newaxis] * fitted.jacobian)
    return locate(plain, whitened, best.noise)


class OffsetRival(NamedTuple):
    """A model that holds an effect in the place of an offset, which is zero in it."""

    effect: type[Effect]
    fit: Fit
    odds: float  # Logarithm of how much more credible it is than the offset, by the judge of the search


@dataclass(frozen=True, kw_only=True, eq=False)
class _Naming:
    """What is needed to state effects: all models, the believed one, and the held-out tests."""

    search: Search
    ranked: Sequence[Ranked]
    choice: Choice
    proof: Problem
    structured: float  # Share of what is left that is no noise

    @property
    def best(self) -> Fit:
        """The believed model."""
        return self.choice.best.fit

    @property
    def kinds(self) -> list[type[Effect]]:
        """Effects of the believed model that may have a name."""
        return [kind for kind in self.best.space.effects if kind not in self.choice.refining]

    def beside_others(self, measured: Gap) -> Gap:
        """Add to a gap what the best linear model leaves, and the best model that lacks an effect."""
        linear, rival = self.search.linear, best_rival(self.ranked, self.choice.best)
        error = self._error(linear) if linear.space.effects else measured.before
        if rival is None:
            return replace(measured, linear=error)
        return replace(measured, linear=error, rival=rival.held_out, rival_effects=rival.names)

    def unknown(
        self, judged: tuple[Problem, Fit], proved: Gap, *, is_named: bool, is_noise: bool
    ) -> Unknown | None:
        """State what no effect of the library explains, beyond terms that only refine a model."""
        row, models = min(self.ranked, key=lambda row: row.held_out), counted(len(self.ranked), "model")
        return unexplained(
            judged,
            self.best,
            [kind for kind in self.kinds if issubclass(kind, GeneralTerm)],
            proved,
            None if is_noise else _located(self.search.problem, self.best, judged),
            is_named=is_named,
            tried=f"of {models} that were tried the best ({names_of(row)}) leaves {percent(row.held_out)}",
        )

    @property
    def linear(self) -> tuple[Estimate, ...]:
        """Parameters of the best linear model of a block that has one of its own."""
        linear = self.search.linear
        effects = [item for effect in linear.space.effects for item in estimates(effect, linear)]
        return (*calibration(linear), *effects) if effects else ()

    @property
    def errors_as_recorded(self) -> LeftOut:
        """Errors on left-out tests with all that the converter adds, as a further test has it."""
        if not self.search.problem.conversion:
            return self.search.error(self.best)
        return left_out(replace(self.search.problem, conversion={}), self.best)

    def settled(self) -> tuple[tuple[MissingEffect, ...], ...]:
        """State effects: those that are named, those of which one acts, and uncertain offsets.

        An offset is uncertain if another effect may stand in its place.
        """
        named: list[MissingEffect] = []
        doubted: list[MissingEffect] = []
        for kind in (kind for kind in self.kinds if not is_general(kind)):
            if kind in self.choice.sure - {StatedDamping}:
                for effect in self._members(kind):
                    (named if effect.probability >= SURE else doubted).append(effect)
        for kind in (kind for kind in self.kinds if not is_general(kind) and kind in self.choice.doubtful):
            doubted += self._members(kind)
        shifts = [self._offset(kind) for kind in self.best.space.block.offsets if self._is_offset(kind)]
        named += [shift for shift in shifts if shift.probability >= SURE]
        return tuple(named), tuple(doubted), tuple(shift for shift in shifts if shift.probability < SURE)

    def _members(self, effect: type[Effect]) -> tuple[MissingEffect, ...]:
        """State an effect of the library, or the members of a composition.

        Where no model is exact, a special form, or a member beside the first one, has a name only if it
        explains more than the whole leaves.
        """
        first, *others = self._missing(effect).by_member
        simple = effect.refines
        if simple is None:
            return (first,)
        alone = self._error(self.search.simplified(self.best, effect))
        if isinstance(self.search, ErrorSearch) and not explains_more_than_left(
            alone, self._error(self.best)
        ):
            return (first if others or simple.label() == effect.label() else first.named_as(simple),)
        return (first, *(replace(member, error_without=alone) for member in others))

    def _missing(self, effect: type[Effect]) -> MissingEffect:
        """State an effect of the library."""
        smaller = self.search.without(self.best, effect)
        missing = self._describe(effect, probability(self.ranked, effect), smaller, self._rivals(effect))
        others = [
            (ranked.probability, estimates(effect, ranked.fit))
            for ranked in self.ranked
            if effect in ranked.fit.space.effects and ranked.probability > _LEAST_PROBABLE
        ]
        if others:
            missing = replace(missing, estimates=widened(missing.estimates, others))
        return or_stated_damping(missing, self.search.problem.block.structure_damping)

    def _rivals(self, effect: type[Effect]) -> tuple[Rival, ...]:
        """Models that hold one other effect in the place of this one.

        The same effect at another place along the block is none of them: left-out tests or the likelihood
        decide where it acts, and no probability is stated of that.
        """
        other_effects = set(self.best.space.effects) - {effect}
        rivals: list[Rival] = []
        for ranked in self.ranked:
            effects = set(ranked.fit.space.effects)
            added = effects - other_effects
            names = {rival.label() for rival in added}
            if other_effects <= effects and len(added) == 1 and names != {effect.label()}:
                (name,) = names
                rivals.append(self._rival(name, ranked.probability, ranked.fit))
        return tuple(rivals[:_RIVALS])

    def _offset(self, effect: type[Effect]) -> MissingEffect:
        """State an offset against models in which it is zero, with the best other effect in its place."""
        rival = offset_rival(self.search, self.best, effect)
        odds = offset_odds(self.best, effect)
        relative = np.exp(np.minimum([0.0, -odds, -np.inf if rival is None else rival.odds], 700.0))
        shares = (relative / relative.sum()).tolist()
        neutral = self.best.space.neutralised(self.best.coordinates, [effect])
        place = self.best.space.places(effect).start
        moved = refitted(self.best, np.zeros(self.search.problem.rows, dtype=bool), (place,))
        smaller = min((replace(self.best, coordinates=x) for x in (neutral, moved)), key=self._error)
        rivals = () if rival is None else (self._rival(rival.effect.label(), shares[2], rival.fit),)
        return self._describe(effect, shares[0], smaller, rivals)

    def _is_offset(self, kind: type[Effect]) -> bool:
        """Whether an offset is significant, large enough to matter, and helps to predict left-out tests."""
        problem, best = self.search.problem, self.best
        if offset_odds(best, kind) <= 0.0:
            return False
        place = best.space.places(kind).start
        values = np.concatenate([problem.block.measured(s.test)[s.begin : s.end] for s in problem.segments])
        if abs(float(best.space.values(best.coordinates)[place])) < _SMALLEST_OFFSET * float(values.std()):
            return False
        share = 1.0 - MATERIAL if problem.flat else 1.0
        return self.search.error(best).energy <= share * left_out(problem, best, (place,)).energy

    def _rival(self, name: str, sure: float, fitted: Fit) -> Rival:
        return Rival(name=name, probability=sure, held_out_nrmse=self._error(fitted))

    def _describe(
        self, effect: type[Effect], sure: float, smaller: Fit, rivals: tuple[Rival, ...]
    ) -> MissingEffect:
        key = f"{effect.name}."
        bounds = self.best.space.on_bounds(self.best.coordinates)
        fitted = estimates(effect, self.best)
        if issubclass(effect, StrokeSaturation):  # a converter reads the level of a stop within its step
            rounding = max(self.search.problem.steps.values()) / np.sqrt(12.0)
            fitted = tuple(replace(item, sd=float(np.hypot(item.sd, rounding))) for item in fitted)
        return MissingEffect(
            effect=effect,
            probability=min(sure, 1.0 if self.structured <= LARGEST_STRUCTURED_SHARE else MOST_SURE),
            estimates=fitted,
            rivals=rivals,
            error_with=self._error(self.best),
            error_without=self._error(smaller),
            on_bounds=tuple(name.removeprefix(key) for name in bounds if name.startswith(key)),
        )

    def _error(self, fitted: Fit) -> float:
        return held_out_nrmse(self.proof, residuals(self.proof, fitted))


def or_stated_damping(damper: MissingEffect, damping: float) -> MissingEffect:
    """State a damper with its twin where it would be a misstated damping of the structure, to within half.

    `damping` [N·s/m] is that from which it cannot be told: both predict the same, and no test prefers one.
    """
    if damper.effect is not ViscousDamping or not abs(damper.estimates[0].value) < _MISSTATED * damping:
        return damper
    half = 0.5 * damper.probability
    twin = Rival(name=StatedDamping.label(), probability=half, held_out_nrmse=damper.error_with)
    return replace(damper, probability=half, rivals=(twin, *damper.rivals)[:_RIVALS])


def expected_error(errors: LeftOut) -> FurtherError | None:
    """Interval of the error on a further test, from those on tests that were left out.

    The logarithms of the errors are taken for draws from one normal distribution, of which the further test
    is another draw; the interval is Student's prediction interval.

    >>> whole, every = np.full(3, 100.0), np.ones(3, dtype=bool)
    >>> errors = LeftOut(energies=np.array([1.0, 4.0, 2.0]), signals=whole, units=np.ones(3), foretold=every)
    >>> further = expected_error(errors)
    >>> round(further.value, 3), round(further.low, 3), round(further.high, 3)
    (0.141, 0.044, 0.455)
    """
    logarithms = 0.5 * np.log(np.maximum(errors.energies, 1e-300) / np.maximum(errors.signals, 1e-300))
    count = logarithms.size
    if count < _FEWEST:
        return None
    spread = float(logarithms.std(ddof=1)) * np.sqrt(1.0 + 1.0 / count)
    reach = float(stats.t.isf(_TAILS, count - 1)) * spread
    middle = float(logarithms.mean())
    low, high = np.exp(middle - reach), np.exp(middle + reach)
    return FurtherError(value=float(np.exp(middle)), low=float(low), high=float(high), tests=count)


def offset_rival(search: Search, best: Fit, offset: type[Effect]) -> OffsetRival | None:
    """Find the effect that explains most in the place of an offset.

    Returns none where no effect promises to explain anything, or where the best of them predicts tests that
    are left out clearly worse than the offset does, whatever its evidence: a noise model fitted to the
    rival's own residual may take a constant for slow noise.
    """
    block = copy(search.problem.block)
    block.offsets = tuple(kind for kind in block.offsets if kind is not offset)
    problem = replace(search.problem, block=block)
    space = ModelSpace(block, best.space.effects)
    start = space.inherited(best.space, best.coordinates)
    without = reweighted(problem, fit(problem, space, [start], best.noise))
    promising = screened(problem, without, search.candidates, without)
    if not promising or not promising[0].gain > 0.0:
        return None
    first = promising[0]
    larger = ModelSpace(block, (*best.space.effects, first.kind))
    rival = reweighted(problem, fit(problem, larger, [first.start], without.noise))
    error = left_out(problem, rival)
    if (1.0 - MATERIAL) * error.energy > search.error(best).energy:
        return None
    odds = rival.log_evidence - best.log_evidence
    if isinstance(search, ErrorSearch):
        odds = search.likelihood(error) - search.likelihood(search.error(best))
    return OffsetRival(effect=first.kind, fit=rival, odds=odds)


def offset_odds(fitted: Fit, offset: type[Effect]) -> float:
    """Logarithm of the odds that an offset is not zero, by the ratio of Savage and Dickey."""
    place = fitted.space.places(offset).start
    variance = float(fitted.covariance[place, place])
    at_zero = -0.5 * float(fitted.coordinates[place]) ** 2 / variance - 0.5 * np.log(variance)
    return float(-at_zero - COST)
