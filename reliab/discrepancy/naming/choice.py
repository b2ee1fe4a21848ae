"""Which of all fitted models is believed: the most credible one that the held-out tests do not contradict."""

from collections.abc import Collection, Iterator, Mapping, Sequence, Set as AbstractSet
from dataclasses import dataclass

import numpy as np

from reliab.core.arrays import Array
from reliab.core.significant_digits import percent
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.left_out import LeftOut, errors_of_parts
from reliab.discrepancy.fitting.noise_test import is_noise
from reliab.discrepancy.fitting.prior import LEAST_SHARE, MATERIAL, cost_beside_error
from reliab.discrepancy.fitting.problem import Problem, observations
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.locate import LEAST_PROBABILITY
from reliab.discrepancy.proof import compute_nrmse
from reliab.discrepancy.result.block_diagnosis import RankedModel
from reliab.discrepancy.result.gap import NO_CHANGE
from reliab.discrepancy.terms import ClockOffset, StatedDamping
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general

SURE = 0.9
"""Probability from which an effect is named."""

_DRAWS, _SEED = 1000, 20
_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_LIKELY = 0.5  # the same where clocks may differ, which changes the parameters of the other effects
_EXPLAINS = 0.5  # of what the best model explains of the fitted tests
_STANDARD_ERRORS = 2.0  # within which held-out tests do not tell models apart
_MORE_THAN_LEFT = 2.0  # energy without an effect over that with it, from which it explains more than is left


def ranking(search: Search, proof: Problem) -> tuple[RankedModel, ...]:
    """All fitted models with their probabilities and errors, the most probable first."""
    models = [*search.fitted.values(), *_clock_models(search)]
    residuals_by_model = [proof.residuals(model) for model in models]
    if isinstance(search, ErrorSearch):
        held_out = [errors_of_parts(proof, model_residuals) for model_residuals in residuals_by_model]
        shares = _shares_of_parts(search, models, held_out, sum(observations(proof).values()))
    else:
        shares = _shares_of_scores(search, models)
    rows = [
        RankedModel(
            fit=model,
            probability=max(share, LEAST_PROBABILITY),
            left_out=search.error(model).nrmse,
            held_out=compute_nrmse(proof, residual),
        )
        for model, share, residual in zip(models, shares.tolist(), residuals_by_model, strict=True)
    ]
    return tuple(sorted(rows, key=lambda row: -row.probability))


def _clock_models(search: Search) -> list[Fit]:
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
    scores = np.array([search.score(model) for model in models])
    for place, model in enumerate(models[len(search.fitted) :], start=len(search.fitted)):
        smaller = models.index(search.fitted[frozenset(model.space.names) - {str(ClockOffset.name)}])
        scores[smaller] = max(scores[smaller], scores[place])
    first = models[int(np.argmax(scores))]
    for place, model in enumerate(models):
        if _is_twin(search, first, model):
            unsure = 0.5 * MODEL_ERROR**2 * search.problem.loudness(first.noise)
            loss = max(first.log_likelihood - model.log_likelihood - unsure, 0.0)
            scores[place] = max(scores[place], float(scores.max()) - loss)
    return _softmax(scores)


def _is_twin(search: Search, first: Fit, rival: Fit) -> bool:
    """Whether a model differs from another by one effect, which the block may be unable to tell."""
    gone = set(first.space.effects) - set(rival.space.effects)
    added_effects = set(rival.space.effects) - set(first.space.effects)
    if len(gone) != 1 or len(added_effects) != 1:
        return False
    return next(iter(added_effects)) in search.problem.block.twins.get(next(iter(gone)), ())


def _shares_of_parts(
    search: ErrorSearch, models: Sequence[Fit], held_out: Sequence[LeftOut], held_out_observations: float
) -> Array:
    """Probability of each model by its errors on left-out parts and on held-out tests, shape (models,).

    The parts are a few of all that could have been run. Their weights are drawn anew from the flat Dirichlet
    distribution (the Bayesian bootstrap), and probabilities are averaged over the draws, so that a model that
    wins by a single part is not certain (pseudo-BMA+ of Yao and others, 2018, doi:10.1214/17-BA1091). Models
    that differ in nothing but linear effects share one prior: no effect is more probable because it was tried
    with and without a damper.
    """
    errors = np.stack(
        [
            np.concatenate([search.error(model).relative, out.relative])
            for model, out in zip(models, held_out, strict=True)
        ]
    )
    weights = np.random.default_rng(_SEED).dirichlet(np.ones(errors.shape[1]), _DRAWS) * errors.shape[1]
    likelihoods = (
        -0.5 * (search.observations + held_out_observations) * np.log(np.maximum(weights @ errors.T, 1e-300))
    )
    kinds = [frozenset(model.space.effects).difference(search.problem.block.linear) for model in models]
    costs = np.array(
        [
            cost_beside_error(model.space.effects) + np.log(kinds.count(own))
            for model, own in zip(models, kinds, strict=True)
        ]
    )
    return np.asarray(_softmax(likelihoods - costs).mean(axis=0))


