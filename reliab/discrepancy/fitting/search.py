"""Search for missing effects of a block: forward by screening, backward by removal, judged by evidence."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property, reduce
from weakref import WeakKeyDictionary

import numpy as np

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.acting import LIMITS, acts, exceeds_rounding, takes_over_delay
from reliab.discrepancy.fitting.fit import Fit, fit, refined, reweighted, sharpened
from reliab.discrepancy.fitting.left_out import LeftOut, left_out
from reliab.discrepancy.fitting.noise_test import is_model_error, is_spread
from reliab.discrepancy.fitting.prior import COST, OUTSIDE_COST, cost
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import Screened, line_terms, screened
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.terms.clock_offset import ClockOffset
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general
from reliab.effects.registry import library
from reliab.signals.noise import NoiseModel

LEAST_SHARE = 0.01
"""Share of the gap's energy that an effect must close to be named beside others.

No model of a machine is exact: in long records even model errors of a tenth of the largest effect are
significant. One that takes a tenth off the RMS of all that is left, on left-out tests as in training,
is no trifle, however large the gap was."""

AUDIBLE = 0.02
"""Share of the noise's energy that an effect outside the library must have.

Every recording contains traces far below its noise that no effect of the library explains."""

MATERIAL = 0.19
"""Share of the error's energy on left-out tests, a tenth of its RMS, that an effect must remove where the
remainder is not noise.

