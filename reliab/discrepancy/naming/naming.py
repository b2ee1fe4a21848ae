"""From all fitted models of a block to the names that the data support, by how probable each is."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.fit import Fit, fit, reweighted, transferred
from reliab.discrepancy.fitting.left_out import LeftOut, left_out, refitted
from reliab.discrepancy.fitting.noise_test import (
    LARGEST_STRUCTURED_SHARE,
    is_noise,
    noise_like_tests,
    structured_share,
)
from reliab.discrepancy.fitting.prior import COST, cost
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import screened
from reliab.discrepancy.fitting.search import MATERIAL, Search
from reliab.discrepancy.fitting.space import MODEL_ERROR, ModelSpace
from reliab.discrepancy.locating.locate import Finding, locate
from reliab.discrepancy.naming.unexplained import unexplained
from reliab.discrepancy.proof import gap, held_out_nrmse, residuals
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, Ranked
from reliab.discrepancy.result.gap import FurtherError
from reliab.discrepancy.result.missing_effect import (
    Estimate,
    MissingEffect,
    Rival,
    calibration,
    estimates,
    widened,
)
from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.discrepancy.terms.outside_term import is_outside
from reliab.discrepancy.terms.stated_damping import StatedDamping
from reliab.effects.effect import Effect
from reliab.effects.stroke_saturation import StrokeSaturation
from reliab.effects.viscous_damping import ViscousDamping

SURE = 0.9
"""Probability from which an effect is named."""

_DRAWS, _SEED = 1000, 20
_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_LIKELY = 0.5  # the same where clocks may differ, which changes the parameters of the other effects

MOST_SURE = 0.99
"""Largest probability that is stated where what the best model leaves fails the noise test."""

_RIVALS = 4
_MISSTATED = 0.5  # of a stated damping, by which it may be off
_LEAST_PROBABLE = 1e-3  # model that counts where parameters differ between models
_FEWEST = 3  # left-out tests from which the error on a further one is foretold
_TAILS = 0.05
_SMALLEST_OFFSET = 2e-3  # of the channel's RMS


def ranking(search: Search) -> tuple[Ranked, ...]:
    """Fitted models with their probabilities, the most probable first."""
    models = [*search.fitted.values(), *_with_clocks(search)]
    shares = _shares_of_tests(search, models) if search.problem.flat else _shares_of_scores(search, models)
    order = np.argsort(-shares, kind="stable")
    ordered = [models[k] for k in order]
    if search.problem.flat:
        _place(search, ordered)
    return tuple(
        Ranked(fit=fit, probability=share) for fit, share in zip(ordered, shares[order].tolist(), strict=True)
    )


def _with_clocks(search: Search) -> list[Fit]:
    """Models with an offset of the clocks that is too small to be named, beside effects that are needed."""
    return [
        fit
        for key, fit in search.with_clocks.items()
        if key not in search.fitted
        and key - {str(ClockOffset.name)} in search.fitted  # effects that were rejected are not needed
        and not any(
            ClockOffset in fewer.space.effects and names < key and search.score(fewer) >= search.score(fit)
            for names, fewer in search.fitted.items()
        )
    ]


def _shares_of_scores(search: Search, models: Sequence[Fit]) -> Array:
    """Probability of each model by its score, shape (models,).

    Between the first one and those with a twin of one of its effects in its place the data alone decide, and
    not how probable a gain or a size would have been before them. Simulations of one model differ, too: by
    what that may change in the likelihood none is preferred.
    """
    scores = np.array([search.score(model) for model in models])
    for place, model in enumerate(models[len(search.fitted) :], start=len(search.fitted)):
        alone = models.index(search.fitted[frozenset(model.space.names) - {str(ClockOffset.name)}])
        scores[alone] = max(scores[alone], scores[place])
    first = models[int(np.argmax(scores))]
    for place, model in enumerate(models):
        if _is_twin(search, first, model):
            unsure = 0.5 * MODEL_ERROR**2 * search.problem.loudness(first.noise)
            lost = max(first.log_likelihood - model.log_likelihood - unsure, 0.0)
            scores[place] = max(scores[place], float(scores.max()) - lost)
    return _softmax(scores)


def _is_twin(search: Search, first: Fit, rival: Fit) -> bool:
    """Whether a model differs from another by one effect, which the block may be unable to tell."""
    gone = set(first.space.effects) - set(rival.space.effects)
    added = set(rival.space.effects) - set(first.space.effects)
    if len(gone) != 1 or len(added) != 1:
        return False
    return next(iter(added)) in search.problem.block.twins.get(next(iter(gone)), ())


def _shares_of_tests(search: Search, models: Sequence[Fit]) -> Array:
    """Probability of each model by its errors on left-out tests, shape (models,).

    The tests of a campaign are a few of all that could have been run. Their weights are drawn anew from the
    flat Dirichlet distribution (the Bayesian bootstrap), and probabilities are averaged over the draws, so
    that a model that wins by a single test is not certain (pseudo-BMA+ of Yao and others, 2018,
    doi:10.1214/17-BA1091).
    """
    errors = np.stack([search.error(fit).relative for fit in models])
    weights = np.random.default_rng(_SEED).dirichlet(np.ones(errors.shape[1]), _DRAWS) * errors.shape[1]
    likelihoods = search.observations * -0.5 * np.log(np.maximum(weights @ errors.T, 1e-300))
    costs = np.array([cost(fit.space.effects) for fit in models])
    return np.asarray(_softmax(likelihoods - costs).mean(axis=0))


def _softmax(scores: Array) -> Array:
    weights = np.exp(scores - scores.max(axis=-1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def _place(search: Search, ordered: list[Fit]) -> None:
    """Decide by the likelihood of all tests where along the block the effects of the first model act.

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


