"""How probable fitted models, and the effects that they hold, are."""

from collections.abc import Sequence

import numpy as np

from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.result.block_diagnosis import Ranked
from reliab.loop.effects import Effect

SURE = 0.9
"""Probability from which an effect is named."""

_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure


def ranking(search: Search) -> tuple[Ranked, ...]:
    """Fitted models with their probabilities, the most probable first."""
    ordered = sorted(search.fitted.values(), key=search.score, reverse=True)
    weights = np.exp(np.array([search.score(fit) for fit in ordered]) - search.score(ordered[0]))
    shares = (weights / weights.sum()).tolist()
    if search.problem.flat:
        _place(search, ordered)
    return tuple(Ranked(fit=fit, probability=share) for fit, share in zip(ordered, shares, strict=True))


def _place(search: Search, ordered: list[Fit]) -> None:
    """Let the likelihood of all tests tell where along the block the effects of the first model act.

    Models that differ in nothing but that have the same names and as many parameters. A test in which the
    place shows best is missing where it is left out, so that left-out tests often do not tell; the other
    model then takes the first one's rank, and its own rank goes to that one.
    """
    first = ordered[0]
    names = sorted(effect.label() for effect in first.space.effects)
    for rank, rival in enumerate(ordered[1:], start=1):
        same = sorted(effect.label() for effect in rival.space.effects) == names
        if same and search.error(first).undecided(search.error(rival)):
            if rival.log_evidence > first.log_evidence:
                ordered[0], ordered[rank] = rival, first
            return


def probability(ranked: Sequence[Ranked], effect: type[Effect]) -> float:
    """Probability that an effect acts, in whichever variant: of all models that contain it together."""
    label = effect.label()
    return float(sum(r.probability for r in ranked if label in {e.label() for e in r.fit.space.effects}))


def believed(ranked: Sequence[Ranked], null: Fit) -> tuple[Fit, set[type[Effect]], set[type[Effect]]]:
    """Return the model that is believed, its effects that are named, and those of which one acts."""
    best = ranked[0].fit
    effects = best.space.effects
    named = {effect for effect in effects if probability(ranked, effect) >= SURE}
    rest = set(effects) - named
    fewer = sum(r.probability for r in ranked if len(r.fit.space.effects) < len(effects))
    doubtful = rest if not named and fewer < _NEGLIGIBLE else set()
    return _fit_with(ranked, named | doubtful) or null, named, doubtful


def _fit_with(ranked: Sequence[Ranked], effects: set[type[Effect]]) -> Fit | None:
    return next((r.fit for r in ranked if set(r.fit.space.effects) == effects), None)
