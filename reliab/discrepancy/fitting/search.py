"""Searching for what a block hides: forward by screening, backward by removal, judged by evidence."""

from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.fitting.fit import Fit, fit, refined, reweighted, sharpened, transferred
from reliab.discrepancy.fitting.line_terms import line_terms
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.spectra.noise import NoiseModel
from reliab.discrepancy.terms import is_outside
from reliab.loop.effects import Effect

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

MOST_EFFECTS = 3
_WORKERS = 2
_BEAM = 2
_DEEPEST_OUTSIDE = 2
_TRIED = 8
_CLOSE = 100.0  # nats
_POSSIBLE = 7.0  # nats


def cost(kinds: Iterable[type[Effect]]) -> float:
    """Prior odds against a set of effects, as a logarithm."""
    return sum(OUTSIDE_COST if is_outside(kind) else COST for kind in kinds)


def score(one: Fit) -> float:
    """Evidence and prior odds of a fitted model, as a logarithm."""
    return one.log_evidence - cost(one.space.effects)


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
    """

    kind: type[Effect]
    gain: float
    start: Array


class Search:
    """All models of a block that were fitted, by the names of their effects.

    Parameters
    ----------
    problem : Problem
        The block and its data.
    """

    def __init__(self, problem: Problem) -> None:
        self.fitted: dict[frozenset[str], Fit] = {}
        block = problem.block
        space = ModelSpace(block, ())
        spread = np.mean([block.measured(s.test)[s.begin : s.end].var() for s in problem.segments])
        start = NoiseModel.white(block.rate, 1e-3 * float(spread))
        null = refined(problem, fit(problem, space, [np.zeros(space.size)], start))
        self.problem = problem if problem.conversion else problem.corrected(space, null.coordinates)
        self.null = self._keep(null if self.problem is problem else refined(self.problem, null))

    def _keep(self, one: Fit) -> Fit:
        key = frozenset(one.space.names)
        if key not in self.fitted or score(one) > score(self.fitted[key]):
            self.fitted[key] = one
        return self.fitted[key]

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
        return max(self.fitted.values(), key=score)

    def screen(self, parent: Fit, kinds: Sequence[type[Effect]]) -> list[Screened]:
        """Rank effects by what they promise to explain beside a model."""
        fresh = [kind for kind in kinds if kind not in parent.space.effects]
        basis = np.linalg.qr(parent.jacobian[:, parent.free])[0]
        sketched = self.problem.sketch.whitened(parent.space, parent.coordinates, parent.noise)
        with ThreadPoolExecutor(_WORKERS) as pool:
            screened = pool.map(lambda kind: self._screen_one(parent, sketched, basis, kind), fresh)
        return sorted(screened, key=lambda one: -one.gain)

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
            if gain > best.gain or best.start.size == 0:
                start = space.scaled(start, kind, along / size)
                best = Screened(kind=kind, gain=gain, start=start)
        return self._uncalibrated(parent, sketched, space, best) if parent is self.null else best

    def _uncalibrated(self, parent: Fit, sketched: Array, space: ModelSpace, best: Screened) -> Screened:
        """Start from the nominal rig where that promises more.

        A calibration that has made up for an actuator at its limits has moved the model away from them.
        """
        for start in space.starts(parent.space, np.zeros(parent.space.size)):
            left = self.problem.sketch.whitened(space, start, parent.noise)
            gain = 0.5 * float(sketched @ sketched - left @ left)
            if gain > best.gain:
                best = Screened(kind=best.kind, gain=gain, start=start)
        return best

    def extend(self, parent: Fit, screened: Sequence[Screened]) -> list[Fit]:
        """Fit a model with each of some effects added."""
        fresh = [
            one
            for one in screened
            if one.start.size and frozenset({*parent.space.names, str(one.kind.name)}) not in self.fitted
        ]

        def extended(one: Screened) -> Fit:
            space = ModelSpace(parent.space.block, (*parent.space.effects, one.kind))
            return reweighted(self.problem, fit(self.problem, space, [one.start], parent.noise))

        with ThreadPoolExecutor(_WORKERS) as pool:
            rough = list(pool.map(extended, fresh))
            first = max(map(score, rough), default=0.0)
            least = min(0.5 * (first + score(parent)), first - _CLOSE)
            near = pool.map(lambda one: refined(self.problem, one) if score(one) > least else one, rough)
            found = list(near)
        return [self._keep(one) for one in found if self._matters(one, parent)]

    def _matters(self, one: Fit, smaller: Fit) -> bool:
        """Whether what an effect adds is not negligible beside the gap that the larger model closes."""
        rows = one.residual
        gained = self._energy(smaller, one.noise) - float(rows @ rows)
        unknown = any(is_outside(kind) for kind in set(one.space.effects) - set(smaller.space.effects))
        if unknown and gained < AUDIBLE * rows.size:
            return False
        if smaller is self.null:
            return True
        closed = self._energy(self.null, one.noise) - float(rows @ rows)
        return gained > LEAST_SHARE * closed

    def _energy(self, one: Fit, noise: NoiseModel) -> float:
        """Energy that a model leaves, whitened by a given noise."""
        rows = self.problem.whitened(one.space, one.coordinates, noise)
        return float(rows @ rows)

    def forward(self, begin: Fit, kinds: Sequence[type[Effect]], *, deepest: int = MOST_EFFECTS) -> Fit:
        """Add effects as long as the evidence grows."""
        beam, best = [begin], begin
        for _ in range(deepest):
            children: list[Fit] = []
            for parent in beam:
                promising = self.screen(parent, kinds)
                floor = max(COST, 0.02 * promising[0].gain) if promising else 0.0
                children += self.extend(parent, [one for one in promising[:_TRIED] if one.gain > floor])
            children.sort(key=score, reverse=True)
            beam = [one for one in children[:_BEAM] if self._within_reach(one, children[0])]
            if not beam or score(beam[0]) < score(best):
                break
            best = beam[0]
        return self.backward(best)

    def _within_reach(self, one: Fit, first: Fit) -> bool:
        """Whether a model is so close to the best one that a further effect might change the order."""
        return score(one) > 0.5 * (score(first) + score(self.null))

    def whole(self, begin: Fit | None = None) -> Fit:
        """Search the library, and beyond it where something is left that a term outside would explain."""
        block = self.problem.block
        inside = self.forward(begin or self.null, block.candidates)
        outside = (*block.outside, *line_terms(self.problem, inside)) if block.outside else ()
        left = self.screen(inside, outside)
        if not left or left[0].gain < self.noticeable(inside):
            return inside
        every = (*block.candidates, *outside)
        best = max(inside, self.forward(self.null, every, deepest=_DEEPEST_OUTSIDE), key=score)
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
        near = [one for one in self.fitted.values() if one is not self.null and self._within_reach(one, best)]
        with ThreadPoolExecutor(_WORKERS) as pool:
            for one in pool.map(lambda one: refined(corrected, transferred(corrected, one)), near):
                search._keep(one)
        search.whole(search.best)
        return search

    def sharpen(self) -> None:
        """Differentiate anew, at every instant, the models that may be named."""
        close = [key for key, one in self.fitted.items() if score(one) > score(self.best) - _POSSIBLE]
        with ThreadPoolExecutor(_WORKERS) as pool:
            sharp = pool.map(lambda key: sharpened(self.problem, self.fitted[key]), close)
            self.fitted.update(zip(close, sharp, strict=True))

    def noticeable(self, one: Fit) -> float:
        """Gain of log-likelihood below which what is left does not matter."""
        explained = one.log_likelihood - self.null.log_likelihood
        return OUTSIDE_COST + 4.0 + 0.003 * explained

    def backward(self, best: Fit) -> Fit:
        """Remove effects as long as the evidence grows."""
        while len(best.space.effects) > 1:
            smaller = [self._without(best, kind) for kind in best.space.effects]
            challenger = max(smaller, key=score)
            if not self._matters(best, challenger):
                self.fitted.pop(frozenset(best.space.names), None)
            elif score(challenger) <= score(best):
                break
            best = challenger
        return best

    def _without(self, one: Fit, kind: type[Effect]) -> Fit:
        left = tuple(other for other in one.space.effects if other is not kind)
        space = ModelSpace(one.space.block, left)
        key = frozenset(space.names)
        if key in self.fitted:
            return self.fitted[key]
        start = space.inherited(one.space, one.coordinates)
        return self._keep(refined(self.problem, fit(self.problem, space, [start], one.noise)))
