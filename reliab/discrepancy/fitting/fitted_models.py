"""All models that were fitted to a block: how credible they are, and whether their effects matter."""

from collections.abc import Iterable
from weakref import WeakKeyDictionary

import numpy as np

from reliab.discrepancy.fitting.fit import Fit, fit, refined
from reliab.discrepancy.fitting.left_out import LeftOut, left_out
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.terms import is_outside
from reliab.effects import Effect
from reliab.signals import NoiseModel

COST = 4.0
"""Logarithm of the prior odds against one more effect."""

OUTSIDE_COST = 7.0
"""The same for an effect outside the library."""

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

BESIDE = 0.5
"""Share of the error's energy on left-out tests that an effect must remove from a model with other effects.

It then explains more than half of the error that the others leave. An effect that explains less may as likely
be a part of the model's error that happens to resemble it."""

_LEAST_BESIDE, _LEAST_OUTSIDE = 0.03, 0.05
# shares of the whole gap's energy that an effect beside others, and a term outside the library, must close
_NO_WORSE = 0.02  # growth of the error on left-out tests that noise brings about


def cost(kinds: Iterable[type[Effect]]) -> float:
    """Prior odds against a set of effects, as a logarithm; a special form of an effect counts twice."""
    return sum(OUTSIDE_COST if is_outside(kind) else COST * (1 + bool(kind.refines)) for kind in kinds)


class FittedModels:
    """All models of a block that were fitted, by the names of their effects."""

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
        """Exclude a model from the search permanently, because one of its effects does not matter."""
        key = frozenset(candidate.space.names)
        self.rejected.add(key)
        self.fitted.pop(key, None)

    def score(self, candidate: Fit) -> float:
        """Logarithm of how credible a fitted model is, up to a constant.

        Where models are judged against noise, evidence and prior odds; else the predictive likelihood of
        tests that are left out one at a time, for normal errors of unknown size, which already penalises
        parameters.
        """
        if not self.problem.flat:
            return candidate.log_evidence - cost(candidate.space.effects)
        return self.likelihood(self.error(candidate)) - cost(candidate.space.effects)

    def likelihood(self, error: LeftOut) -> float:
        """Logarithm of the predictive likelihood of left-out tests, where errors judge."""
        return -0.5 * self.observations * float(np.log(max(error.energy, 1e-300)))

    @property
    def observations(self) -> float:
        """Number of independent observations of an error, over all tests, where errors judge."""
        shares = zip(self.problem.tempering, self.problem.segments, strict=True)
        return sum(share * (2 * segment.bins - 1) for share, segment in shares)

    def error(self, candidate: Fit) -> LeftOut:
        """Error of a model on each test when it is fitted to the others."""
        if candidate not in self._errors:
            self._errors[candidate] = left_out(self.problem, candidate)
        return self._errors[candidate]

    def plain(self) -> Fit:
        """Calibrate by ordinary least squares, without a noise model, as a laboratory would."""
        variance = float(
            np.mean(self.null.noise.density(np.linspace(0.0, 0.5 * self.problem.block.rate, 99)))
        )
        white = NoiseModel.white(self.null.noise.rate, variance)
        return fit(self.problem, self.null.space, [self.null.coordinates], white)

    @property
    def best(self) -> Fit:
        """The most credible of all fitted models."""
        return max(self.fitted.values(), key=self.score)

    def _matters(self, candidate: Fit, smaller: Fit, *, beside: float = MATERIAL) -> bool:
        """Whether the additional effects of a model over a smaller one are not negligible.

        `beside` is the share of the error's energy on left-out tests that it must take off a smaller model
        that has effects, where errors judge.
        """
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
            share = beside if smaller.space.effects else MATERIAL
            return large and self._predicts(candidate, smaller, 1.0 - share)
        if smaller is self.null:
            return True
        closed = self._energy(self.null, candidate.noise) - remaining
        if gained > LEAST_SHARE * closed:
            return self._predicts(candidate, smaller, 1.0 + _NO_WORSE)
        audible = gained > MATERIAL * (remaining + gained)
        return audible and self.error(candidate).energy <= (1.0 - MATERIAL) * self.error(smaller).energy

    def _predicts(self, candidate: Fit, smaller: Fit, most: float) -> bool:
        """Whether a model's error on left-out tests is at most a multiple of that of a smaller model."""
        return self.error(candidate).at_most(most, self.error(smaller))

    def supported(self, candidate: Fit) -> bool:
        """Whether a model may be named: each of its effects matters against the models without it.

        Where errors judge, an effect beside others must explain more of what they leave than remains; so
        must terms outside the library of what the library's best model leaves. An effect that has a simpler
        one for a limiting case must predict left-out tests better than that one.
        """
        effects = candidate.space.effects
        smaller = (self.without(candidate, kind) for kind in effects)
        if not all(self._matters(candidate, fitted, beside=BESIDE) for fitted in smaller):
            return False
        if not self.problem.flat:
            return True
        known = self._best_known()
        outside = known.space.effects and any(map(is_outside, effects))
        limits = [(known, BESIDE)] if outside else []
        limits += [(simpler, MATERIAL) for simpler in self._limiting(candidate)]
        return all(self._predicts(candidate, fitted, 1.0 - share) for fitted, share in limits)

    def _best_known(self) -> Fit:
        """Return the most credible model of members of the library alone."""
        known = [fit for fit in self.fitted.values() if not any(map(is_outside, fit.space.effects))]
        return max(known, key=self.score)

    def _limiting(self, candidate: Fit) -> list[Fit]:
        """Fitted models with the limiting case of one of a model's effects in its place."""
        effects = set(candidate.space.effects)
        keys = [
            frozenset(str(effect.name) for effect in (effects - {kind}) | {simpler})
            for kind in effects
            for simpler in kind.limiting_cases
            if simpler not in effects
        ]
        return [self.fitted[key] for key in keys if key in self.fitted]

    def _energy(self, candidate: Fit, noise: NoiseModel) -> float:
        """Energy that a model leaves, whitened by a given noise."""
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
        return self._keep(refined(self.problem, fit(self.problem, space, [start], candidate.noise)))