An error of the model follows the motion, so that nearly any effect explains some of it. The evidence treats
this error as noise, so that a tiny improvement would appear certain."""

_NO_WORSE = 0.02  # growth of the error on left-out tests that noise brings about
NOTICEABLE = 0.002
"""Share of the error's energy on left-out tests, a thousandth of its RMS in the channel's unit, that every
effect must remove: evidence alone may praise one that changes no prediction."""

_AWAY = 2.0  # standard deviations between a parameter and its value without effect

MOST_EFFECTS = 3
_WORKERS = 2
_BEAM, _DEEPEST_OUTSIDE = 2, 2
_TRIED, _SCOUTED = 8, 4
_CLOSE, _POSSIBLE, _CLEAR = 100.0, 7.0, 25.0  # nats


class Search:
    """Fit models of a block with ever more effects, and keep those that the data support."""

    def __init__(self, problem: Problem) -> None:
        self.fitted: dict[frozenset[str], Fit] = {}
        self.rejected: dict[frozenset[str], Fit] = {}
        self.with_clocks: dict[frozenset[str], Fit] = {}
        self._errors: WeakKeyDictionary[Fit, LeftOut] = WeakKeyDictionary()
        self._roughly_fitted: dict[frozenset[str], Fit] = {}
        block = problem.block
        space = ModelSpace(block, ())
        spread = np.mean([block.measured(s.test)[s.begin : s.end].var() for s in problem.segments])
        start = NoiseModel.white(block.rate, 1e-3 * float(spread))
        null = refined(problem, fit(problem, space, [np.zeros(space.size)], start))
        self.problem = problem if problem.conversion else problem.corrected(space, null.coordinates)
        self.null = self.keep(null if self.problem is problem else refined(self.problem, null))

    @cached_property
    def linear(self) -> Fit:
        """The best linear model of the block: calibration, offsets, and its linear effects."""
        space = ModelSpace(self.problem.block, self.problem.block.linear)
        if not space.effects:
            return self.null
        start = next(space.starts(self.null.space, self.null.coordinates))
        return refined(self.problem, fit(self.problem, space, [start], self.null.noise))

    def keep(self, candidate: Fit) -> Fit:
        """Keep a fitted model, unless one of the same effects is better or was rejected."""
        key = frozenset(candidate.space.names)
        if key in self.rejected:
            return candidate
        if key not in self.fitted or self.score(candidate) > self.score(self.fitted[key]):
            self.fitted[key] = candidate
        return self.fitted[key]

    def _reject(self, candidate: Fit) -> None:
        """Exclude a model from the search permanently, because one of its effects does not matter."""
        key = frozenset(candidate.space.names)
        self.rejected[key] = candidate
        self.fitted.pop(key, None)

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
            self._errors[candidate] = left_out(self.problem, candidate)
        return self._errors[candidate]

    def plain(self, calibrated: Fit) -> Fit:
        """Calibrate by ordinary least squares, without a noise model, as a laboratory would."""
        grid = np.linspace(0.0, 0.5 * self.problem.block.rate, 99)
        variance = float(np.mean(self.null.noise.density(grid)))
        white = NoiseModel.white(self.null.noise.rate, variance)
        return fit(self.problem, calibrated.space, [calibrated.coordinates], white)

    @property
    def best(self) -> Fit:
        """The most credible of all fitted models."""
        return max(self.fitted.values(), key=self.score)

    def _matters(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether the additional effects of a model over a smaller one are not negligible."""
        rows = candidate.residual
        remaining = float(rows @ rows)
        gained = self.energy(smaller, candidate.noise) - remaining
        added = set(candidate.space.effects) - set(smaller.space.effects)
        unknown = any(is_general(kind) for kind in added)
        if unknown and gained < AUDIBLE * remaining:
            return False
        if smaller is self.null or self._shows_once(candidate, smaller):
            return True
        if self._is_shift(candidate, added) or takes_over_delay(candidate, smaller):
            return self._predicts(candidate, smaller, 1.0 + _NO_WORSE)
        closed = self.energy(self.null, candidate.noise) - remaining
        if gained > LEAST_SHARE * closed:
            return self._predicts(candidate, smaller, 1.0 + _NO_WORSE)
        audible = gained > MATERIAL * (remaining + gained)
        return audible and self.error(candidate).energy <= (1.0 - MATERIAL) * self.error(smaller).energy

    def _is_shift(self, candidate: Fit, added: set[type[Effect]]) -> bool:
        """Whether an offset of the clocks is added to a model with effects, or what looks like one there.

        It explains little beside them and still moves their parameters by far more than their deviations.
        Where what is left is no noise, an error of a coarse converter that follows the motion, likelihood
        overrates so little: it must then explain as much as any other effect.
        """
        twins = self.problem.block.twins
        if ClockOffset not in twins or len(added) != 1 or not is_spread(self.problem, candidate):
            return False
        rivals = {*candidate.space.effects} - added | {ClockOffset}
        rival = self.fitted.get(frozenset(str(kind.name) for kind in rivals))
        return added == {ClockOffset} or (added <= set(twins[ClockOffset]) and rival is not None)

    def _predicts(self, candidate: Fit, smaller: Fit, most: float) -> bool:
        """Whether a model's error on left-out tests is at most a multiple of that of a smaller model."""
        return self.error(candidate).at_most(most, self.error(smaller))

    def supported(self, candidate: Fit) -> bool:
        """Whether a model may be named: each of its effects matters against the models without it."""
        effects = candidate.space.effects
        if not all(self._acts(candidate, kind) for kind in effects):
            return False
        for smaller in [self.without(candidate, kind) for kind in effects]:
            noticed = self._predicts(candidate, smaller, 1.0 - NOTICEABLE) or self._shows_once(
                candidate, smaller
            )
            if not (noticed and self._matters(candidate, smaller)):
                return False
        return self._shifts_what_matters(candidate)

    def _shows_once(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether a further limit clearly shows in a part from which the others do not foretell it."""
        added = set(candidate.space.effects) - set(smaller.space.effects)
        if not all(issubclass(kind, LIMITS) for kind in added):
            return False
        clear = candidate.log_evidence - smaller.log_evidence > _CLEAR
        return clear and not self.error(candidate).foretold.all()

    def _shifts_what_matters(self, candidate: Fit) -> bool:
        """Whether an offset of the clocks and what looks like one, which may cancel it, matter together."""
        twins = self.problem.block.twins.get(ClockOffset, ())
        alike = [kind for kind in candidate.space.effects if kind in (ClockOffset, *twins)]
        both = ClockOffset in alike and len(alike) > 1
        return not both or self._matters(candidate, reduce(self.without, alike, candidate))

    def _acts(self, candidate: Fit, kind: type[Effect]) -> bool:
        """Whether an effect's parameters are beyond their own uncertainty, and beyond a converter's steps."""
        return acts(candidate, kind, _AWAY) and exceeds_rounding(self.problem, candidate, kind)

    def _limiting(self, candidate: Fit) -> list[Fit]:
        """Models with the limiting case of one of a model's effects in its place, even if rejected."""
        effects = set(candidate.space.effects)
        keys = [
            frozenset(str(effect.name) for effect in (effects - {kind}) | {simpler})
            for kind in effects
            for simpler in kind.limiting_cases
            if simpler not in effects
        ]
        return [fit for fit in (self.fitted.get(key, self.rejected.get(key)) for key in keys) if fit]

    def energy(self, candidate: Fit, noise: NoiseModel) -> float:
        """Energy that a fitted model leaves, whitened by a given noise."""
        rows = self.problem.whitened(candidate.space, candidate.coordinates, noise)
        return float(rows @ rows)

    def without(self, candidate: Fit, kind: type[Effect]) -> Fit:
        """Return a model without one of its effects, refitted."""
        remaining = tuple(effect for effect in candidate.space.effects if effect is not kind)
        space = ModelSpace(candidate.space.block, remaining)
        key = frozenset(space.names)
        if key in self.fitted:
            return self.fitted[key]
        start = space.inherited(candidate.space, candidate.coordinates)
        return self.keep(refined(self.problem, fit(self.problem, space, [start], candidate.noise)))

    def screened(self, parent: Fit, kinds: Sequence[type[Effect]]) -> list[Screened]:
        """Give effects that may be added to a model, those of the largest promise first."""
        return screened(self.problem, parent, kinds, self.null)

    def _untried(self, names: set[str]) -> bool:
        return frozenset(names) not in self.fitted and frozenset(names) not in self.rejected

    def extend(self, parent: Fit, promising: Sequence[Screened]) -> list[Fit]:
        """Fit a model with each of some effects added."""
        fresh = [
            candidate
            for candidate in promising
            if candidate.start.size and self._untried({*parent.space.names, str(candidate.kind.name)})
        ]

        rough = self._rough(parent, fresh)
        with ThreadPoolExecutor(_WORKERS) as pool:
            least = self._worth_refining(rough, parent)
            finer = pool.map(
                lambda one: refined(self.problem, one) if one.log_evidence > least else one, rough
            )
            fits = list(finer)
        kept = []
        for candidate in fits:
            if self._matters(candidate, parent):
                kept.append(self.keep(candidate))
            else:
                self._reject(candidate)
        return kept

    def _rough(self, parent: Fit, promising: Sequence[Screened]) -> list[Fit]:
        """Fit a model with each of some effects added, and the noise once."""

        def extended(candidate: Screened) -> Fit:
            space = ModelSpace(parent.space.block, (*parent.space.effects, candidate.kind))
            key = frozenset(space.names)
            if key not in self._roughly_fitted:
                fitted = fit(self.problem, space, self._starts(candidate), parent.noise)
                self._roughly_fitted[key] = reweighted(self.problem, fitted)
            return self._roughly_fitted[key]

        with ThreadPoolExecutor(_WORKERS) as pool:
            return list(pool.map(extended, promising))

    def reaches_noise(self) -> bool:
        """Whether some effect after the other, added greedily, leaves what may be noise.

        Noise then judges models; parts that are left out do otherwise.
        """
        best, kinds = self.null, (*self.candidates, *self.problem.block.outside)
        for _ in range(MOST_EFFECTS):
            if not is_model_error(self.problem, best):
                return True
            promising = [one for one in self.screened(best, kinds)[:_SCOUTED] if one.start.size]
            best = max(self._rough(best, promising), key=lambda one: one.log_likelihood, default=best)
        return not is_model_error(self.problem, best)

    def _starts(self, promise: Screened) -> list[Array]:
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
                promising = self.screened(parent, kinds)
                floor = max(COST, 0.02 * promising[0].gain) if promising else 0.0
                likely = [candidate for candidate in promising[:_TRIED] if candidate.gain > floor]
                children += self.extend(parent, [*likely, *self._hidden(parent, promising, likely)])
            children.sort(key=self.score, reverse=True)
            reach = [one for one in children[:_BEAM] if self._within_reach(one, children[0])]
            near = [self.keep(refined(self.problem, one)) for one in reach]
            beam = [*near[:1], *(candidate for candidate in near[1:] if not self._surpassed(candidate))]
            if not beam or self.score(beam[0]) < self.score(best):
                break
            best = beam[0]
        return self.backward(best)

    def _hidden(
        self, parent: Fit, screened: Sequence[Screened], likely: Sequence[Screened]
    ) -> list[Screened]:
        """Return effects with twins, which a calibration that made up for them hides to first order.

        A noise that is fitted to what the calibrated model leaves hides them, too.
        """
        twins = self.problem.block.twins
        if parent is not self.null or not twins:
            return []
        return [one for one in screened if one.kind in twins and one not in likely]

    def _within_reach(self, candidate: Fit, first: Fit) -> bool:
        """Whether a model is so close to the best one that a further effect might change the order."""
        return self.score(candidate) > 0.5 * (self.score(first) + self.score(self.null))

    def _surpassed(self, candidate: Fit) -> bool:
        """Whether a limiting case, whose extensions say as much, is as credible as a model."""
        return any(self.score(simpler) >= self.score(candidate) for simpler in self._limiting(candidate))

    def whole(self, begin: Fit | None = None) -> Fit:
        """Search the library, and terms outside it where one of them would explain the remainder."""
        block = self.problem.block
        inside = self.forward(begin or self.null, self.candidates)
        outside = (*block.outside, *line_terms(self.problem, inside)) if block.outside else ()
        remaining = self.screened(inside, outside)
        if not remaining or remaining[0].gain < self.noticeable(inside):
            return inside
        every = (*self.candidates, *outside)
        best = max(inside, self.forward(self.null, every, deepest=_DEEPEST_OUTSIDE), key=self.score)
        return best if best is not inside else self.forward(inside, every, deepest=1)

    def again(self) -> "Search":
        """Search again with the converter's error that the best model expects; itself if there is none."""
        best = self.best
        corrected = self.problem.corrected(best.space, best.coordinates)
        return self if corrected is self.problem or best is self.null else self.on(corrected)

    def on(self, problem: Problem) -> "Search":
        """Search on other data of the same block.

        Models that were near the best are fitted anew from where they stood; the search goes on from there.
        """
        best = self.best
        search = Search(problem)
        near = [
            candidate
            for candidate in self.fitted.values()
            if candidate is not self.null and self._within_reach(candidate, best)
        ]
        with ThreadPoolExecutor(_WORKERS) as pool:
            fits = pool.map(lambda one: fit(problem, one.space, [one.coordinates], one.noise), near)
            for candidate in pool.map(lambda one: refined(problem, one), fits):
                search.keep(candidate)
        search.whole(search.best)
        return search

    def try_twins(self) -> None:
        """Try, in the place of every effect of the best model, those that the block may not tell from it."""
        best = self.best
        for kind in best.space.effects:
            twins = self.problem.block.twins.get(kind, ())
            for twin in [
                twin for twin in self.candidates if twin in twins and twin not in best.space.effects
            ]:
                self._try_in_place(best, kind, twin)

    def _try_in_place(self, best: Fit, kind: type[Effect], twin: type[Effect]) -> None:
        """Fit a model with one effect in the place of another, from where it was left if it was tried."""
        parent = self.without(best, kind)
        space = ModelSpace(best.space.block, (*parent.space.effects, twin))
        tried = self.fitted.get(frozenset(space.names))
        start = self.screened(parent, [twin])[0].start if tried is None else tried.coordinates
        if start.size:
            fitted = tried.space if tried is not None else space
            candidate = refined(self.problem, fit(self.problem, fitted, [start], best.noise))
            if self._matters(candidate, parent):
                self.keep(candidate)

    def fit_beside_clocks(self) -> None:
        """Add an offset of the clocks to the models that may be named, where it was rejected, too."""
        if ClockOffset not in self.candidates or ClockOffset not in self.problem.block.twins:
            return
        for key in self._near():
            near = self.fitted[key]
            alone = self.without(near, ClockOffset) if ClockOffset in near.space.effects else near
            if alone.space.effects:
                self._with_clock(alone)

    def _with_clock(self, fitted: Fit) -> None:
        """Fit a model with an offset of the clocks together with its effects."""
        space = ModelSpace(fitted.space.block, (*fitted.space.effects, ClockOffset))
        key = frozenset(space.names)
        if key not in self.with_clocks:
            (promise,) = self.screened(fitted, [ClockOffset])
            beside = refined(self.problem, fit(self.problem, space, [promise.start], fitted.noise))
            self.with_clocks[key] = self.keep(beside) if key in self.fitted else beside

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
        for special in library().values():
            if special.refines is kind:
                self._refine(best, kind, special)

    def _refine(self, best: Fit, kind: type[Effect], special: type[Effect]) -> None:
        if kind not in best.space.effects:
            return
        others = tuple(effect for effect in best.space.effects if effect is not kind)
        space = ModelSpace(best.space.block, (*others, special))
        inherited, *fresh = space.in_place_of(best.space, best.coordinates, kind, special)
        residuals = [self.problem.whitened(space, start, best.noise) for start in fresh]
        starts = [inherited, *(fresh[k] for k in np.argsort([rows @ rows for rows in residuals])[:1])]
        refined_fit = refined(self.problem, fit(self.problem, space, starts, best.noise))
        if self._matters(refined_fit, best):
            self.keep(refined_fit)

    def simplified(self, fitted: Fit, special: type[Effect]) -> Fit:
        """Fit a model with the simpler effect in the place of a special form."""
        simple = special.refines
        if simple is None:
            return fitted
        kinds = tuple(simple if effect is special else effect for effect in fitted.space.effects)
        space = ModelSpace(fitted.space.block, kinds)
        if frozenset(space.names) in self.fitted:
            return self.fitted[frozenset(space.names)]
        (start, *_) = space.in_place_of(fitted.space, fitted.coordinates, special, simple)
        return self.keep(refined(self.problem, fit(self.problem, space, [start], fitted.noise)))

    def settle(self) -> None:
        """Reject every model that may be named and contains an effect that does not matter."""
        checked: set[frozenset[str]] = set()
        while near := [key for key in self._near() if key not in checked]:
            for key in near:
                checked.add(key)
                if not self.supported(self.fitted[key]):
                    self._reject(self.fitted[key])

    def sharpen(self) -> None:
        """Differentiate anew, at every instant, the models that may be named."""
        close = self._near()
        with ThreadPoolExecutor(_WORKERS) as pool:
            sharp = pool.map(lambda key: sharpened(self.problem, self.fitted[key]), close)
            self.fitted.update(zip(close, sharp, strict=True))

    def noticeable(self, candidate: Fit) -> float:
        """Gain of log-likelihood below which what is left does not matter."""
        explained = candidate.log_likelihood - self.null.log_likelihood
        return OUTSIDE_COST + 4.0 + 0.003 * explained

    def backward(self, best: Fit) -> Fit:
        """Remove effects as long as the evidence grows."""
        while len(best.space.effects) > 1:
            smaller = [self.without(best, kind) for kind in best.space.effects]
            challenger = max(smaller, key=self.score)
            if not self._matters(best, challenger):
                self._reject(best)
            elif self.score(challenger) <= self.score(best):
                break
            best = challenger
        return best
