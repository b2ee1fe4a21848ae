"""From all fitted models of a block to the names that the data support, by how probable each is."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy import special

from reliab.core.significant_digits import counted, percent
from reliab.discrepancy.fitting.error_search import ErrorSearch
from reliab.discrepancy.fitting.fit import Fit, as_judged_by_noise, fit, reweight_fit
from reliab.discrepancy.fitting.left_out import LeftOut, leave_out, refit
from reliab.discrepancy.fitting.noise_test import (
    LARGEST_STRUCTURED_SHARE,
    is_noise,
    noise_like_tests,
    share_structured,
)
from reliab.discrepancy.fitting.prior import COST, MATERIAL
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.screening import screen_effects
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.fitting.space import ModelSpace
from reliab.discrepancy.locate import LEAST_PROBABILITY, Finding, locate
from reliab.discrepancy.naming.choice import (
    SURE,
    Choice,
    best_rival,
    choose,
    explains_more_than_left,
    names_of,
    probability,
    ranking,
    remarks_on,
    row_of,
)
from reliab.discrepancy.naming.unexplained import find_unexplained
from reliab.discrepancy.proof import compute_nrmse, gap
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, RankedModel
from reliab.discrepancy.result.gap import FurtherError, Gap
from reliab.discrepancy.result.missing_effect import (
    Estimate,
    MissingEffect,
    Rival,
    Unknown,
    calibration,
    estimates,
    widen_estimates,
)
from reliab.discrepancy.terms import StatedDamping
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import GeneralTerm, is_general
from reliab.effects.stroke_saturation import StrokeSaturation
from reliab.effects.viscous_damping import ViscousDamping
from reliab.signals.noise import NoiseModel

MOST_SURE = 0.99
"""Largest probability that is stated where what the best model leaves fails the noise test."""

_RIVALS = 4
_MOST_MISSTATEMENT = 0.5  # of a stated damping, by which it may be off
_LEAST_PROBABLE = 1e-3  # model that counts where parameters differ between models
_FEWEST = 3  # left-out tests from which the error on a further one is foretold
_TAILS = 0.05
_SMALLEST_OFFSET = 2e-3  # of the channel's RMS


def diagnose_block(search: Search, proof: Problem) -> BlockDiagnosis:
    """Draw the conclusions from the search of a block."""
    ranked = ranking(search, proof)
    choice = choose(search, ranked, proof)
    best = choice.best.fit
    # Another damping than the stated one is a contradiction of what is stated, and no effect.
    restatements = frozenset({StatedDamping}) & choice.sure
    calibrated_model = search.fitted.get(frozenset(str(kind.name) for kind in restatements), search.null)
    noise_judgement = as_judged_by_noise(search.problem, best)
    noise, structure = is_noise(*noise_judgement), share_structured(*noise_judgement)
    naming = _Naming(search=search, ranked=ranked, choice=choice, proof=proof, structured=structure)
    effects, doubtful, uncertain = naming.state_effects()
    offsets = [effect.effect for effect in effects if effect.effect in best.space.block.offsets]
    residuals_before = proof.residuals(calibrate_plainly(search, calibrated_model).neutralise(offsets))
    residuals_after = proof.residuals(best)
    measured_gap = gap(proof, residuals_before, residuals_after, noise_like_tests(proof, noise_judgement[1]))
    missing = bool(set(best.space.effects) - restatements or offsets)
    proof_gap = naming.compare_with_others(replace(measured_gap, missing=missing))
    is_named = bool(effects) and (isinstance(search, ErrorSearch) or not doubtful)
    unknown = naming.unknown(noise_judgement, proof_gap, is_named=is_named, is_noise=noise)
    return BlockDiagnosis(
        problem=search.problem,
        proof=proof,
        calibrated=calibrated_model,
        ranked=ranked,
        effects=effects,
        doubtful=doubtful,
        uncertain_offsets=uncertain,
        unknown=unknown,
        findings=_locate_residual(search.problem, calibrated_model, noise_judgement),
        residuals_before={proof.block.tests[test].file: values for test, values in residuals_before.items()},
        residuals_after={proof.block.tests[test].file: values for test, values in residuals_after.items()},
        gap=replace(proof_gap, missing=bool(proof_gap.missing or unknown)),
        structured_share=structure,
        leaves_noise=noise,
        calibration=calibration(best, is_restated=bool(restatements)),
        further=predict_error(naming.errors_as_recorded),
        believed=choice.best,
        rejected=naming.rejected,
        choice_remarks=tuple(remarks_on(choice)),
        linear=naming.linear,
        refining=tuple(choice.refining),
    )


def calibrate_plainly(search: Search, calibrated_model: Fit) -> Fit:
    """Calibrate by ordinary least squares, without a noise model, as a laboratory would."""
    grid = np.linspace(0.0, 0.5 * search.problem.block.rate, 99)
    white = NoiseModel.white(search.null.noise.rate, float(np.mean(search.null.noise.density(grid))))
    return fit(search.problem, calibrated_model.space, [calibrated_model.coordinates], white)


def _locate_residual(
    problem: Problem, fitted_model: Fit, noise_judgement: tuple[Problem, Fit]
) -> tuple[Finding, ...]:
    """Find what the residual of a model varies with, as noise judges it."""
    plain, best = noise_judgement
    factors = np.sqrt(problem.densities(fitted_model.noise) / plain.densities(best.noise))
    whitened_fit = replace(fitted_model, jacobian=factors[:, np.newaxis] * fitted_model.jacobian)
    return locate(plain, whitened_fit, best.noise)


class OffsetRival(NamedTuple):
    """A model that holds an effect in the place of an offset, which is zero in it."""

    effect: type[Effect]
    fit: Fit
    odds: float  # Logarithm of how much more credible it is than the offset, by the judge of the search


@dataclass(frozen=True, kw_only=True, eq=False)
class _Naming:
    """What is needed to state effects: all models, the believed one, and the held-out tests."""

    search: Search
    ranked: Sequence[RankedModel]
    choice: Choice
    proof: Problem
    structured: float  # Share of what is left that is no noise

    @property
    def best(self) -> Fit:
        """The believed model."""
        return self.choice.best.fit

    @property
    def plain(self) -> Fit:
        """The model from which effects have their names."""
        return self.choice.plain.fit

    @property
    def kinds(self) -> list[type[Effect]]:
        """Effects of the believed model that may have a name."""
        return [kind for kind in self.best.space.effects if kind not in self.choice.refining]

    @property
    def rejected(self) -> tuple[RankedModel, ...]:
        """Models of one effect, which does not matter, unless they leave more than the signal."""
        linear = self.search.problem.block.linear
        models = self.search.rejected.values()
        single = (model for model in models if len(set(model.space.effects).difference(linear)) == 1)
        rows = (row_of(self.search, model, self.proof) for model in single)
        return tuple(row for row in rows if max(row.left_out, row.held_out) <= 1.0)

    def compare_with_others(self, measured_gap: Gap) -> Gap:
        """Add to a gap what the best linear model leaves, and the best model that lacks an effect."""
        linear = self.search.linear
        rival = best_rival(self.ranked, self.kinds or self.best.space.effects)
        error = self._error(linear) if linear.space.effects else measured_gap.before
        if rival is None:
            return replace(measured_gap, linear=error)
        return replace(measured_gap, linear=error, rival=rival.held_out, rival_effects=rival.names)

    def unknown(
        self, noise_judgement: tuple[Problem, Fit], proof_gap: Gap, *, is_named: bool, is_noise: bool
    ) -> Unknown | None:
        """State what no effect of the library explains, beyond terms that only refine a model."""
        row, models = min(self.ranked, key=lambda row: row.held_out), counted(len(self.ranked), "model")
        comparison = f"of {models} that were tried the best ({names_of(row)}) leaves {percent(row.held_out)}"
        return find_unexplained(
            noise_judgement,
            self.best,
            [kind for kind in self.kinds if issubclass(kind, GeneralTerm)],
            proof_gap,
            None if is_noise else _locate_residual(self.search.problem, self.best, noise_judgement),
            is_named=is_named,
            comparison=comparison,
        )

    @property
    def linear(self) -> tuple[Estimate, ...]:
        """Parameters of the best linear model of a block that has one of its own."""
        linear = self.search.linear
        effects = [item for effect in linear.space.effects for item in estimates(effect, linear)]
        return (*calibration(linear), *effects) if effects else ()

    @property
    def errors_as_recorded(self) -> LeftOut:
        """Errors on left-out tests with all that the converter adds, as a further test has it."""
        if not self.search.problem.conversion:
            return self.search.error(self.best)
        return leave_out(replace(self.search.problem, conversion={}), self.best)

    def state_effects(self) -> tuple[tuple[MissingEffect, ...], ...]:
        """State effects: those that are named, those of which one acts, and uncertain offsets.

        An offset is uncertain if another effect may stand in its place.
        """
        named_effects: list[MissingEffect] = []
        doubtful_effects: list[MissingEffect] = []
        for kind in (kind for kind in self.kinds if not is_general(kind)):
            if kind in self.choice.sure - {StatedDamping}:
                for effect in self._members(kind):
                    (named_effects if effect.probability >= SURE else doubtful_effects).append(effect)
        for kind in (kind for kind in self.kinds if not is_general(kind) and kind in self.choice.doubtful):
            doubtful_effects += self._members(kind)
        shifts = [self._offset(kind) for kind in self.best.space.block.offsets if self._is_offset(kind)]
        named_effects += [shift for shift in shifts if shift.probability >= SURE]
        return (
            tuple(named_effects),
            tuple(doubtful_effects),
            tuple(shift for shift in shifts if shift.probability < SURE),
        )

    def _members(self, effect: type[Effect]) -> tuple[MissingEffect, ...]:
        """State an effect of the library, or the members of a composition.

        Where no model is exact, a special form, or a member beside the first one, has a name only if it
        explains more than the whole leaves.
        """
        first, *other_members = self._missing(effect).split_members
        simple = effect.refines
        if simple is None:
            return (first,)
        simple_error = self._error(self.search.exchange(self.plain, effect, simple))
        if isinstance(self.search, ErrorSearch) and not explains_more_than_left(
            simple_error, self._error(self.plain)
        ):
            return (first if other_members or simple.label() == effect.label() else first.report_as(simple),)
        return (first, *(replace(member, error_without=simple_error) for member in other_members))

    def _missing(self, effect: type[Effect]) -> MissingEffect:
        """State an effect of the library."""
        smaller = self.search.remove_effect(self.best, effect)
        missing = self._describe(effect, probability(self.ranked, effect), smaller, self._rivals(effect))
        variants = [
            (row.probability, estimates(effect, row.fit))
            for row in self.ranked
            if effect in row.fit.space.effects and row.probability > _LEAST_PROBABLE
        ]
        if variants:
            missing = replace(missing, estimates=widen_estimates(missing.estimates, variants))
        return or_stated_damping(missing, self.search.problem.block.structure_damping)

    def _rivals(self, effect: type[Effect]) -> tuple[Rival, ...]:
        """Models that hold one other effect in the place of this one.

        The same effect at another place along the block is none of them: left-out tests or the likelihood
        decide where it acts, and no probability is stated of that. Linear effects, which every model of an
        error may hold, make no other model of it.
        """
        linear = set(self.search.problem.block.linear if isinstance(self.search, ErrorSearch) else ())
        other_effects = set(self.plain.space.effects) - {effect}
        rows_by_name: dict[str, list[RankedModel]] = {}
        for row in self.ranked:
            effects = set(row.fit.space.effects)
            added_effects = effects - other_effects - (linear - {effect})
            names = {rival.label() for rival in added_effects}
            if other_effects - linear <= effects and len(added_effects) == 1 and names != {effect.label()}:
                rows_by_name.setdefault(names.pop(), []).append(row)
        rivals = [
            self._rival(name, sum(row.probability for row in rows), rows[0].fit)
            for name, rows in rows_by_name.items()
        ]
        return tuple(rivals[:_RIVALS])

    def _offset(self, effect: type[Effect]) -> MissingEffect:
        """State an offset against models in which it is zero, with the best other effect in its place."""
        rival = offset_rival(self.search, self.best, effect)
        odds = offset_odds(self.best, effect)
        relative = np.exp(np.minimum([0.0, -odds, -np.inf if rival is None else rival.odds], 700.0))
        shares = np.maximum(relative / relative.sum(), LEAST_PROBABILITY).tolist()
        place = self.best.space.places(effect).start
        refitted_coordinates = refit(self.best, np.zeros(self.search.problem.rows, dtype=bool), (place,))
        refitted_model = replace(self.best, coordinates=refitted_coordinates)
        smaller = min((self.best.neutralise([effect]), refitted_model), key=self._error)
        rivals = () if rival is None else (self._rival(rival.effect.label(), shares[2], rival.fit),)
        return self._describe(effect, shares[0], smaller, rivals)

    def _is_offset(self, kind: type[Effect]) -> bool:
        """Whether an offset is significant, large enough to matter, and helps to predict left-out tests."""
        problem, best = self.search.problem, self.best
        if offset_odds(best, kind) <= 0.0:
            return False
        place = best.space.places(kind).start
        values = np.concatenate([problem.block.measured(s.test)[s.begin : s.end] for s in problem.segments])
        if abs(float(best.space.values(best.coordinates)[place])) < _SMALLEST_OFFSET * float(values.std()):
            return False
        share = 1.0 - MATERIAL if problem.flat else 1.0
        return self.search.error(best).energy <= share * leave_out(problem, best, (place,)).energy

    def _rival(self, name: str, sure: float, fitted_model: Fit) -> Rival:
        return Rival(name=name, probability=sure, held_out_nrmse=self._error(fitted_model))

    def _describe(
        self, effect: type[Effect], sure: float, smaller: Fit, rivals: tuple[Rival, ...]
    ) -> MissingEffect:
        key = f"{effect.name}."
        bounds = self.best.space.find_bounds(self.best.coordinates)
        parameters = estimates(effect, self.best)
        if issubclass(effect, StrokeSaturation):  # a converter reads the level of a stop within its step
            rounding = max(self.search.problem.steps.values()) / np.sqrt(12.0)
            parameters = tuple(replace(item, sd=float(np.hypot(item.sd, rounding))) for item in parameters)
        return MissingEffect(
            effect=effect,
            probability=min(sure, 1.0 if self.structured <= LARGEST_STRUCTURED_SHARE else MOST_SURE),
            estimates=parameters,
            rivals=rivals,
            error_with=self._error(self.best),
            error_without=self._error(smaller),
            on_bounds=tuple(name.removeprefix(key) for name in bounds if name.startswith(key)),
        )

    def _error(self, fitted_model: Fit) -> float:
        return compute_nrmse(self.proof, self.proof.residuals(fitted_model))


def or_stated_damping(damper: MissingEffect, damping: float) -> MissingEffect:
    """State a damper with its twin where it would be a misstated damping of the structure, to within half.

    `damping` [N·s/m] is that from which it cannot be told: both predict the same, and no test prefers one.
    """
    if (
        damper.effect is not ViscousDamping
        or not abs(damper.estimates[0].value) < _MOST_MISSTATEMENT * damping
    ):
        return damper
    half = 0.5 * damper.probability
    twin = Rival(name=StatedDamping.label(), probability=half, held_out_nrmse=damper.error_with)
    return replace(damper, probability=half, rivals=(twin, *damper.rivals)[:_RIVALS])


def predict_error(errors: LeftOut) -> FurtherError | None:
    """Interval of the error on a further test, from those on tests that were left out.

    The logarithms of the errors are taken for draws from one normal distribution, of which the further test
    is another draw; the interval is Student's prediction interval.

    >>> whole, every = np.full(3, 100.0), np.ones(3, dtype=bool)
    >>> errors = LeftOut(energies=np.array([1.0, 4.0, 2.0]), signals=whole, units=np.ones(3), foretold=every)
    >>> further = predict_error(errors)
    >>> round(further.value, 3), round(further.low, 3), round(further.high, 3)
    (0.141, 0.044, 0.455)
    """
    logarithms = 0.5 * np.log(np.maximum(errors.energies, 1e-300) / np.maximum(errors.signals, 1e-300))
    count = logarithms.size
    if count < _FEWEST:
        return None
    spread = float(logarithms.std(ddof=1)) * np.sqrt(1.0 + 1.0 / count)
    reach = float(-special.stdtrit(count - 1, _TAILS)) * spread
    middle = float(logarithms.mean())
    low, high = np.exp(middle - reach), np.exp(middle + reach)
    return FurtherError(value=float(np.exp(middle)), low=float(low), high=float(high), tests=count)


def offset_rival(search: Search, best: Fit, offset: type[Effect]) -> OffsetRival | None:
    """Find the effect that explains most in the place of an offset.

    Returns none where no effect promises to explain anything, or where the best of them predicts tests that
    are left out clearly worse than the offset does, whatever its evidence: a noise model fitted to the
    rival's own residual may take a constant for slow noise.
    """
    block = copy(search.problem.block)
    block.offsets = tuple(kind for kind in block.offsets if kind is not offset)
    problem = replace(search.problem, block=block)
    space = ModelSpace(block, best.space.effects)
    start = space.inherit(best.space, best.coordinates)
    null_fit = reweight_fit(problem, fit(problem, space, [start], best.noise))
    promising = screen_effects(problem, null_fit, search.candidates, null_fit)
    if not promising or not promising[0].gain > 0.0:
        return None
    first = promising[0]
    larger = ModelSpace(block, (*best.space.effects, first.kind))
    rival = reweight_fit(problem, fit(problem, larger, [first.start], null_fit.noise))
    error = leave_out(problem, rival)
    if (1.0 - MATERIAL) * error.energy > search.error(best).energy:
        return None
    odds = rival.log_evidence - best.log_evidence
    if isinstance(search, ErrorSearch):
        odds = search.likelihood(error) - search.likelihood(search.error(best))
    return OffsetRival(effect=first.kind, fit=rival, odds=odds)


def offset_odds(fitted_model: Fit, offset: type[Effect]) -> float:
    """Logarithm of the odds that an offset is not zero, by the ratio of Savage and Dickey."""
    place = fitted_model.space.places(offset).start
    variance = float(fitted_model.covariance[place, place])
    log_density_zero = -0.5 * float(fitted_model.coordinates[place]) ** 2 / variance - 0.5 * np.log(variance)
    return float(-log_density_zero - COST)
