"""The best effect that could explain the data in place of a sensor's offset."""

from copy import copy
from dataclasses import dataclass, replace

from reliab.discrepancy.fitting.fit import Fit, fit, reweighted
from reliab.discrepancy.fitting.fitted_models import MATERIAL, FittedModels
from reliab.discrepancy.fitting.left_out import left_out
from reliab.discrepancy.fitting.screening import screened
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.effects import Effect


@dataclass(frozen=True, kw_only=True, eq=False)
class OffsetRival:
    """A model that holds an effect in the place of an offset."""

    effect: type[Effect]  # The effect
    fit: Fit  # The model, in which the offset is zero
    # Logarithm of how much more credible it is than the model with the offset, by the judge of the search
    odds: float


def offset_rival(search: FittedModels, best: Fit, offset: type[Effect]) -> OffsetRival | None:
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
    promising = screened(problem, without, block.candidates, without)
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