def _softmax(scores: Array) -> Array:
    weights = np.exp(scores - scores.max(axis=-1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def probability(rows: Sequence[RankedModel], effect: type[Effect]) -> float:
    """Probability that an effect acts, in whichever variant or form: of all models that contain one."""
    return float(sum(row.probability for row in rows if _holds(row, effect)))


def _holds(row: RankedModel, effect: type[Effect]) -> bool:
    """Whether a model holds an effect in some form."""
    return bool(_forms_of(effect, row.fit.space.effects))


def _forms_of(effect: type[Effect], others: Collection[type[Effect]]) -> set[type[Effect]]:
    """Find an effect among others: itself, or else its forms at any place, and compositions with it."""
    labels = {kind.label() for kind in (effect, effect.refines) if kind is not None}
    return {effect}.intersection(others) or {
        other
        for other in others
        for part in (other, other.refines, *other.members)
        if part is not None and part.label() in labels
    }


def _holds_once(effects: Sequence[type[Effect]], kind: type[Effect]) -> bool:
    """Whether one of some effects is a form of another one, at its place along the block alone."""
    forms, labels = _forms_of(kind, effects), [effect.label() for effect in effects]
    return [(form.position, labels.count(form.label())) for form in forms] == [(kind.position, 1)]


@dataclass(frozen=True, kw_only=True, eq=False)
class Choice:
    """The model that is believed."""

    best: RankedModel  # Which
    plain: RankedModel  # The one from which effects have their names; the best one may refine it
    sure: frozenset[type[Effect]]  # Effects of both that are named
    doubtful: frozenset[type[Effect]]  # Effects of both of which one acts
    refining: Mapping[type[Effect], float]  # Effects without a name, with the errors without them
    contradicted: RankedModel | None  # A more probable model that the held-out tests contradict
    # Probable effects that change nothing on held-out tests, with the errors with and without each
    unchanging: tuple[tuple[type[Effect], float, float], ...]


def choose(search: Search, rows: Sequence[RankedModel], proof: Problem) -> Choice:
    """Name effects of the most probable model that the held-out tests sustain, and believe what refines it.

    Where no model is exact, effects have their names without terms outside the library, whose shapes they
    would make up for. What refines that model has no name, unless it explains more than is left: terms are an
    unknown effect then.
    """
    plain, unchanging = _simplify(search, rows, _find_plain(search, rows, proof), proof)
    plain, sure, doubtful = _split_by_certainty(search, rows, plain)
    nameless, weak = _weigh(search, rows, plain, proof)
    named = (sure | doubtful) - nameless
    best, _ = _simplify(search, rows, _find_refinement(search, rows, plain, named), proof)
    effects = best.fit.space.effects
    known_effects: set[type[Effect]] = {ClockOffset, StatedDamping}
    if best is not plain and min(_energy_ratios(plain, best)) >= _MORE_THAN_LEFT:
        nameless, weak = _weigh(search, rows, best, proof)
        named = sure | doubtful
        known_effects |= {kind for kind in effects if is_general(kind)}
    sure_forms, doubtful_forms = (
        frozenset(form for kind in kinds & named for form in _forms_of(kind, effects)) - nameless
        for kinds in (sure, doubtful)
    )
    known_effects |= sure_forms | doubtful_forms
    return Choice(
        best=best,
        plain=plain,
        sure=sure_forms - weak,
        doubtful=doubtful_forms | weak.intersection(effects),
        refining={
            kind: _remove_effect(search, rows, best, kind, proof).held_out
            for kind in effects
            if kind not in known_effects - nameless
        },
        contradicted=rows[0] if rows[0].held_out > (1.0 + NO_CHANGE) * best.held_out else None,
        unchanging=tuple(row for row in unchanging if row[0] not in effects),
    )


def _find_plain(search: Search, rows: Sequence[RankedModel], proof: Problem) -> RankedModel:
    """Find the most probable model that the held-out tests sustain, without terms where no model is exact."""
    if not isinstance(search, ErrorSearch):
        return find_sustained(rows)
    plain_rows = [row for row in rows if not any(map(is_general, row.fit.space.effects))]
    return _place_effects(search, find_sustained(plain_rows), proof)


def _simplify(
    search: Search, rows: Sequence[RankedModel], best: RankedModel, proof: Problem
) -> tuple[RankedModel, list[tuple[type[Effect], float, float]]]:
    """Leave out effects that change nothing on held-out tests, all together; the errors with and without."""
    limit, unchanging = np.inf, list[tuple[type[Effect], float, float]]()
    while True:
        limit = min(limit, (1.0 + NO_CHANGE) * best.held_out)
        smaller = {kind: _remove_effect(search, rows, best, kind, proof) for kind in _removable(best)}
        idle = [
            (kind, row)
            for kind, row in smaller.items()
            if row.held_out <= limit and not _is_silent(search, best, row, proof)
        ]
        if not idle:
            return best, unchanging
        kind, row = min(idle, key=lambda item: item[1].held_out)
        if kind not in search.problem.block.linear or not isinstance(search, ErrorSearch):
            unchanging.append((kind, best.held_out, row.held_out))
        best = row


def _removable(row: RankedModel) -> list[type[Effect]]:
    """Effects of a model that are neither clocks that differ nor stated values."""
    return [kind for kind in row.fit.space.effects if kind not in (ClockOffset, StatedDamping)]


def _find_refinement(
    search: Search, rows: Sequence[RankedModel], plain: RankedModel, named: AbstractSet[type[Effect]]
) -> RankedModel:
    """Find the model that predicts held-out tests, and left-out parts, better than a plain one.

    It holds the named effects of that, each at one place, unless it explains more of what that leaves than it
    leaves itself. Where noise judges, evidence has said which effects a model needs.
    """
    if not isinstance(search, ErrorSearch):
        return plain
    better = [
        row
        for row in _explaining(rows)
        if row.held_out < (1.0 - NO_CHANGE) * plain.held_out and row.left_out <= plain.left_out
        if min(_energy_ratios(plain, row)) >= _MORE_THAN_LEFT
        or all(_holds_once(row.fit.space.effects, kind) for kind in named)
    ]
    least = min((row.held_out for row in better), default=0.0)
    return next((row for row in better if row.held_out <= (1.0 + NO_CHANGE) * least), plain)


def best_rival(rows: Sequence[RankedModel], effects: Sequence[type[Effect]]) -> RankedModel | None:
    """Find the model of the smallest error on held-out tests that lacks some effect in whichever form."""
    rivals = [row for row in rows if not all(_holds(row, kind) for kind in effects)]
    return min(rivals, key=lambda row: row.held_out, default=None)


def names_of(row: RankedModel) -> str:
    """Write the effects of a model in words."""
    return " + ".join(name.replace("_", " ") for name in row.names) or "no effect"


def remarks_on(choice: Choice) -> Iterator[str]:
    """Say which models held-out tests contradict, and which effects change nothing there."""
    best, rival = choice.best, choice.contradicted
    if rival is not None:
        yield (
            f"The held-out tests contradict {names_of(rival)}, which would explain the fitted tests: it "
            f"leaves {percent(rival.held_out)} of the signal, {names_of(best)} {percent(best.held_out)}."
        )
    refined: dict[str, list[str]] = {}
    for effect, error_without in choice.refining.items():
        little = not explains_more_than_left(error_without, best.held_out)
        reason = "it explains too little" if little else "other effects explain nearly as much"
        words = f"{effect.label().replace('_', ' ')} {effect.position}".strip()
        refined.setdefault(reason, []).append(f"{words} ({percent(error_without)} without it)")
    for reason, effects in refined.items():
        yield (
            f"In model.toml without a name, because {reason}: {', '.join(effects)}. With all effects "
            f"{percent(best.held_out)} of the signal remains on held-out tests."
        )
    for effect, error_with, error_without in choice.unchanging:
        worse = error_without < (1.0 - NO_CHANGE) * error_with
        verdict = "is contradicted by the held-out tests" if worse else "changes nothing on held-out tests"
        yield (
            f"{effect.label().replace('_', ' ').capitalize()} {verdict} ({percent(error_with)} of the signal "
            f"with it, {percent(error_without)} without): it is not named."
        )


def find_sustained(rows: Sequence[RankedModel]) -> RankedModel:
    """Find the most probable model that predicts held-out tests as well as any that explains the others."""
    explaining = _explaining(rows)
    least = min(row.held_out for row in explaining)
    return next(row for row in explaining if row.held_out <= (1.0 + NO_CHANGE) * least)


def _explaining(rows: Sequence[RankedModel]) -> list[RankedModel]:
    """Models that explain the fitted tests.

    They take off half of what the best one takes off the error of the worst on left-out parts.
    """
    squares = np.array([row.left_out**2 for row in rows])
    worst = max(row.left_out**2 for row in rows if not row.fit.space.effects)
    limit = worst - _EXPLAINS * (worst - squares.min())
    return [row for row, square in zip(rows, squares, strict=True) if square <= limit]


def _place_effects(search: ErrorSearch, best: RankedModel, proof: Problem) -> RankedModel:
    """Let the likelihood say where along the block an effect acts if no part that is left out does.

    Models that differ in nothing but that have the same names and as many parameters. A part in which the
    place shows best is missing where it is left out.
    """
    for kind in best.fit.space.effects:
        for other in search.candidates:
            is_elsewhere = other.position and other is not kind and other.label() == kind.label()
            if not is_elsewhere or other in best.fit.space.effects:
                continue
            moved = search.exchange(best.fit, kind, other)
            if moved.log_likelihood > best.fit.log_likelihood and not _is_told(
                search, moved, best.fit, proof
            ):
                return row_of(search, moved, proof)
    return best


def _is_told(search: Search, first: Fit, second: Fit, proof: Problem) -> bool:
    """Whether left-out parts and held-out tests tell two models apart, by the mean ratio of their errors."""
    first_errors, second_errors = (
        np.concatenate(
            [search.error(model).relative, errors_of_parts(proof, proof.residuals(model)).relative]
        )
        for model in (first, second)
    )
    ratios = np.log(np.maximum(first_errors, 1e-300) / np.maximum(second_errors, 1e-300))
    return bool(abs(ratios.mean()) > _STANDARD_ERRORS * ratios.std(ddof=1) / np.sqrt(ratios.size))


def row_of(search: Search, fit: Fit, proof: Problem) -> RankedModel:
    """Return a model that was fitted after all others were ranked."""
    error = compute_nrmse(proof, proof.residuals(fit))
    return RankedModel(fit=fit, probability=0.0, left_out=search.error(fit).nrmse, held_out=error)


def _weigh(
    search: Search, rows: Sequence[RankedModel], best: RankedModel, proof: Problem
) -> tuple[set[type[Effect]], set[type[Effect]]]:
    """Find effects that are too little for a name, and a main one that is in doubt.

    Where noise is left, one of several is too little if it closes a trifle of the gap. Nearly any effect
    explains some of an error that follows the motion, however: there, one has a name only if it is in most
    models by their probability, and takes off more of the energy than the effects that have a name leave
    together, on left-out parts as on held-out tests: beside other effects in its place, too, and without
    those that have none. The main one does so by itself, or something of its kind acts; that one of both
    shows it is enough, because a limit acts in the strongest tests alone.
    """
    kinds = _removable(best)
    smaller = {kind: _remove_effect(search, rows, best, kind, proof) for kind in kinds}
    if not kinds or (not isinstance(search, ErrorSearch) and is_noise(search.problem, best.fit)):
        return _find_trifles(search, rows, best, smaller, proof), set()
    main = max(kinds, key=lambda kind: (not is_general(kind), smaller[kind].held_out))
    named, model = [*kinds], best
    while others := [kind for kind in named if kind is not main]:
        ratios = {kind: _least_ratio(search, rows, model, kind, proof) for kind in others}
        likely = {kind: probability(rows, kind) >= _LIKELY for kind in others}
        least = min(ratios, key=lambda kind: (likely[kind], ratios[kind]))
        if likely[least] and ratios[least] >= _MORE_THAN_LEFT:
            break
        named.remove(least)
        model = _remove_effect(search, rows, model, least, proof)
    without_main = _remove_effect(search, rows, model, main, proof)
    weak = set() if max(_energy_ratios(without_main, model)) >= _MORE_THAN_LEFT else {main}
    return set(kinds) - set(named), weak


def _find_trifles(
    search: Search,
    rows: Sequence[RankedModel],
    best: RankedModel,
    smaller: Mapping[type[Effect], RankedModel],
    proof: Problem,
) -> set[type[Effect]]:
    """Find effects that close a trifle of the gap on held-out tests and little of what is left there.

    The only effect of a model is no trifle, nor is one that those tests cannot show.
    """
    worst = max(row.held_out for row in rows if not row.fit.space.effects)
    closed_energy = worst**2 - best.held_out**2
    return {
        kind
        for kind, row in smaller.items()
        if len(smaller) > 1
        and row.held_out**2 - best.held_out**2 < LEAST_SHARE * closed_energy
        and best.held_out**2 > (1.0 - MATERIAL) * row.held_out**2
        and not _is_silent(search, best, row, proof)
    }


def _least_ratio(
    search: Search, rows: Sequence[RankedModel], model: RankedModel, kind: type[Effect], proof: Problem
) -> float:
    """Energy left without an effect of a model, by a model with no more effects, over that left with it."""
    linear = set(search.problem.block.linear)
    most = len(set(model.fit.space.effects) - linear)
    rivals = [
        row for row in rows if len(set(row.fit.space.effects) - linear) <= most and not _holds(row, kind)
    ]
    rivals.append(_remove_effect(search, rows, model, kind, proof))
    return min(min(_energy_ratios(rival, model)) for rival in rivals)


def _energy_ratios(rival: RankedModel, model: RankedModel) -> tuple[float, float]:
    """Energy that a rival leaves over that which a model leaves, of left-out parts and of held-out tests."""
    return (rival.left_out / model.left_out) ** 2, (rival.held_out / model.held_out) ** 2


def explains_more_than_left(error_without: float, error_with: float) -> bool:
    """Whether an effect takes off more energy than is left with it, by errors on held-out tests."""
    return error_without**2 >= _MORE_THAN_LEFT * error_with**2


def _remove_effect(
    search: Search,
    ranked_models: Sequence[RankedModel],
    best: RankedModel,
    kind: type[Effect],
    proof: Problem,
) -> RankedModel:
    """Return the best model without an effect of another one: refitted, or with still fewer effects.

    Where no model is exact it may hold any linear effect in the place of another: what those explain as well,
    no other one has shown.
    """
    linear = set(search.problem.block.linear)
    possible_effects = set(best.fit.space.effects) - {kind} | (set() if kind in linear else linear)
    fit = search.remove_effect(best.fit, kind)
    rows = [row for row in ranked_models if row.fit is fit or set(row.fit.space.effects) <= possible_effects]
    if all(row.fit is not fit for row in rows):
        rows.append(row_of(search, fit, proof))
    if not isinstance(search, ErrorSearch):
        return next(row for row in rows if row.fit is fit)
    return min(rows, key=lambda row: row.held_out)


def _is_silent(search: Search, best: RankedModel, smaller: RankedModel, proof: Problem) -> bool:
    """Whether held-out tests could not show an effect of this size, which the fitted ones show.

    They do not reach a limit of the stroke, say, or what the effect does to their energy is less than twice
    its standard error, 2 d σ/√n for a difference d of the predictions. The fitted tests decide then.
    """
    noise, least = best.fit.noise, (1.0 + NO_CHANGE) ** 2
    if search.energy(smaller.fit, noise) <= least * search.energy(best.fit, noise):
        return False
    scatter = 0.0 if isinstance(search, ErrorSearch) else (2.0 * _STANDARD_ERRORS) ** 2 / proof.rows
    best_residuals, smaller_residuals = (proof.residuals(row.fit) for row in (best, smaller))
    change = compute_nrmse(
        proof, {test: smaller_residuals[test] - values for test, values in best_residuals.items()}
    )
    return (change / best.held_out) ** 2 < max(least - 1.0, scatter)


def _split_by_certainty(
    search: Search, rows: Sequence[RankedModel], best: RankedModel
) -> tuple[RankedModel, set[type[Effect]], set[type[Effect]]]:
    """Return the model that is believed, its effects that are named, and those of which one acts.

    Where noise judges, an effect that is not sure is in doubt only where something is missing for sure, and
    left out of the model otherwise.
    """
    effects = best.fit.space.effects
    sure = {effect for effect in effects if probability(rows, effect) >= SURE}
    less_sure = set(effects) - sure
    if isinstance(search, ErrorSearch):
        return best, sure, less_sure
    fewer = sum(row.probability for row in rows if len(row.fit.space.effects) < len(effects))
    largest_probability = _LIKELY if any(effect is ClockOffset for effect in less_sure) else _NEGLIGIBLE
    doubtful = less_sure if fewer < largest_probability else set()
    credible = next((row for row in rows if set(row.fit.space.effects) == sure | doubtful), None)
    null = next(row for row in rows if not row.fit.space.effects)
    return credible or null, sure, doubtful
