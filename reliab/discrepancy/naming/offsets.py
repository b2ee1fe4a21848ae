"""Offsets of a sensor: fitted with every model, and named where they matter."""

import numpy as np

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.fitted_models import COST, MATERIAL
from reliab.discrepancy.fitting.left_out import left_out
from reliab.discrepancy.fitting.search import Search
from reliab.effects import Effect

_SMALLEST_OFFSET = 2e-3  # of the channel's RMS


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
