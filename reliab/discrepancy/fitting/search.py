"""Searching for what a block hides: forward by screening, backward by removal, judged by evidence."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fitting.fit import Fit, fit, refined, reweighted, sharpened, transferred
from reliab.discrepancy.fitting.left_out import LeftOut, left_out
from reliab.discrepancy.fitting.line_terms import line_terms
from reliab.discrepancy.fitting.observations import observations
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.spectra.noise import NoiseModel
from reliab.discrepancy.terms import is_outside
from reliab.loop.effects import Effect, library

Array = NDArray[np.float64]
Kinds = tuple[type[Effect], ...]

COST = 4.0
"""Logarithm of the prior odds against one more effect."""

OUTSIDE_COST = 7.0
"""The same for an effect outside the library."""

LEAST_SHARE = 0.01
"""Share of the gap's energy that an effect must close to be named beside others.

No model of a machine is exact: long records make errors of a tenth of the largest effect significant."""

AUDIBLE = 0.02
"""Share of the noise's energy that an effect outside the library must have.

Every recording has traces far below its noise that no library holds."""

MATERIAL = 0.19
"""Share of the error's energy on left-out tests, a tenth of its RMS, that an effect must take away where what
is left is no noise.

An error of the model follows the motion, so that nearly anything explains some of it; by evidence alone,
which takes it for noise, a trifle of it decides with certainty."""

_LEAST_BESIDE, _LEAST_OUTSIDE = 0.03, 0.05
# shares of the whole gap's energy that an effect beside others, and a term outside the library, must close
_NO_WORSE = 0.02  # growth of the error on left-out tests that noise brings about

MOST_EFFECTS = 3
_WORKERS = 2
_BEAM = 2
_DEEPEST_OUTSIDE = 2
_TRIED = 8
_MOST_EXCHANGES = 2
_SIMPLE = 2  # parameters; effects of more have several optima where no model is exact
_CLOSE = 100.0  # nats
_POSSIBLE = 7.0  # nats


def cost(kinds: Iterable[type[Effect]]) -> float:
    """Prior odds against a set of effects, as a logarithm; a special form of an effect counts twice."""
    return sum(OUTSIDE_COST if is_outside(kind) else COST * (1 + bool(kind.refines)) for kind in kinds)


@dataclass(frozen=True, kw_only=True, eq=False)
class Screened:
    """How much an effect promises to explain beside a fitted model.

    Attributes
    ----------
    kind : type
        The effect.
    gain : float
        Gain of log-likelihood, to first order.
    start : numpy.ndarray
        Coordinates from which to fit.
    others : tuple of numpy.ndarray, optional
        Coordinates that promised less.
    """

    kind: type[Effect]
    gain: float
    start: Array
    others: tuple[Array, ...] = ()


class Search:
    """All models of a block that were fitted, by the names of their effects.

    Parameters
    ----------
    problem : Problem
        The block and its data.
    """

    def __init__(self, problem: Problem) -> None:
        self.fitted: dict[frozenset[str], Fit] = {}
        self.rejected: set[frozenset[str]] = set()
        self._errors: WeakKeyDictionary[Fit, LeftOut] = WeakKeyDictionary()
        block = problem.block
        space = ModelSpace(block, ())
        spread = np.mean([block.measured(s.test)[s.begin : s.end].var() for s in problem.segments])
        start = NoiseModel.white(block.rate, 1e-3 * float(spread))
        null = refined(problem, fit(problem, space, [np.zeros(space.size)], start))
        self.problem = problem if problem.conversion else problem.corrected(space, null.coordinates)
        self.null = self._keep(null if self.problem is problem else refined(self.problem, null))

    def _keep(self, candidate: Fit) -> Fit:
        key = frozenset(candidate.space.names)
        if key in self.rejected:
            return candidate
        if key not in self.fitted or self.score(candidate) > self.score(self.fitted[key]):
            self.fitted[key] = candidate
        return self.fitted[key]

    def _reject(self, candidate: Fit) -> None:
        """Take a model out of the search for good: something in it does not matter."""
        key = frozenset(candidate.space.names)
        self.rejected.add(key)
        self.fitted.pop(key, None)

    def score(self, candidate: Fit) -> float:
        """Logarithm of how credible a fitted model is, up to a constant.

        Evidence and prior odds where noise judges; else the predictive likelihood of tests that are left out
        one at a time, of normal errors of unknown size, which has paid for the model's parameters already.
        """
        if not self.problem.flat:
            return candidate.log_evidence - cost(candidate.space.effects)
        error = self.error(candidate)
        count = sum(
            share * (2 * segment.bins - 1)
            for share, segment in zip(self.problem.tempering, self.problem.segments, strict=True)
        )
        return -0.5 * count * float(np.log(max(error.energy, 1e-300))) - cost(candidate.space.effects)

    def error(self, candidate: Fit) -> LeftOut:
        """Error of a model on each test when it is fitted to the others."""
        if candidate not in self._errors:
            self._errors[candidate] = left_out(self.problem, candidate)
        return self._errors[candidate]

    def plain(self) -> Fit:
        """Calibrate by least squares, as a laboratory would that knows nothing of noise."""
        variance = float(
            np.mean(self.null.noise.density(np.linspace(0.0, 0.5 * self.problem.block.rate, 99)))
        )
        white = NoiseModel.white(self.null.noise.rate, variance)
        return fit(self.problem, self.null.space, [self.null.coordinates], white)

    @property
    def best(self) -> Fit:
        """The most credible of all fitted models."""
        return max(self.fitted.values(), key=self.score)

    def screen(self, parent: Fit, kinds: Sequence[type[Effect]]) -> list[Screened]:
        """Rank effects by what they promise to explain beside a model."""
        fresh = [kind for kind in kinds if kind not in parent.space.effects]
        basis = np.linalg.qr(parent.jacobian[:, parent.free])[0]
        sketched = self.problem.sketch.whitened(parent.space, parent.coordinates, parent.noise)
        with ThreadPoolExecutor(_WORKERS) as pool:
            screened = pool.map(lambda kind: self._screen_one(parent, sketched, basis, kind), fresh)
            ranked = sorted(screened, key=lambda candidate: -candidate.gain)
        if not self.problem.flat:
            return ranked
        whole = 0.5 * float(parent.residual @ parent.residual)
        return [
            replace(candidate, gain=-whole * np.log1p(-min(candidate.gain / whole, 0.99)))
            for candidate in ranked
        ]

    def _screen_one(self, parent: Fit, sketched: Array, basis: Array, kind: type[Effect]) -> Screened:
        space = ModelSpace(parent.space.block, (*parent.space.effects, kind))
        best = Screened(kind=kind, gain=0.0, start=np.zeros(0))
        for begin in space.starts(parent.space, parent.coordinates):
            start = begin
            change = self.problem.sketch.whitened(space, start, parent.noise) - sketched
            change -= basis @ (basis.T @ change)
            size = float(change @ change)
            along = -float(parent.residual @ change)
            if size <= 0.0 or (along < 0.0 and not kind.parameters[0].signed):
                continue
            gain = 0.5 * along**2 / size
            start = space.scaled(start, kind, along / size)
            if gain > best.gain or best.start.size == 0:
                best = Screened(kind=kind, gain=gain, start=start, others=(*best.others, start))
            else:
                best = replace(best, others=(*best.others, start))
        return self._uncalibrated(parent, sketched, space, best) if parent is self.null else best

    def _uncalibrated(self, parent: Fit, sketched: Array, space: ModelSpace, best: Screened) -> Screened:
        """Start from the nominal rig where that promises more.

        A calibration that has made up for an actuator at its limits has moved the model away from them.
        """
        for start in space.starts(parent.space, np.zeros(parent.space.size)):
            residual = self.problem.sketch.whitened(space, start, parent.noise)
            gain = 0.5 * float(sketched @ sketched - residual @ residual)
            if gain > best.gain:
                best = replace(best, gain=gain, start=start)
        return best

    def _untried(self, names: set[str]) -> bool:
        return frozenset(names) not in self.fitted and frozenset(names) not in self.rejected

    def extend(self, parent: Fit, screened: Sequence[Screened]) -> list[Fit]:
        """Fit a model with each of some effects added."""
        fresh = [
            candidate
            for candidate in screened
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

    def _matters(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether what an effect adds is not negligible, by what models leave and on left-out tests."""
        rows = candidate.residual
        remaining = float(rows @ rows)
        gained = self._energy(smaller, candidate.noise) - remaining
        unknown = any(is_outside(kind) for kind in set(candidate.space.effects) - set(smaller.space.effects))
        if unknown and gained < AUDIBLE * remaining:
            return False
        if self.problem.flat:
            least = _LEAST_OUTSIDE if unknown else _LEAST_BESIDE
            large = gained > max(
                MATERIAL * (remaining + gained), least * self._energy(self.null, candidate.noise)
            )
            return large and self._predicts(candidate, smaller, 1.0 - MATERIAL)
        if smaller is self.null:
            return True
        closed = self._energy(self.null, candidate.noise) - remaining
        return gained > LEAST_SHARE * closed and self._predicts(candidate, smaller, 1.0 + _NO_WORSE)

    def _predicts(self, candidate: Fit, smaller: Fit, most: float) -> bool:
        """Whether a model's error on left-out tests is at most a multiple of that of a smaller model."""
        return self.error(candidate).energy <= most * self.error(smaller).energy

    def _energy(self, candidate: Fit, noise: NoiseModel) -> float:
        """Energy that a model leaves, whitened by a given noise."""
        rows = self.problem.whitened(candidate.space, candidate.coordinates, noise)
        return float(rows @ rows)

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
                promising = self.screen(parent, kinds)
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
        """Search the library, and beyond it where something is left that a term outside would explain."""
        block = self.problem.block
        inside = self.forward(begin or self.null, block.candidates)
        outside = (*block.outside, *line_terms(self.problem, inside)) if block.outside else ()
        remaining = self.screen(inside, outside)
        if not remaining or remaining[0].gain < self.noticeable(inside):
            return inside
        every = (*block.candidates, *outside)
        best = max(inside, self.forward(self.null, every, deepest=_DEEPEST_OUTSIDE), key=self.score)
        return best if best is not inside else self.forward(inside, every, deepest=1)

    def again(self) -> "Search":
        """Search again with the converter's error that the best model expects; itself if there is none.

        Models that were near the best are fitted anew from where they stood; the search goes on from there.
        """
        best = self.best
        corrected = self.problem.corrected(best.space, best.coordinates)
        if corrected is self.problem or best is self.null:
            return self
        search = Search(corrected)
        near = [
            candidate
            for candidate in self.fitted.values()
            if candidate is not self.null and self._within_reach(candidate, best)
        ]
        with ThreadPoolExecutor(_WORKERS) as pool:
            for candidate in pool.map(
                lambda candidate: refined(corrected, transferred(corrected, candidate)), near
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
                        for candidate in self.screen(parent, candidates)[:_TRIED]
                        if candidate.gain > self._least_promise
                    ],
                )
            if self.best is best:
                return
            best = self.best

    def refine(self) -> None:
        """Try the special forms of the effects that the best model holds, each in the place of its own."""
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
        """Reject what does not matter against one of its sub-models, of all models that may be named."""
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
                if any(
                    not self._matters(candidate, self.without(candidate, kind))
                    for kind in candidate.space.effects
                ):
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

    def without(self, candidate: Fit, kind: type[Effect]) -> Fit:
        """Return a model without one of its effects, refitted."""
        remaining = tuple(effect for effect in candidate.space.effects if effect is not kind)
        space = ModelSpace(candidate.space.block, remaining)
        key = frozenset(space.names)
        if key in self.fitted:
            return self.fitted[key]
        start = space.inherited(candidate.space, candidate.coordinates)
        return self._keep(refined(self.problem, fit(self.problem, space, [start], candidate.noise)))
