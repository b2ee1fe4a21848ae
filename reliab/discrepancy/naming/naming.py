"""From all fitted models of a block to the names that the data support, by how probable each is."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from reliab.core.significant_digits import counted, percent
from reliab.discrepancy.fitting.fit import Fit, as_judged_by_noise, fit
from reliab.discrepancy.fitting.left_out import LeftOut, leave_out, refit
from reliab.discrepancy.fitting.noise_test import (
    LARGEST_STRUCTURED_SHARE,
    is_noise,
    noise_like_tests,
    share_structured,
)
from reliab.discrepancy.fitting.prior import COST, MATERIAL
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.search import Search
from reliab.discrepancy.locate import Finding, locate
from reliab.discrepancy.naming.choice import (
    SURE,
    Choice,
    Ranking,
    choose,
    explains_more_than_left,
    names_of,
    remarks_on,
)
from reliab.discrepancy.naming.unexplained import find_unexplained
from reliab.discrepancy.proof import gap
from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis, RankedModel
from reliab.discrepancy.result.gap import FurtherError, Gap
from reliab.discrepancy.result.missing_effect import (
    MissingEffect,
    Rival,
    Unknown,
    calibration,
    estimates,
    widen_estimates,
)
from reliab.effects.effect import Effect
from reliab.effects.general.general_term import GeneralTerm, is_general
from reliab.effects.stated_damping import StatedDamping
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
    ranking, problem = Ranking.from_search(search, proof), search.problem
    choice = choose(ranking)
    best = choice.best.fit
    # Another damping than the stated one is a contradiction of what is stated, and no effect.
    restatements = frozenset({StatedDamping}) & choice.sure
    calibrated_model = search.fitted.get(frozenset(str(kind.name) for kind in restatements), search.null)
    judgement = as_judged_by_noise(problem, best)
    noise, structure = is_noise(*judgement), share_structured(*judgement)
    naming = _Naming(ranking=ranking, choice=choice, structured=structure)
    effects, doubtful, uncertain = naming.state_effects()
    offsets = [effect.effect for effect in effects if effect.effect in best.space.block.offsets]
    residuals_before = proof.residuals(calibrate_plainly(search, calibrated_model).neutralise(offsets))
    residuals_after = proof.residuals(best)
    measured_gap = gap(proof, residuals_before, residuals_after, noise_like_tests(proof, judgement[1]))
    missing = bool(set(best.space.effects) - restatements or offsets)
    proof_gap = naming.compare_with_others(replace(measured_gap, missing=missing))
    unknown = naming.state_unknown(judgement, proof_gap, is_named=bool(effects), is_doubted=bool(doubtful))
    return BlockDiagnosis(
        problem=problem,
        proof=proof,
        calibrated=calibrated_model,
        ranked=ranking.rows,
        effects=effects,
        doubtful=doubtful,
        uncertain_offsets=uncertain,
        unknown=unknown,
        findings=_locate_residual(problem, calibrated_model, judgement),
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
        linear=calibration(search.linear, with_effects=True) if search.linear.space.effects else (),
        refining=tuple(choice.refining),
    )


def calibrate_plainly(search: Search, calibrated_model: Fit) -> Fit:
    """Calibrate by ordinary least squares, without a noise model, as a laboratory would."""
    grid = np.linspace(0.0, 0.5 * search.problem.block.rate, 99)
    white = NoiseModel.white(search.null.noise.rate, float(np.mean(search.null.noise.density(grid))))
    return fit(search.problem, calibrated_model.space, [calibrated_model.coordinates], white)


def _locate_residual(
    problem: Problem, fitted_model: Fit, judgement: tuple[Problem, Fit]
) -> tuple[Finding, ...]:
    """Find what the residual of a model varies with, as noise judges it."""
    plain, best = judgement
    factors = np.sqrt(problem.densities(fitted_model.noise) / plain.densities(best.noise))
    whitened_fit = replace(fitted_model, jacobian=factors[:, np.newaxis] * fitted_model.jacobian)
    return locate(plain, whitened_fit, best.noise)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Naming:
    """What is needed to state effects: all models, and the believed one."""

    ranking: Ranking
    choice: Choice
    structured: float  # Share of what is left that is no noise

    @property
    def search(self) -> Search:
        """The search."""
        return self.ranking.search

    @property
    def best(self) -> Fit:
        """The believed model."""
        return self.choice.best.fit

    @property
    def kinds(self) -> list[type[Effect]]:
        """Effects of the believed model that may have a name."""
        return [kind for kind in self.best.space.effects if kind not in self.choice.refining]

    @property
    def rejected(self) -> tuple[RankedModel, ...]:
        """Models of one effect, which does not matter, unless they leave more than the signal."""
        models = self.search.rejected.values()
        single = (model for model in models if len(set(model.space.effects) - self.ranking.linear) == 1)
        rows = map(self.ranking.row_of, single)
        return tuple(row for row in rows if max(row.left_out, row.held_out) <= 1.0)

    @property
    def errors_as_recorded(self) -> LeftOut:
        """Errors on left-out tests with all that the converter adds, as a further test has it."""
        problem = replace(self.search.problem, conversion={})
        return (
            leave_out(problem, self.best) if self.search.problem.conversion else self.search.error(self.best)
        )

    def compare_with_others(self, measured_gap: Gap) -> Gap:
        """Add to a gap what the best linear model leaves, and the best model that lacks an effect."""
        linear = self.search.linear
        rival = self.ranking.find_rival(self.kinds or self.best.space.effects)
        error = self.ranking.error(linear) if linear.space.effects else measured_gap.before
        if rival is None:
            return replace(measured_gap, linear=error)
        return replace(measured_gap, linear=error, rival=rival.held_out, rival_effects=rival.names)

    def state_unknown(
        self, judgement: tuple[Problem, Fit], proof_gap: Gap, *, is_named: bool, is_doubted: bool
    ) -> Unknown | None:
        """State what no effect of the library explains, beyond terms that only refine a model."""
        rows = self.ranking.rows
        closest = min(rows, key=lambda row: row.held_out)
        return find_unexplained(
            judgement,
            self.best,
            [kind for kind in self.kinds if issubclass(kind, GeneralTerm)],
            proof_gap,
            None if is_noise(*judgement) else _locate_residual(self.search.problem, self.best, judgement),
            is_named=is_named and (self.ranking.by_parts or not is_doubted),
            comparison=f"of {counted(len(rows), 'model')} that were tried the best ({names_of(closest)}) "
            f"leaves {percent(closest.held_out)}",
        )

    def state_effects(self) -> tuple[tuple[MissingEffect, ...], ...]:
        """State effects: those that are named, those of which one acts, and uncertain offsets."""
        known_kinds = [kind for kind in self.kinds if not is_general(kind)]
        sure = (kind for kind in known_kinds if kind in self.choice.sure - {StatedDamping})
        doubtful = (kind for kind in known_kinds if kind in self.choice.doubtful)
        effects = [effect for kind in sure for effect in self._members(kind)]
        shifts = [self._offset(kind) for kind in self.best.space.block.offsets if self._is_offset(kind)]
        return (
            tuple(effect for effect in (*effects, *shifts) if effect.probability >= SURE),
            (
                *(effect for effect in effects if effect.probability < SURE),
                *(effect for kind in doubtful for effect in self._members(kind)),
            ),
            tuple(shift for shift in shifts if shift.probability < SURE),
        )

    def _members(self, effect: type[Effect]) -> tuple[MissingEffect, ...]:
        """State an effect of the library, or the members of a composition.

        Where no model is exact, a special form, or a member beside the first one, has a name only if it
        explains more than the whole leaves.
        """
        first, *other_members = self._missing(effect).split_members
        simple, plain = effect.refines, self.choice.plain
        if simple is None:
            return (first,)
        simple_error = self.ranking.error(self.search.exchange(plain.fit, effect, simple))
        if self.ranking.by_parts and not explains_more_than_left(simple_error, plain.held_out):
            return (first if other_members or simple.label() == effect.label() else first.report_as(simple),)
        return (first, *(replace(member, error_without=simple_error) for member in other_members))

    def _missing(self, effect: type[Effect]) -> MissingEffect:
        """State an effect of the library."""
        smaller = self.ranking.error(self.search.remove_effect(self.best, effect))
        missing = self._describe(effect, self.ranking.probability(effect), smaller, self._rivals(effect))
        variants = [
            (row.probability, estimates(effect, row.fit))
            for row in self.ranking.rows
            if effect in row.effects and row.probability > _LEAST_PROBABLE
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
        linear = self.ranking.linear if self.ranking.by_parts else set()
        other_effects = set(self.choice.plain.effects) - {effect}
        rows_by_name: dict[str, list[RankedModel]] = {}
        for row in self.ranking.rows:
            added_effects = set(row.effects) - other_effects - (linear - {effect})
            names = {rival.label() for rival in added_effects}
            is_complete = other_effects - linear <= set(row.effects)
            if is_complete and len(added_effects) == 1 and names != {effect.label()}:
                rows_by_name.setdefault(names.pop(), []).append(row)
        return tuple(
            Rival(
                name=name,
                probability=sum(row.probability for row in rows),
                held_out_nrmse=rows[0].held_out,
            )
            for name, rows in list(rows_by_name.items())[:_RIVALS]
        )

    def _offset(self, effect: type[Effect]) -> MissingEffect:
        """State an offset against models in which it is zero."""
        best, place = self.best, self.best.space.places(effect).start
        refitted_coordinates = refit(best, np.zeros(self.search.problem.rows, dtype=bool), (place,))
        smaller = (best.neutralise([effect]), replace(best, coordinates=refitted_coordinates))
        probability = 1.0 / (1.0 + np.exp(-min(offset_odds(best, effect), 700.0)))
        return self._describe(effect, probability, min(map(self.ranking.error, smaller)), ())

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

    def _describe(
        self, effect: type[Effect], sure: float, error_without: float, rivals: tuple[Rival, ...]
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
            error_with=self.choice.best.held_out,
            error_without=error_without,
            on_bounds=tuple(name.removeprefix(key) for name in bounds if name.startswith(key)),
        )


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


def offset_odds(fitted_model: Fit, offset: type[Effect]) -> float:
    """Logarithm of the odds that an offset is not zero, by the ratio of Savage and Dickey."""
    place = fitted_model.space.places(offset).start
    variance = float(fitted_model.covariance[place, place])
    log_density_zero = -0.5 * float(fitted_model.coordinates[place]) ** 2 / variance - 0.5 * np.log(variance)
    return float(-log_density_zero - COST)
