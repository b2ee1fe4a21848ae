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
from reliab.discrepancy.fitting.prior import cost_beside_error
from reliab.discrepancy.fitting.problem import Problem, observations
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.locate import LEAST_PROBABILITY
from reliab.discrepancy.proof import compute_nrmse
from reliab.discrepancy.result.block_diagnosis import RankedModel
from reliab.discrepancy.result.gap import NO_CHANGE
from reliab.effects.clock_offset import ClockOffset
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import is_general
from reliab.effects.stated_damping import StatedDamping

SURE = 0.9
"""Probability from which an effect is named."""

_DRAWS, _SEED = 1000, 20
_NEGLIGIBLE = 0.05  # probability of no effect below which something is missing for sure
_LIKELY = 0.5  # the same where clocks may differ, which changes the parameters of the other effects
_EXPLAINS = 0.5  # of what the best model explains of the fitted tests
_STANDARD_ERRORS = 2.0  # within which held-out tests do not tell models apart
_MORE_THAN_LEFT = 2.0  # energy without an effect over that with it, from which it explains more than is left


@dataclass(frozen=True, kw_only=True, eq=False)
class Ranking:
    """All fitted models of a block with their probabilities and errors."""

    search: Search
    proof: Problem
    rows: tuple[RankedModel, ...]  # The most probable first

    @classmethod
    def from_search(cls, search: Search, proof: Problem) -> "Ranking":
        """Rank all fitted models."""
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
        return cls(search=search, proof=proof, rows=tuple(sorted(rows, key=lambda row: -row.probability)))

    @property
    def by_parts(self) -> bool:
        """Whether left-out parts judge, because no model is exact."""
        return isinstance(self.search, ErrorSearch)

    @property
    def linear(self) -> set[type[Effect]]:
        """Effects that every model of an error may hold."""
        return set(self.search.problem.block.linear)

    def error(self, fit: Fit) -> float:
        """Error of a model on held-out tests, RMS over that of the signal."""
        return compute_nrmse(self.proof, self.proof.residuals(fit))

    def row_of(self, fit: Fit) -> RankedModel:
        """Return a model that was fitted after all others were ranked."""
        error = self.search.error(fit).nrmse
        return RankedModel(fit=fit, probability=0.0, left_out=error, held_out=self.error(fit))

    def probability(self, effect: type[Effect]) -> float:
        """Probability that an effect acts, in whichever variant or form: of all models that contain one."""
        return float(sum(row.probability for row in self.rows if forms_of(effect, row.effects)))

    def find_rival(self, effects: Sequence[type[Effect]]) -> RankedModel | None:
        """Find the model of the smallest error on held-out tests that lacks some effect in whichever form."""
        rivals = [row for row in self.rows if not all(forms_of(kind, row.effects) for kind in effects)]
        return min(rivals, key=lambda row: row.held_out, default=None)

    def remove_effect(self, best: RankedModel, kind: type[Effect]) -> RankedModel:
        """Return a model without an effect: refitted, or with still fewer effects.

        Where no model is exact it may hold any linear effect in the place of another: what those explain as
        well, no other one has shown.
        """
        fit = self.search.remove_effect(best.fit, kind)
        refitted = next((row for row in self.rows if row.fit is fit), None) or self.row_of(fit)
        if not self.by_parts:
            return refitted
        possible = set(best.effects) - {kind} | (set() if kind in self.linear else self.linear)
        rows = [row for row in self.rows if row is refitted or set(row.effects) <= possible]
        return min((*rows, refitted), key=lambda row: row.held_out)

    def simplify(self, best: RankedModel) -> tuple[RankedModel, list[tuple[type[Effect], float, float]]]:
        """Leave out effects that change nothing on held-out tests; the errors with and without each."""
        limit, unchanging = np.inf, list[tuple[type[Effect], float, float]]()
        while True:
            limit = min(limit, (1.0 + NO_CHANGE) * best.held_out)
            smaller = {kind: self.remove_effect(best, kind) for kind in _removable(best)}
            idle = [
                (kind, row)
                for kind, row in smaller.items()
                if row.held_out <= limit and not self.is_silent(best, row)
            ]
            if not idle:
                return best, unchanging
            kind, row = min(idle, key=lambda item: item[1].held_out)
            if not (self.by_parts and kind in self.linear):
                unchanging.append((kind, best.held_out, row.held_out))
            best = row

    def is_silent(self, best: RankedModel, smaller: RankedModel) -> bool:
        """Whether held-out tests could not show an effect of this size, which the fitted ones show.

        They do not reach a limit of the stroke, say, or what the effect does to their energy is less than
        twice its standard error, 2 d σ/√n for a difference d of the predictions. The fitted tests decide
        then.
        """
        noise, least = best.fit.noise, (1.0 + NO_CHANGE) ** 2
        if self.search.energy(smaller.fit, noise) <= least * self.search.energy(best.fit, noise):
            return False
        scatter = 0.0 if self.by_parts else (2.0 * _STANDARD_ERRORS) ** 2 / self.proof.rows
        residuals, smaller_residuals = (self.proof.residuals(row.fit) for row in (best, smaller))
        changes = {test: smaller_residuals[test] - values for test, values in residuals.items()}
        change = compute_nrmse(self.proof, changes)
        return (change / best.held_out) ** 2 < max(least - 1.0, scatter)

    def place_effects(self, best: RankedModel) -> RankedModel:
        """Let the likelihood say where along the block an effect acts if no part that is left out does.

        Models that differ in nothing but that have the same names and as many parameters. A part in which the
        place shows best is missing where it is left out.
        """
        for kind in best.effects:
            for other in self.search.candidates:
                if not other.position or other in best.effects or other.label() != kind.label():
                    continue
                moved = self.search.exchange(best.fit, kind, other)
                is_likelier = moved.log_likelihood > best.fit.log_likelihood
                if is_likelier and not self._tells(moved, best.fit):
                    return self.row_of(moved)
        return best

    def _tells(self, *models: Fit) -> bool:
        """Whether left-out parts and held-out tests tell two models apart, by the mean ratio of errors."""
        logarithms = []
        for model in models:
            held_out = errors_of_parts(self.proof, self.proof.residuals(model))
            errors = np.concatenate([self.search.error(model).relative, held_out.relative])
            logarithms.append(np.log(np.maximum(errors, 1e-300)))
        ratios = logarithms[0] - logarithms[1]
        return bool(abs(ratios.mean()) > _STANDARD_ERRORS * ratios.std(ddof=1) / np.sqrt(ratios.size))

    def split_by_certainty(
        self, best: RankedModel
    ) -> tuple[RankedModel, set[type[Effect]], set[type[Effect]]]:
        """Return the model that is believed, its effects that are named, and those of which one acts.

        Where noise judges, an effect that is not sure is in doubt only where something is missing for sure,
        and left out of the model otherwise.
        """
        sure = {effect for effect in best.effects if self.probability(effect) >= SURE}
        less_sure = set(best.effects) - sure
        if self.by_parts:
            return best, sure, less_sure
        fewer = sum(row.probability for row in self.rows if len(row.effects) < len(best.effects))
        doubtful = less_sure if fewer < (_LIKELY if ClockOffset in less_sure else _NEGLIGIBLE) else set()
        credible = next((row for row in self.rows if set(row.effects) == sure | doubtful), None)
        return credible or next(row for row in self.rows if not row.effects), sure, doubtful

    def weigh(self, best: RankedModel) -> tuple[set[type[Effect]], set[type[Effect]]]:
        """Find effects that are too little for a name, and those that are in doubt.

        Nearly any effect explains some of an error that follows the motion: there, one has a name only if it
        is in most models by their probability, and takes off more of the energy than the effects that have a
        name leave together, on left-out parts as on held-out tests: beside other effects in its place, too,
        and without those that have none. One that takes off so much, but no more than others in its place,
        is in doubt. The main one does so by itself, or something of its kind acts; that one of both shows it
        is enough, because a limit acts in the strongest tests alone.
        """
        kinds = _removable(best)
        if not kinds or not (self.by_parts or not is_noise(self.search.problem, best.fit)):
            return set(), set()
        main = max(kinds, key=lambda kind: (not is_general(kind), self.remove_effect(best, kind).held_out))
        named, model = [*kinds], best
        while others := [kind for kind in named if kind is not main]:
            ratios = {kind: self._least_ratio(model, kind) for kind in others}
            likely = {kind: self.probability(kind) >= _LIKELY for kind in others}
            least = min(ratios, key=lambda kind: (likely[kind], ratios[kind]))
            if likely[least] and ratios[least] >= _MORE_THAN_LEFT:
                break
            named.remove(least)
            model = self.remove_effect(model, least)
        without_main = self.remove_effect(model, main)
        weak = set() if max(_energy_ratios(without_main, model)) >= _MORE_THAN_LEFT else {main}
        nameless = set(kinds) - set(named)
        replaceable = {kind for kind in nameless if self._is_needed(best, kind)}
        return nameless - replaceable, weak | replaceable

    def _is_needed(self, best: RankedModel, kind: type[Effect]) -> bool:
        """Whether a probable effect of the library takes off more energy than the whole model leaves."""
        if is_general(kind) or kind in self.linear or self.probability(kind) < _LIKELY:
            return False
        return min(_energy_ratios(self.remove_effect(best, kind), best)) >= _MORE_THAN_LEFT

    def _least_ratio(self, model: RankedModel, kind: type[Effect]) -> float:
        """Energy left without an effect, by a model with no more effects, over that left with it."""
        most = len(set(model.effects) - self.linear)
        rivals = [
            row
            for row in self.rows
            if len(set(row.effects) - self.linear) <= most and not forms_of(kind, row.effects)
        ]
        return min(min(_energy_ratios(row, model)) for row in (*rivals, self.remove_effect(model, kind)))

    def find_refinement(self, plain: RankedModel, named: AbstractSet[type[Effect]]) -> RankedModel:
        """Find the model that predicts held-out tests, and left-out parts, better than a plain one.

        It holds the named effects of that, each at one place, unless it explains more of what that leaves
        than it leaves itself. Where noise judges, evidence has said which effects a model needs.
        """
        if not self.by_parts:
            return plain
        better = [
            row
            for row in _explaining(self.rows)
            if row.held_out < (1.0 - NO_CHANGE) * plain.held_out and row.left_out <= plain.left_out
            if min(_energy_ratios(plain, row)) >= _MORE_THAN_LEFT
            or all(_holds_once(row.effects, kind) for kind in named)
        ]
        least = min((row.held_out for row in better), default=0.0)
        return next((row for row in better if row.held_out <= (1.0 + NO_CHANGE) * least), plain)


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
    effects, twins = set(first.space.effects), search.problem.block.twins
    for place, model in enumerate(models):
        gone, added = effects.difference(model.space.effects), set(model.space.effects) - effects
        if len(gone) == len(added) == 1 and added <= set(twins.get(gone.pop(), ())):
            unsure = 0.5 * MODEL_ERROR**2 * search.problem.loudness(first.noise)
            loss = max(first.log_likelihood - model.log_likelihood - unsure, 0.0)
            scores[place] = max(scores[place], float(scores.max()) - loss)
    return _softmax(scores)


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
    pairs = zip(models, held_out, strict=True)
    errors = np.stack([np.concatenate([search.error(model).relative, out.relative]) for model, out in pairs])
    weights = np.random.default_rng(_SEED).dirichlet(np.ones(errors.shape[1]), _DRAWS) * errors.shape[1]
    likelihoods = (
        -0.5 * (search.observations + held_out_observations) * np.log(np.maximum(weights @ errors.T, 1e-300))
    )
    kinds = [frozenset(model.space.effects).difference(search.problem.block.linear) for model in models]
    costs = [
        cost_beside_error(model.space.effects) + np.log(kinds.count(own))
        for model, own in zip(models, kinds, strict=True)
    ]
    return np.asarray(_softmax(likelihoods - np.array(costs)).mean(axis=0))


