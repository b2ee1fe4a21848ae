"""Search where the best model leaves an error that follows the motion: parts that are left out judge.

No member of the library is exact then, and any of them explains a little of the error. Every model holds the
best linear one of its block. Effects are added as long as left-out parts are predicted better, and every
model stays on the list: the held-out tests have the last word (`naming/choice.py`).
"""

from collections.abc import Sequence

import numpy as np

from reliab.core.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.left_out import LeftOut, leave_out
from reliab.discrepancy.fitting.prior import COST_BESIDE_ERROR, cost_beside_error
from reliab.discrepancy.fitting.problem import Problem, observations
from reliab.discrepancy.fitting.screening import Promise
from reliab.discrepancy.fitting.search import Search
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general

WORTH = 0.1
"""Share of the error's energy on left-out parts, a twentieth of its RMS, that further effects must remove."""

_DEEPEST = 3  # effects beside the linear ones
_BEAM = 2
_TRIES, _GENERAL_TRIES = 8, 5
_RIVALS = 3  # of each effect of the best model
_TRIFLE = 0.02  # of the error's energy in the fitted tests
_SIMPLE = 2  # parameters; effects of more have several optima where no model is exact


class ErrorSearch(Search):
    """Fit models of a block with ever more effects, and list them by their error on left-out parts."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.temper(observations(problem)))
        self.keep(self.linear)

    @property
    def candidates(self) -> tuple[type[Effect], ...]:
        """Effects that may be missing; a lag of the force may be an error of the model here."""
        return tuple(kind for kind in self.problem.block.candidates if kind is not ClockOffset)

    def score(self, candidate: Fit) -> float:
        """Predictive log-likelihood of left-out parts for normal errors of unknown size, and prior odds."""
        return self.likelihood(self.error(candidate)) - cost_beside_error(candidate.space.effects)

    def likelihood(self, error: LeftOut) -> float:
        """Logarithm of the predictive likelihood of left-out parts."""
        return -0.5 * self.observations * float(np.log(max(error.energy, 1e-300)))

    @property
    def observations(self) -> float:
        """Number of independent observations of an error, over all tests."""
        shares = zip(self.problem.tempering, self.problem.segments, strict=True)
        return sum(share * (2 * segment.bins - 1) for share, segment in shares)

    def _starts(self, promise: Promise) -> list[Array]:
        """Coordinates from which to fit a further effect: all of one that may have several optima."""
        starts = [promise.start]
        if len(promise.kind.parameters) > _SIMPLE:
            starts += [start for start in promise.others if start is not promise.start]
        return starts

    def _is_material(self, candidate: Fit, smaller: Fit) -> bool:
        """Whether a model is listed: it explains more of the tests to which it is fitted than a trifle."""
        remaining = float(candidate.residual @ candidate.residual)
        return remaining <= (1.0 - _TRIFLE) * self.energy(smaller, candidate.noise)

    def _memory_odds(self, candidate: Fit, problem: Problem, forgetful: Fit) -> float:
        errors = self.error(candidate), leave_out(problem, forgetful)
        return self.likelihood(errors[0]) - self.likelihood(errors[1]) - COST_BESIDE_ERROR

    def _promises_gain(self, best: Fit, residuals: Sequence[Array]) -> bool:
        del best, residuals
        return True

    def _worth_refining(self, rough: Sequence[Fit], parent: Fit) -> float:
        del rough, parent
        return -np.inf

    def run(self, begin: Fit | None = None) -> Fit:
        """Add effects of the library, then special forms, then terms outside it; then try rivals."""
        beam = [begin or self.linear]
        for _ in range(_DEEPEST):
            children = self._children(beam, self.candidates, _TRIES)
            if not children or self._error(children[0]) > (1.0 - WORTH) * self._error(beam[0]):
                break
            beam = children[:_BEAM]
        for model in self._first(_BEAM):
            for kind in model.space.effects:
                self.refine_in(model, kind)
        self._children(self._first(1), self.problem.block.outside, _GENERAL_TRIES)
        self._try_rivals()
        return self.best

    def _try_rivals(self) -> None:
        """Try others in the place of each effect of the best model beside the others.

        In the place of the main one of the library these are of the library, too: a term has no name.
        """
        (model,) = self._first(1)
        block, effects = self.problem.block, model.space.effects
        known_kinds = {*effects, *(kind.refines for kind in effects)}
        others = [kind for kind in (*self.candidates, *block.outside) if kind not in known_kinds]
        smaller = {kind: self.remove_effect(model, kind) for kind in effects if kind not in block.linear}
        library = [kind for kind in smaller if not is_general(kind)]
        main = max(library, key=lambda kind: self._error(smaller[kind]), default=None)
        for kind, parent in smaller.items():
            rivals = [other for other in others if kind is not main or not is_general(other)]
            if len(smaller) > 1:  # in the place of a single one they were tried at first
                self._children([parent], rivals, _RIVALS)

    def _children(self, parents: Sequence[Fit], kinds: Sequence[type[Effect]], trials: int) -> list[Fit]:
        """Models with one more effect, those of the smallest error first."""
        children = [
            child for parent in parents for child in self.extend(parent, self.screen(parent, kinds)[:trials])
        ]
        return sorted(children, key=self._error)

    def _error(self, candidate: Fit) -> float:
        return self.error(candidate).energy

    def _first(self, count: int) -> list[Fit]:
        """Models of the smallest error on left-out parts."""
        return sorted(self.fitted.values(), key=self._error)[:count]
