"""Search for missing effects of a block: forward by screening, backward by removal, judged by evidence."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from reliab.discrepancy.fitting.fit import Fit, fit, refined, reweighted, sharpened
from reliab.discrepancy.fitting.fitted_models import COST, OUTSIDE_COST, FittedModels
from reliab.discrepancy.fitting.line_terms import line_terms
from reliab.discrepancy.fitting.observations import observations
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import Screened, screened
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.effects import Effect, library

MOST_EFFECTS = 3
_WORKERS = 2
_BEAM = 2
_DEEPEST_OUTSIDE = 2
_TRIED = 8
_MOST_EXCHANGES = 2
_SIMPLE = 2  # parameters; effects of more have several optima where no model is exact
_CLOSE = 100.0  # nats
_POSSIBLE = 7.0  # nats


class Search(FittedModels):
    """Fit models with ever more effects, and keep what the data support."""

    def _screened(self, parent: Fit, kinds: Sequence[type[Effect]]) -> list[Screened]:
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

        def extended(candidate: Screened) -> Fit:
            space = ModelSpace(parent.space.block, (*parent.space.effects, candidate.kind))
            starts = [candidate.start]
            if self.problem.flat and len(candidate.kind.parameters) > _SIMPLE:
                starts += [start for start in candidate.others if start is not candidate.start]
            return reweighted(self.problem, fit(self.problem, space, starts, parent.noise))

        with ThreadPoolExecutor(_WORKERS) as pool:
            rough = list(pool.map(extended, fresh))
            least = self._worth_refining(rough, parent)
            near = pool.map(
                lambda candidate: (
                    refined(self.problem, candidate) if candidate.log_evidence > least else candidate
                ),
                rough,
            )
            fits = list(near)
        kept = []
        for candidate in fits:
            if self._matters(candidate, parent):
                kept.append(self._keep(candidate))
            else:
                self._reject(candidate)
        return kept

    def _worth_refining(self, rough: Sequence[Fit], parent: Fit) -> float:
        """Log-evidence from which a rough fit is refined: all, where errors judge."""
        if self.problem.flat or not rough:
            return -np.inf
        first = max(candidate.log_evidence for candidate in rough)
        return min(0.5 * (first + parent.log_evidence), first - _CLOSE)

    @property
    def _least_promise(self) -> float:
        """Gain to first order below which an effect is not fitted.

        Where errors judge, the first order says little of what a large change of the model will gain.
        """
        return 0.0 if self.problem.flat else COST

    def forward(self, begin: Fit, kinds: Sequence[type[Effect]], *, deepest: int = MOST_EFFECTS) -> Fit:
        """Add effects as long as the evidence grows."""
        beam, best = [begin], begin
        for _ in range(deepest):
            children: list[Fit] = []
            for parent in beam:
                promising = self._screened(parent, kinds)
                floor = max(self._least_promise, 0.02 * promising[0].gain) if promising else 0.0
                children += self.extend(
                    parent, [candidate for candidate in promising[:_TRIED] if candidate.gain > floor]
                )
            children.sort(key=self.score, reverse=True)
            beam = [candidate for candidate in children[:_BEAM] if self._within_reach(candidate, children[0])]
            if not beam or self.score(beam[0]) < self.score(best):
                break
            best = beam[0]
        return self.backward(best)

    def _within_reach(self, candidate: Fit, first: Fit) -> bool:
        """Whether a model is so close to the best one that a further effect might change the order."""
        return self.score(candidate) > 0.5 * (self.score(first) + self.score(self.null))

    def whole(self, begin: Fit | None = None) -> Fit:
        """Search the library, and terms outside it where one of them would explain the remainder."""
        block = self.problem.block
        inside = self.forward(begin or self.null, block.candidates)
        outside = (*block.outside, *line_terms(self.problem, inside)) if block.outside else ()
        remaining = self._screened(inside, outside)
        if not remaining or remaining[0].gain < self.noticeable(inside):
            return inside
        every = (*block.candidates, *outside)
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
            for candidate in pool.map(
                lambda candidate: refined(
                    problem, fit(problem, candidate.space, [candidate.coordinates], candidate.noise)
                ),
                near,
            ):
                search._keep(candidate)
        search.whole(search.best)
        return search

    def tempered(self) -> "Search":
        """Search again in the channel's own unit, where what the best model leaves is no noise.

        The likelihood is that of as many observations as there are swings of the motion, few from each test.
        """
        search = Search(self.problem.tempered(observations(self.problem)))
        search.exchange(search.whole())
        return search

    def exchange(self, best: Fit) -> None:
        """Try every other effect in the place of each of a model's, as long as that makes it better."""
        candidates = best.space.block.candidates
        for _ in range(_MOST_EXCHANGES):
            if len(best.space.effects) < 2:  # noqa: PLR2004 - single effects were all tried
                return
            for kind in best.space.effects:
                parent = self.without(best, kind)
                self.extend(
                    parent,
                    [
                        candidate
                        for candidate in self._screened(parent, candidates)[:_TRIED]
                        if candidate.gain > self._least_promise
                    ],
                )
            if self.best is best:
                return
            best = self.best

    def refine(self) -> None:
        """Try, in the place of every effect of the best model, its special forms."""
        for kind in self.best.space.effects:
            for special in library().values():
                if special.refines is kind:
                    self._refine(self.best, kind, special)

    def _refine(self, best: Fit, kind: type[Effect], special: type[Effect]) -> None:
        if kind not in best.space.effects:
            return
        others = tuple(effect for effect in best.space.effects if effect is not kind)
        space = ModelSpace(best.space.block, (*others, special))
        start = space.in_place_of(best.space, best.coordinates, kind, special)
        refined_fit = refined(self.problem, fit(self.problem, space, [start], best.noise))
        if self._matters(refined_fit, best):
            self._keep(refined_fit)

    def settle(self) -> None:
        """Reject every model that may be named and contains an effect that does not matter."""
        checked: set[frozenset[str]] = set()
        while True:
            best = self.score(self.best)
            near = [
                key
                for key, candidate in self.fitted.items()
                if key not in checked and self.score(candidate) > best - _POSSIBLE
            ]
            if not near:
                return
            for key in near:
                checked.add(key)
                candidate = self.fitted[key]
                if not self.supported(candidate):
                    self._reject(candidate)

    def sharpen(self) -> None:
        """Differentiate anew, at every instant, the models that may be named."""
        close = [
            key
            for key, candidate in self.fitted.items()
            if self.score(candidate) > self.score(self.best) - _POSSIBLE
        ]
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