def _softmax(scores: Array) -> Array:
    weights = np.exp(scores - scores.max(axis=-1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=-1, keepdims=True))


def forms_of(effect: type[Effect], others: Collection[type[Effect]]) -> set[type[Effect]]:
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
    forms, labels = forms_of(kind, effects), [effect.label() for effect in effects]
    return [(form.position, labels.count(form.label())) for form in forms] == [(kind.position, 1)]


def _removable(row: RankedModel) -> list[type[Effect]]:
    """Effects of a model that are neither clocks that differ nor stated values."""
    return [kind for kind in row.effects if kind not in (ClockOffset, StatedDamping)]


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
    worst = max(row.left_out**2 for row in rows if not row.effects)
    limit = worst - _EXPLAINS * (worst - squares.min())
    return [row for row, square in zip(rows, squares, strict=True) if square <= limit]


def _energy_ratios(rival: RankedModel, model: RankedModel) -> tuple[float, float]:
    """Energy that a rival leaves over that which a model leaves, of left-out parts and of held-out tests."""
    return (rival.left_out / model.left_out) ** 2, (rival.held_out / model.held_out) ** 2


def explains_more_than_left(error_without: float, error_with: float) -> bool:
    """Whether an effect takes off more energy than is left with it, by errors on held-out tests."""
    return error_without**2 >= _MORE_THAN_LEFT * error_with**2


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


