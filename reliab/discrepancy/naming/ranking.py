"""How probable fitted models, and the effects that they hold, are."""

from collections.abc import Sequence

import numpy as np

from reliab.arrays import Array
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.prior import cost
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.result.block_diagnosis import Ranked
from reliab.discrepancy.terms import ClockOffset
from reliab.effects import Effect

SURE = 0.9
"""Probability from which an effect is named."""

_DRAWS, _SEED = 1000, 20
_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_LIKELY = 0.5  # the same where clocks may differ, which changes the parameters of the other effects


def ranking(search: Search) -> tuple[Ranked, ...]:
    """Fitted models with their probabilities, the most probable first."""
    models = [*search.fitted.values(), *_with_clocks(search)]
    shares = _shares_of_tests(search, models) if search.problem.flat else _shares_of_scores(search, models)
    order = np.argsort(-shares, kind="stable")
    ordered = [models[k] for k in order]
    if search.problem.flat:
        _place(search, ordered)
    return tuple(
        Ranked(fit=fit, probability=share) for fit, share in zip(ordered, shares[order].tolist(), strict=True)
    )


def _with_clocks(search: Search) -> list[Fit]:
    """Models with an offset of the clocks that is too small to be named, beside effects that are needed."""
    return [
        fit
        for key, fit in search.with_clocks.items()
        if key not in search.fitted
        and key - {str(ClockOffset.name)} in search.fitted  # effects that were rejected are not needed
        and not any(
            ClockOffset in fewer.space.effects and names < key and search.score(fewer) >= search.score(fit)
            for names, fewer in search.fitted.items()
        )
    ]


def _shares_of_scores(search: Search, models: Sequence[Fit]) -> Array:
    """Probability of each model by its score, shape (models,).

    Between the first one and those with a twin of one of its effects in its place the data alone decide, and
    not how probable a gain or a size would have been before them. Simulations of one model differ, too: by
    what that may change in the likelihood none is preferred.
    """
    scores = np.array([search.score(fit) for fit in models])
    for place, fit in enumerate(models[len(search.fitted) :], start=len(search.fitted)):
        alone = models.index(search.fitted[frozenset(fit.space.names) - {str(ClockOffset.name)}])
        scores[alone] = max(scores[alone], scores[place])
    first = models[int(np.argmax(scores))]
    for place, fit in enumerate(models):
        if _is_twin(search, first, fit):
            unsure = 0.5 * MODEL_ERROR**2 * search.problem.loudness(first.noise)
            lost = max(first.log_likelihood - fit.log_likelihood - unsure, 0.0)
            scores[place] = max(scores[place], float(scores.max()) - lost)
    return _softmax(scores)


def _is_twin(search: Search, first: Fit, rival: Fit) -> bool:
    """Whether a model differs from another by one effect, which the block may be unable to tell."""
    gone = set(first.space.effects) - set(rival.space.effects)
    added = set(rival.space.effects) - set(first.space.effects)
    if len(gone) != 1 or len(added) != 1:
        return False
    return next(iter(added)) in search.problem.block.twins.get(next(iter(gone)), ())


def _shares_of_tests(search: Search, models: Sequence[Fit]) -> Array:
    """Probability of each model by its errors on left-out tests, shape (models,).

    The tests of a campaign are a few of all that could have been run. Their weights are drawn anew from the
    flat Dirichlet distribution (the Bayesian bootstrap), and probabilities are averaged over the draws, so
    that a model that wins by a single test is not certain (pseudo-BMA+ of Yao and others, 2018,
    doi:10.1214/17-BA1091).
    """
    errors = np.stack([search.error(fit).relative for fit in models])
    weights = np.random.default_rng(_SEED).dirichlet(np.ones(errors.shape[1]), _DRAWS) * errors.shape[1]
    likelihoods = search.observations * -0.5 * np.log(np.maximum(weights @ errors.T, 1e-300))
    costs = np.array([cost(fit.space.effects) for fit in models])
    return np.asarray(_softmax(likelihoods - costs).mean(axis=0))


def _softmax(scores: Array) -> Array:
    weights = np.exp(scores - scores.max(axis=-1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def _place(search: Search, ordered: list[Fit]) -> None:
    """Decide by the likelihood of all tests where along the block the effects of the first model act.

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
    sure_effects = {effect for effect in effects if probability(ranked, effect) >= SURE}
    less_sure = set(effects) - sure_effects
    fewer = sum(r.probability for r in ranked if len(r.fit.space.effects) < len(effects))
    most = _LIKELY if any(effect is ClockOffset for effect in less_sure) else _NEGLIGIBLE
    doubtful = less_sure if fewer < most else set()
    return _fit_with(ranked, sure_effects | doubtful) or null, sure_effects, doubtful


def _fit_with(ranked: Sequence[Ranked], effects: set[type[Effect]]) -> Fit | None:
    return next((r.fit for r in ranked if set(r.fit.space.effects) == effects), None)
