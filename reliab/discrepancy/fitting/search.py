"""Search for missing effects of a block: forward by screening, backward by removal, judged by evidence."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.fit import (
    Fit,
    fit,
    fit_without_memory,
    refine_fit,
    reweight_fit,
    sharpen_fit,
)
from reliab.discrepancy.fitting.left_out import LeftOut, leave_out
from reliab.discrepancy.fitting.noise_test import is_model_error, is_spread
from reliab.discrepancy.fitting.prior import (
    AUDIBLE,
    COST,
    GENERAL_COST,
    LEAST_SHARE,
    MATERIAL,
    NOTICEABLE,
    cost,
)
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import (
    LIMITS,
    Promise,
    acts,
    exceeds_rounding,
    gains_beside,
    line_terms,
    screen_effects,
)
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.effects.clock_offset import ClockOffset, LateGround
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general
from reliab.effects.registry import library
from reliab.signals.noise import NoiseModel

_NO_WORSE = 0.02  # growth of the error on left-out tests that noise brings about
_AWAY = 2.0  # standard deviations between a parameter and its value without effect

MOST_EFFECTS = 3
_WORKERS = 2
_BEAM, _DEEPEST_OUTSIDE = 2, 2
_TRIES = 8
_CLOSE, _POSSIBLE, _CLEAR = 100.0, 7.0, 25.0  # nats


class Search:
    """Fit models of a block with ever more effects, and keep those that the data support."""

    def __init__(self, problem: Problem) -> None:
        self.fitted: dict[frozenset[str], Fit] = {}
        self.rejected: dict[frozenset[str], Fit] = {}
        self.with_clocks: dict[frozenset[str], Fit] = {}
        self._errors: WeakKeyDictionary[Fit, LeftOut] = WeakKeyDictionary()
        self._roughly_fitted: dict[frozenset[str], Fit] = {}
        self._promises: WeakKeyDictionary[Fit, dict[type[Effect], Promise]] = WeakKeyDictionary()
        block = problem.block
        space = ModelSpace(block, ())
        spread = np.mean([block.measured(s.test)[s.begin : s.end].var() for s in problem.segments])
        start = NoiseModel.white(block.rate, 1e-3 * float(spread))
        null = refine_fit(problem, fit(problem, space, [np.zeros(space.size)], start))
        self.problem = problem if problem.conversion else problem.correct_conversion(space, null.coordinates)
        self.null = self.keep(null if self.problem is problem else refine_fit(self.problem, null))

    @cached_property
    def linear(self) -> Fit:
        """The best linear model of the block: calibration, offsets, and its linear effects."""
        space, null = ModelSpace(self.problem.block, self.problem.block.linear), self.null
        start = next(space.starts(null.space, null.coordinates))
        return self.fit(space, [start], null.noise) if space.effects else null

    def fit(self, space: ModelSpace, starts: Sequence[Array], noise: NoiseModel) -> Fit:
        """Fit a model from some starts, with its noise."""
        return refine_fit(self.problem, fit(self.problem, space, starts, noise))

    def keep(self, candidate: Fit) -> Fit:
        """Keep a fitted model, unless one of the same effects is better or was rejected."""
        key = candidate.space.key
        if key in self.rejected:
            return candidate
        if key not in self.fitted or self.score(candidate) > self.score(self.fitted[key]):
            self.fitted[key] = candidate
        return self.fitted[key]

    def _reject(self, candidate: Fit) -> None:
        """Exclude a model from the search permanently, because one of its effects does not matter."""
        self.rejected[candidate.space.key] = candidate
        self.fitted.pop(candidate.space.key, None)

    @property
    def candidates(self) -> tuple[type[Effect], ...]:
        """Effects that may be missing."""
        return self.problem.block.candidates

    def score(self, candidate: Fit) -> float:
        """Logarithm of how credible a fitted model is, up to a constant: evidence and prior odds."""
        return candidate.log_evidence - cost(candidate.space.effects)

    def error(self, candidate: Fit) -> LeftOut:
        """Error of a model on each test when it is fitted to the others."""
        if candidate not in self._errors:
            self._errors[candidate] = leave_out(self.problem, candidate)
        return self._errors[candidate]

    @property
    def best(self) -> Fit:
        """The most credible of all fitted models."""
        return max(self.fitted.values(), key=self.score)

    def _matters(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether the additional effects of a model over a smaller one are not negligible."""
        return self._is_material(candidate, smaller) and self._needs_memory(candidate, smaller)

    def _is_material(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether additional effects explain enough, and predict left-out parts no worse."""
        rows = candidate.residual
        remaining = float(rows @ rows)
        gain = self.energy(smaller, candidate.noise) - remaining
        added_effects = set(candidate.space.effects) - set(smaller.space.effects)
        unknown = any(is_general(kind) for kind in added_effects)
        if unknown and gain < AUDIBLE * remaining:
            return False
        if smaller is self.null or self._shows_once(candidate, smaller):
            return True
        if self._is_shift(candidate, added_effects):
            return self._predicts(candidate, smaller, 1.0 + _NO_WORSE)
        closed_energy = self.energy(self.null, candidate.noise) - remaining
        if gain > LEAST_SHARE * closed_energy:
            return self._predicts(candidate, smaller, 1.0 + _NO_WORSE)
        audible = gain > MATERIAL * (remaining + gain)
        return audible and self.error(candidate).energy <= (1.0 - MATERIAL) * self.error(smaller).energy

    def _needs_memory(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether an added effect that remembers peaks explains more than the same without its memory.

        Its memory is one more assumption: without it, it may be nothing but a spring that is not linear.
        """
        added_effects = set(candidate.space.effects) - set(smaller.space.effects)
        if not any(kind.remembers_peaks for kind in added_effects):
            return True
        return self._memory_odds(candidate, *fit_without_memory(self.problem, candidate)) > 0.0

    def _memory_odds(self, candidate: Fit, _problem: Problem, forgetful: Fit) -> float:
        """Odds of a model against the same without its memory, as a logarithm."""
        return candidate.log_evidence - forgetful.log_evidence - COST

    def _is_shift(self, candidate: Fit, added_effects: set[type[Effect]]) -> bool:
        """Whether an offset of the clocks is added to a model with effects, or what looks like one there.

        It explains little beside them and still moves their parameters by far more than their deviations.
        Where what is left is no noise, an error of a coarse converter that follows the motion, likelihood
        overrates so little: it must then explain as much as any other effect.
        """
        twins = self.problem.block.twins
        if ClockOffset not in twins or len(added_effects) != 1 or not is_spread(self.problem, candidate):
            return False
        rivals = {*candidate.space.effects} - added_effects | {ClockOffset}
        rival = self.fitted.get(frozenset(str(kind.name) for kind in rivals))
        return added_effects == {ClockOffset} or (
            added_effects <= set(twins[ClockOffset]) and rival is not None
        )

    def _predicts(self, candidate: Fit, smaller: Fit, largest_ratio: float) -> bool:
        """Whether a model's error on left-out tests is at most a multiple of that of a smaller model."""
        return self.error(candidate).is_at_most(largest_ratio, self.error(smaller))

    def is_supported(self, candidate: Fit) -> bool:
        """Whether a model may be named: each of its effects matters against the models without it."""
        effects = candidate.space.effects
        if not all(self._acts(candidate, kind) for kind in effects):
            return False
        return all(
            (self._predicts(candidate, smaller, 1.0 - NOTICEABLE) or self._shows_once(candidate, smaller))
            and self._matters(candidate, smaller)
            for smaller in [self.remove_effect(candidate, kind) for kind in effects]
        )

    def _shows_once(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether a further limit clearly shows in a part from which the others do not foretell it."""
        added_effects = set(candidate.space.effects) - set(smaller.space.effects)
        if not all(issubclass(kind, LIMITS) for kind in added_effects):
            return False
        clear = candidate.log_evidence - smaller.log_evidence > _CLEAR
        return clear and not self.error(candidate).foretold.all()

    def _acts(self, candidate: Fit, kind: type[Effect]) -> bool:
        """Whether an effect's parameters are beyond their own uncertainty, and beyond a converter's steps."""
        return acts(candidate, kind, _AWAY) and exceeds_rounding(self.problem, candidate, kind)

    def energy(self, candidate: Fit, noise: NoiseModel) -> float:
        """Energy that a fitted model leaves, whitened by a given noise."""
        rows = self.problem.whiten(candidate.space, candidate.coordinates, noise)
        return float(rows @ rows)

    def with_effects(self, base: Fit, effects: Iterable[type[Effect]], start: Array | None = None) -> Fit:
        """Return the model with given effects, fitted from the parameters of another one, or from a start."""
        space = ModelSpace(base.space.block, tuple(effects))
        if space.key in self.fitted:
            return self.fitted[space.key]
        if start is None:
            start = next(space.starts(base.space, base.coordinates))
        return self.keep(self.fit(space, [start], base.noise))

    def remove_effect(self, candidate: Fit, kind: type[Effect]) -> Fit:
        """Return a model without one of its effects, refitted."""
        return self.with_effects(
            candidate, (effect for effect in candidate.space.effects if effect is not kind)
        )

    def screen(self, parent: Fit, kinds: Sequence[type[Effect]]) -> list[Promise]:
        """Give effects that may be added to a model, those of the largest promise first."""
        promises = self._promises.setdefault(parent, {})
        fresh = [kind for kind in kinds if kind not in promises]
        promises |= {one.kind: one for one in screen_effects(self.problem, parent, fresh, self.null)}
        known = [promises[kind] for kind in kinds if kind in promises]
        return sorted(known, key=lambda promise: -promise.gain)

    def extend(self, parent: Fit, promising: Sequence[Promise]) -> list[Fit]:
        """Fit a model with each of some effects added."""
        known_models = {*self.fitted, *self.rejected}
        fresh = [
            candidate
            for candidate in promising
            if candidate.start.size and parent.space.key | {str(candidate.kind.name)} not in known_models
        ]
        rough = self._rough(parent, fresh)
        least = self._worth_refining(rough, parent)

        def refine(model: Fit) -> Fit:
            return refine_fit(self.problem, model) if model.log_evidence > least else model

        with ThreadPoolExecutor(_WORKERS) as pool:
            fits = list(pool.map(refine, rough))
        kept_models = []
        for candidate in fits:
            if self._matters(candidate, parent):
                kept_models.append(self.keep(candidate))
            else:
                self._reject(candidate)
        return kept_models

    def _rough(self, parent: Fit, promising: Sequence[Promise]) -> list[Fit]:
        """Fit a model with each of some effects added, and the noise once."""

        def extend_parent(candidate: Promise) -> Fit:
            space = ModelSpace(parent.space.block, (*parent.space.effects, candidate.kind))
            if space.key not in self._roughly_fitted:
                fitted = fit(self.problem, space, self._starts(candidate), parent.noise)
                self._roughly_fitted[space.key] = reweight_fit(self.problem, fitted)
            return self._roughly_fitted[space.key]

        with ThreadPoolExecutor(_WORKERS) as pool:
            return list(pool.map(extend_parent, promising))

    def reaches_noise(self) -> bool:
        """Whether some effect after the other, added greedily, leaves what may be noise.

        Noise then judges models; parts that are left out do otherwise.
        """
        best, kinds = self.null, (*self.candidates, *self.problem.block.outside)
        for _ in range(MOST_EFFECTS):
            if not is_model_error(self.problem, best):
                return True
            promising = [one for one in self.screen(best, kinds)[:_TRIES] if one.start.size]
            rough: list[Fit] = []
            for begin in range(0, len(promising), _WORKERS):
                rough += self._rough(best, promising[begin : begin + _WORKERS])
                if not all(is_model_error(self.problem, model) for model in rough[begin:]):
                    return True
            best = refine_fit(self.problem, max(rough, key=lambda model: model.log_likelihood, default=best))
        return not is_model_error(self.problem, best)

    def _starts(self, promise: Promise) -> list[Array]:
        """Coordinates from which to fit a further effect."""
        return [promise.start]

    def _worth_refining(self, rough: Sequence[Fit], parent: Fit) -> float:
        """Log-evidence from which a rough fit is refined."""
        if not rough:
            return -np.inf
        first = max(candidate.log_evidence for candidate in rough)
        return min(0.5 * (first + parent.log_evidence), first - _CLOSE)

    def forward(self, begin: Fit, kinds: Sequence[type[Effect]], *, deepest: int = MOST_EFFECTS) -> Fit:
        """Add effects as long as the evidence grows."""
        beam, best = [begin], begin
        for _ in range(deepest):
            children: list[Fit] = []
            for parent in beam:
                promising = self.screen(parent, kinds)
                floor = max(COST, 0.02 * promising[0].gain) if promising else 0.0
                likely = [candidate for candidate in promising[:_TRIES] if candidate.gain > floor]
                children += self.extend(parent, [*likely, *self._hidden(parent, promising, likely)])
            children.sort(key=self.score, reverse=True)
            reach = [model for model in children[:_BEAM] if self._is_near(model, children[0])]
            near = [self.keep(refine_fit(self.problem, model)) for model in reach]
            beam = [*near[:1], *(candidate for candidate in near[1:] if not self._is_surpassed(candidate))]
            if not beam or self.score(beam[0]) < self.score(best):
                break
            best = beam[0]
        return self.backward(best)

    def _hidden(self, parent: Fit, promises: Sequence[Promise], likely: Sequence[Promise]) -> list[Promise]:
        """Return effects with twins, which a calibration that made up for them hides to first order.

        A noise that is fitted to what the calibrated model leaves hides them, too.
        """
        twins = self.problem.block.twins
        if parent is not self.null or not twins:
            return []
        return [promise for promise in promises if promise.kind in twins and promise not in likely]

    def _is_near(self, candidate: Fit, first: Fit) -> bool:
        """Whether a model is so close to the best one that a further effect might change the order."""
        return self.score(candidate) > 0.5 * (self.score(first) + self.score(self.null))

    def _is_surpassed(self, candidate: Fit) -> bool:
        """Whether a limiting case of an effect, whose extensions say as much, is as credible in its place."""
        effects, known_models = candidate.space.effects, {**self.rejected, **self.fitted}
        keys = (
            candidate.space.key - {str(kind.name)} | {str(simpler.name)}
            for kind in effects
            for simpler in kind.limiting_cases
            if simpler not in effects
        )
        return any(
            key in known_models and self.score(known_models[key]) >= self.score(candidate) for key in keys
        )

    def run(self, begin: Fit | None = None) -> Fit:
        """Search the library, and terms outside it where one of them would explain the remainder."""
        block = self.problem.block
        self.forward(begin or self.null, self.candidates)
        self.refine()
        library_model = self.best
        general_terms = (*block.outside, *line_terms(self.problem, library_model)) if block.outside else ()
        remaining = self.screen(library_model, general_terms)
        if not remaining or remaining[0].gain < self.noticeable(library_model):
            return library_model
        all_kinds = (*self.candidates, *general_terms)
        best = max(
            library_model, self.forward(self.null, all_kinds, deepest=_DEEPEST_OUTSIDE), key=self.score
        )
        return best if best is not library_model else self.forward(library_model, all_kinds, deepest=1)

    def rerun_converted(self) -> "Search":
        """Search again with the converter's error that the best model expects; itself if there is none."""
        best = self.best
        problem = self.problem.correct_conversion(best.space, best.coordinates)
        return self if problem is self.problem or best is self.null else self.move_to(problem)

    def move_to(self, problem: Problem) -> "Search":
        """Search on other data of the same block.

        Models that were near the best are fitted anew from where they stood; the search goes on from there.
        """
        best = self.best
        search = Search(problem)
        near = [
            candidate
            for candidate in self.fitted.values()
            if candidate is not self.null and self._is_near(candidate, best)
            if LateGround not in candidate.space.effects or LateGround in search.candidates
        ]
        with ThreadPoolExecutor(_WORKERS) as pool:
            fits = pool.map(lambda model: fit(problem, model.space, [model.coordinates], model.noise), near)
            for candidate in pool.map(lambda model: refine_fit(problem, model), fits):
                search.keep(candidate)
        search.run(search.best)
        return search

    def try_twins(self) -> None:
        """Try, in the place of every effect of the best model, those that the block may not tell from it.

        A fit begins where it was left if it was tried before.
        """
        best, twins = self.best, self.problem.block.twins
        for kind in best.space.effects:
            parent = self.remove_effect(best, kind)
            for twin in self.candidates:
                if twin not in twins.get(kind, ()) or twin in best.space.effects:
                    continue
                space = ModelSpace(best.space.block, (*parent.space.effects, twin))
                if space.key in self.fitted:
                    space, start = self.fitted[space.key].space, self.fitted[space.key].coordinates
                else:
                    start = self.screen(parent, [twin])[0].start
                if start.size:
                    candidate = self.fit(space, [start], best.noise)
                    if self._matters(candidate, parent):
                        self.keep(candidate)

    def fit_beside_clocks(self) -> None:
        """Add an offset of the clocks to the models that may be named, where it was rejected, too."""
        if ClockOffset not in self.candidates or ClockOffset not in self.problem.block.twins:
            return
        for near in [self.fitted[key] for key in self._near()]:
            smaller = self.remove_effect(near, ClockOffset) if ClockOffset in near.space.effects else near
            space = ModelSpace(smaller.space.block, (*smaller.space.effects, ClockOffset))
            if smaller.space.effects and space.key not in self.with_clocks:
                (promise,) = self.screen(smaller, [ClockOffset])
                late = self.fit(space, [promise.start], smaller.noise)
                self.with_clocks[space.key] = self.keep(late) if space.key in self.fitted else late

    def _near(self) -> list[frozenset[str]]:
        """Effects of the models that may be named."""
        least = self.score(self.best) - _POSSIBLE
        return [key for key, candidate in self.fitted.items() if self.score(candidate) > least]

    def refine(self) -> None:
        """Try, in the place of every effect of the best model, its special forms."""
        for kind in self.best.space.effects:
            self.refine_in(self.best, kind)

    def refine_in(self, best: Fit, kind: type[Effect]) -> None:
        """Try the special forms of an effect in its place in a model."""
        if kind not in best.space.effects:
            return
        other_effects = tuple(effect for effect in best.space.effects if effect is not kind)
        for special in library().values():
            if special.refines is not kind:
                continue
            space = ModelSpace(best.space.block, (*other_effects, special))
            if space.key in self.fitted or space.key in self.rejected:
                continue
            starts = space.replace_effect(best.space, best.coordinates, kind, special)
            residuals = [self.problem.whiten(space, start, best.noise) for start in starts]
            if not self._promises_gain(best, residuals):
                continue
            fresh = sorted(range(1, len(starts)), key=lambda k: float(residuals[k] @ residuals[k]))[:1]
            candidate = self.fit(space, [starts[k] for k in (0, *fresh)], best.noise)
            if self._matters(candidate, best):
                self.keep(candidate)

    def _promises_gain(self, best: Fit, residuals: Sequence[Array]) -> bool:
        """Whether a special form pays its prior odds to first order, by its residuals at some starts."""
        gains, _ = gains_beside(best, np.stack(residuals) - best.residual)
        return bool((gains > COST).any())

    def exchange(self, fitted_model: Fit, kind: type[Effect], other: type[Effect]) -> Fit:
        """Fit a model with another effect in the place of one, whose parameters it has."""
        kinds = tuple(other if effect is kind else effect for effect in fitted_model.space.effects)
        space = ModelSpace(fitted_model.space.block, kinds)
        (start, *_) = space.replace_effect(fitted_model.space, fitted_model.coordinates, kind, other)
        return self.with_effects(fitted_model, kinds, start)

    def settle(self) -> None:
        """Reject every model that may be named and contains an effect that does not matter."""
        checked_keys: set[frozenset[str]] = set()
        while near := [key for key in self._near() if key not in checked_keys]:
            for key in near:
                checked_keys.add(key)
                if not self.is_supported(self.fitted[key]):
                    self._reject(self.fitted[key])

    def sharpen(self) -> None:
        """Differentiate anew, at every instant, the models that may be named."""
        close = self._near()
        with ThreadPoolExecutor(_WORKERS) as pool:
            sharp = pool.map(lambda key: sharpen_fit(self.problem, self.fitted[key]), close)
            self.fitted.update(zip(close, sharp, strict=True))

    def noticeable(self, candidate: Fit) -> float:
        """Gain of log-likelihood below which what is left does not matter."""
        explained_likelihood = candidate.log_likelihood - self.null.log_likelihood
        return GENERAL_COST + 4.0 + 0.003 * explained_likelihood

    def backward(self, best: Fit) -> Fit:
        """Remove effects as long as the evidence grows."""
        while len(best.space.effects) > 1:
            smaller = [self.remove_effect(best, kind) for kind in best.space.effects]
            challenger = max(smaller, key=self.score)
            if not self._matters(best, challenger):
                self._reject(best)
            elif self.score(challenger) <= self.score(best):
                break
            best = challenger
        return best