def choose(ranking: Ranking) -> Choice:
    """Name effects of the most probable model that the held-out tests sustain, and believe what refines it.

    Where no model is exact, effects have their names without terms outside the library, whose shapes they
    would make up for. What refines that model has no name, unless it explains more than is left: terms are an
    unknown effect then.
    """
    rows = ranking.rows
    plain_rows = [row for row in rows if not (ranking.by_parts and any(map(is_general, row.effects)))]
    plain = find_sustained(plain_rows)
    plain, unchanging = ranking.simplify(ranking.place_effects(plain) if ranking.by_parts else plain)
    plain, sure, doubtful = ranking.split_by_certainty(plain)
    nameless, weak = ranking.weigh(plain)
    named = (sure | doubtful) - nameless
    best, _ = ranking.simplify(ranking.find_refinement(plain, named))
    known_effects: set[type[Effect]] = {ClockOffset, StatedDamping}
    if best is not plain and min(_energy_ratios(plain, best)) >= _MORE_THAN_LEFT:
        nameless, weak = ranking.weigh(best)
        named = sure | doubtful
        known_effects |= {kind for kind in best.effects if is_general(kind)}
    sure_forms, doubtful_forms = (
        frozenset(form for kind in kinds & named for form in forms_of(kind, best.effects)) - nameless
        for kinds in (sure, doubtful)
    )
    known_effects |= sure_forms | doubtful_forms
    return Choice(
        best=best,
        plain=plain,
        sure=sure_forms - weak,
        doubtful=doubtful_forms | weak.intersection(best.effects),
        refining={
            kind: ranking.remove_effect(best, kind).held_out
            for kind in best.effects
            if kind not in known_effects - nameless
        },
        contradicted=rows[0] if rows[0].held_out > (1.0 + NO_CHANGE) * best.held_out else None,
        unchanging=tuple(row for row in unchanging if row[0] not in best.effects),
    )


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