def believed(ranked: Sequence[Ranked], null: Fit) -> tuple[Fit, set[type[Effect]], set[type[Effect]]]:
    """Return the model that is believed, its effects that are named, and those of which one acts."""
    best = ranked[0].fit
    effects = best.space.effects
    sure_effects = {effect for effect in effects if probability(ranked, effect) >= SURE}
    less_sure = set(effects) - sure_effects
    fewer = sum(r.probability for r in ranked if len(r.fit.space.effects) < len(effects))
    most = _LIKELY if any(effect is ClockOffset for effect in less_sure) else _NEGLIGIBLE
    doubtful = less_sure if fewer < most else set()
    return _fit_with(ranked, sure_effects | doubtful) or null, sure_effects, doubtful


def _fit_with(ranked: Sequence[Ranked], effects: set[type[Effect]]) -> Fit | None:
    return next((r.fit for r in ranked if set(r.fit.space.effects) == effects), None)


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Draw the conclusions from the search of a block."""
    problem = search.problem
    ranked = ranking(search)
    best, sure_effects, doubtful = believed(ranked, search.null)
    restated = frozenset({StatedDamping}) & sure_effects  # a contradiction of what is stated, and no effect
    calibrated = search.fitted.get(frozenset(str(kind.name) for kind in restated), search.null)
    judged = _judged_by_noise(problem, best)
    noise = is_noise(*judged)
    structured = structured_share(*judged)
    naming = _naming(search, ranked, best, proof, structured)
    shifts = [naming.offset(kind, offset_rival(search, best, kind)) for kind in offsets(search, best)]
    biases = [shift for shift in shifts if shift.probability >= SURE]
    before = residuals(proof, search.plain(calibrated), without=[bias.effect for bias in biases])
    after = residuals(proof, best)
    missing = [kind for kind in best.space.effects if kind not in restated]
    inside = [kind for kind in missing if not is_outside(kind)]
    held_out = gap(proof, before, after, noise_like_tests(proof, judged[1]))
    proved = replace(held_out, missing=bool(missing or biases))
    effects, unsettled = naming.settled(inside, sure_effects, doubtful, biases)
    remaining = None if noise else _located(problem, best, judged)
    unknown = unexplained(judged, best, proved, remaining, named=bool(effects) and not unsettled)
    return BlockDiagnosis(
        block=problem.block,
        problem=problem,
        proof=proof,
        calibrated=calibrated,
        best=best,
        ranked=ranked,
        effects=effects,
        doubtful=unsettled,
        uncertain_offsets=tuple(shift for shift in shifts if shift not in biases),
        unknown=unknown,
        findings=_located(problem, calibrated, judged),
        residuals_before=_by_file(proof, before),
        residuals_after=_by_file(proof, after),
        gap=replace(proved, missing=bool(proved.missing or unknown)),
        structured_share=structured,
        leaves_noise=noise,
        calibration=calibration(best, restated=bool(restated)),
        further=expected_error(_as_recorded(search, best)),
    )


def _naming(
    search: Search, ranked: Sequence[Ranked], best: Fit, proof: Problem, structured: float
) -> "_Naming":
    """Gather what is needed to state effects, for a share of what is left that is no noise."""
    most = 1.0 if structured <= LARGEST_STRUCTURED_SHARE else MOST_SURE
    bounds = best.space.on_bounds(best.coordinates)
    return _Naming(search=search, ranked=ranked, best=best, proof=proof, most=most, bounds=bounds)


def _as_recorded(search: Search, best: Fit) -> LeftOut:
    """Error of a model on each left-out test with all that the converter adds, as a further test has it."""
    if not search.problem.conversion:
        return search.error(best)
    return left_out(replace(search.problem, conversion={}), best)


def _judged_by_noise(problem: Problem, best: Fit) -> tuple[Problem, Fit]:
    """Return the problem and the model as noise judges them, where they were judged in the channel's unit."""
    if not problem.flat:
        return problem, best
    plain = replace(problem, tempering=(), powers=())
    noise = plain.noise_of(best.space, best.coordinates)
    return plain, transferred(plain, replace(best, noise=noise))


def _located(problem: Problem, fitted: Fit, judged: tuple[Problem, Fit]) -> tuple[Finding, ...]:
    """Find what the residual of a model varies with, as noise judges it."""
    return locate(judged[0], _as_judged(problem, fitted, *judged), judged[1].noise)


