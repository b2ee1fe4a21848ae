"""Offsets of the clocks beside the models that may be named, whether they are named or not.

Nobody knows that there is none, and parameters of the other effects depend on it.
"""

from reliab.discrepancy.fitting.fit import Fit, fit, refined
from reliab.discrepancy.fitting.search import POSSIBLE, Search
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.terms.clock_offset import ClockOffset


def fit_beside_clocks(search: Search) -> None:
    """Add an offset of the clocks to the models that may be named, where it was rejected, too."""
    if ClockOffset not in search.candidates or ClockOffset not in search.problem.block.twins:
        return
    best = search.score(search.best)
    close = [model for model in search.fitted.values() if search.score(model) > best - POSSIBLE]
    for near in close:
        late = ClockOffset in near.space.effects
        alone = search.without(near, ClockOffset) if late else near
        if alone.space.effects:
            with_clock(search, alone)


def fitted_with_clock(search: Search, fitted: Fit) -> Fit | None:
    """Return a model with an offset of the clocks beside its effects, None where none was tried."""
    return search.with_clocks.get(frozenset({*fitted.space.names, str(ClockOffset.name)}))


def with_clock(search: Search, fitted: Fit) -> Fit:
    """Fit a model with an offset of the clocks together with its effects."""
    space = ModelSpace(fitted.space.block, (*fitted.space.effects, ClockOffset))
    key = frozenset(space.names)
    if key not in search.with_clocks:
        (promise,) = search.screened(fitted, [ClockOffset])
        beside = refined(search.problem, fit(search.problem, space, [promise.start], fitted.noise))
        if search.fitted.get(key) is not None:
            beside = search.keep(beside)
        search.with_clocks[key] = beside
    return search.with_clocks[key]