def _as_judged(problem: Problem, fitted: Fit, plain: Problem, best: Fit) -> Fit:
    """Return a fitted model with derivatives whitened as noise judges them."""
    factors = np.sqrt(problem.densities(fitted.noise) / plain.densities(best.noise))
    return replace(fitted, jacobian=factors[:, np.newaxis] * fitted.jacobian)


@dataclass(frozen=True, kw_only=True, eq=False)
class OffsetRival:
    """A model that holds an effect in the place of an offset."""

    effect: type[Effect]  # The effect
    fit: Fit  # The model, in which the offset is zero
    # Logarithm of how much more credible it is than the model with the offset, by the judge of the search
    odds: float


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
        missing = self._describe(effect, probability(self.ranked, effect), smaller, self._rivals(effect))
        others = [
            (ranked.probability, estimates(effect, ranked.fit))
            for ranked in self.ranked
            if effect in ranked.fit.space.effects and ranked.probability > _LEAST_PROBABLE
        ]
        if others:
            missing = replace(missing, estimates=widened(missing.estimates, others))
        return or_stated_damping(missing, self.search.problem.block.structure_damping)

    def settled(
        self,
        inside: Sequence[type[Effect]],
        sure: set[type[Effect]],
        doubtful: set[type[Effect]],
        biases: Sequence[MissingEffect],
    ) -> tuple[tuple[MissingEffect, ...], tuple[MissingEffect, ...]]:
        """State effects: those that are named, offsets among them, and those of which one acts."""
        likely = [effect for kind in inside if kind in sure for effect in self.members(kind)]
        doubted = [effect for kind in inside if kind in doubtful for effect in self.members(kind)]
        unsure = [effect for effect in likely if effect.probability < SURE]
        probable = [effect for effect in likely if effect.probability >= SURE]
        return (*probable, *biases), (*unsure, *doubted)

    def members(self, effect: type[Effect]) -> tuple[MissingEffect, ...]:
        """State an effect of the library, or the members of a composition."""
        members = self.missing(effect).by_member
        simple = effect.refines
        if len(members) == 1 or simple is None:
            return members
        names = frozenset(self.best.space.names) - {str(effect.name)} | {str(simple.name)}
        alone = self.search.fitted.get(names)
        return tuple(
            member
            if member.member is simple or alone is None
            else replace(member, error_without=self._error(alone))
            for member in members
        )

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
        return self._describe(effect, shares[0], smaller, rivals)

    def _rival(self, name: str, sure: float, fitted: Fit) -> Rival:
        return Rival(name=name, probability=sure, held_out_nrmse=self._error(fitted))

    def _describe(
        self, effect: type[Effect], sure: float, smaller: Fit, rivals: tuple[Rival, ...]
    ) -> MissingEffect:
        key = f"{effect.name}."
        return MissingEffect(
            effect=effect,
            probability=min(sure, self.most),
            estimates=self._estimates(effect),
            rivals=rivals,
            error_with=self._error(self.best),
            error_without=self._error(smaller),
            on_bounds=tuple(name.removeprefix(key) for name in self.bounds if name.startswith(key)),
        )

    def _estimates(self, effect: type[Effect]) -> tuple[Estimate, ...]:
        """Parameters of an effect; a converter reads the level at which a stop holds within its step."""
        fitted = estimates(effect, self.best)
        if not issubclass(effect, StrokeSaturation):
            return fitted
        rounding = max(self.search.problem.steps.values()) / np.sqrt(12.0)
        return tuple(replace(item, sd=float(np.hypot(item.sd, rounding))) for item in fitted)

    def _error(self, fitted: Fit) -> float:
        return held_out_nrmse(self.proof, residuals(self.proof, fitted))

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
            if len(rivals) == _RIVALS:
                break
        return tuple(rivals)


def or_stated_damping(damper: MissingEffect, damping: float) -> MissingEffect:
    """State a damper with its twin where it would be a misstated damping of the structure, to within half.

    `damping` [N·s/m] is that from which it cannot be told: both predict the same, and no test prefers one.
    """
    if damper.effect is not ViscousDamping or not abs(damper.estimates[0].value) < _MISSTATED * damping:
        return damper
    half = 0.5 * damper.probability
    twin = Rival(name=StatedDamping.label(), probability=half, held_out_nrmse=damper.error_with)
    return replace(damper, probability=half, rivals=(twin, *damper.rivals)[:_RIVALS])


def _by_file(proof: Problem, residuals: dict[int, Array]) -> dict[str, Array]:
    return {proof.block.tests[test].file: values for test, values in residuals.items()}


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
    if not problem.flat:
        odds = rival.log_evidence - best.log_evidence
    else:
        odds = search.likelihood(error) - search.likelihood(search.error(best))
    return OffsetRival(effect=first.kind, fit=rival, odds=odds)


def offsets(search: Search, best: Fit) -> list[type[Effect]]:
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
