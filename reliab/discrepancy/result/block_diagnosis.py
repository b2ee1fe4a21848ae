"""The results for one observed block."""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import ClassVar

import numpy as np

from reliab.core.arrays import Array
from reliab.core.plain_values import Keys, PlainResult, same_names
from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import describe_held_out
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.fitting.space import MODEL_ERROR
from reliab.discrepancy.locate import Finding
from reliab.discrepancy.result.gap import FurtherError, Gap
from reliab.discrepancy.result.missing_effect import Estimate, MissingEffect, Unknown
from reliab.effects.effect import Effect

_CLEAR = 3.0  # standard deviations between a calibrated value and a nominal one that is wrong
_MOST_LISTED = 5  # models that are shown because they are probable, and because their error is small
_SMALLEST_OFFSET = 0.005  # of the force's RMS in the strongest test


@dataclass(frozen=True)
class NominalValue:
    """A value that a campaign states, how far it may be off without a remark, and what to check if it is."""

    meaning: str
    tolerance: float
    check: str


_TABLE = "check the table [structure] of the campaign"
NOMINAL_VALUES = {
    "structure_mass": NominalValue(
        "mass", 0.01, f"{_TABLE}, and the scale of the load cell, which has the same effect"
    ),
    "structure_frequency": NominalValue("natural frequency", 0.005, _TABLE),
    "structure_damping": NominalValue("damping ratio", 0.05, _TABLE),
    "stiffness": NominalValue(
        "stiffness of the specimen",
        0.01,
        "check what is stated of the specimen or, where it is the structure's own spring, frequency and mass",
    ),
}
"""What is calibrated relative to values that the campaign states."""

_FREQUENCY_AND_MASS = ("structure_frequency", "structure_mass")


class Verdict(StrEnum):
    """The verdict on a campaign, the one that weighs most last."""

    NO_MISSING_EFFECT = "no_missing_effect"
    NAMED = "named"
    NOT_IDENTIFIABLE = "not_identifiable"
    UNKNOWN_EFFECT = "unknown_effect"


@dataclass(frozen=True, kw_only=True, eq=False)
class RankedModel(PlainResult):
    """A fitted model with its probability among all that were fitted, and its errors over the signal."""

    keys: ClassVar[Keys] = {
        "effects": "names",
        "probability": "probability",
        "left_out_nrmse": "left_out",
        "held_out_nrmse": "held_out",
    }

    fit: Fit
    probability: float
    left_out: float  # On parts of the fitted tests that were left out one at a time
    held_out: float  # On held-out tests
    is_believed: bool = False  # Whether its effects are those that the diagnosis states

    @property
    def effects(self) -> tuple[type[Effect], ...]:
        """Effects of the model."""
        return self.fit.space.effects

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects, as a diagnosis reports them."""
        return tuple(sorted(effect.label() for effect in self.effects))


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockDiagnosis(PlainResult):
    """All that was found in one observed block."""

    keys: ClassVar[Keys] = {
        "block": "block.block",
        "verdict": "verdict",
        "effects": "all_effects.[name]",
        **same_names("unknown", "gap"),
        **{name: f"gap.{name}" for name in ("unexplained_share", "worst_unexplained_share")},
        "residual_is_noise": "leaves_noise",
        "structured_share": "structured_share",
        "calibration": "calibration.{name}",
        "further_test": "further",
        "posterior_converged": "converged",
        "refining": "refining.[label]",
        "linear": "linear.{name}",
        "candidates": ("candidates", {**RankedModel.keys, "believed": "is_believed"}),
    }

    # problem, proof: The block's data on the tests that are not held out, and on those that are
    problem: Problem
    proof: Problem
    calibrated: Fit  # Calibration and offsets alone
    ranked: tuple[RankedModel, ...]  # All fitted models, the most probable first
    effects: tuple[MissingEffect, ...]  # Effects of the library that are named, offsets among them
    doubtful: tuple[MissingEffect, ...]  # Effects one of which acts, though the data do not tell which
    # Offsets that are calibrated and not named, because another effect could stand in their place
    uncertain_offsets: tuple[MissingEffect, ...]
    unknown: Unknown | None  # The effect outside the library
    findings: tuple[Finding, ...]  # Where the calibrated model fails
    # residuals_before, residuals_after: Measured minus predicted channel of the held-out tests by file, shape
    # (n,) each
    residuals_before: dict[str, Array]
    residuals_after: dict[str, Array]
    gap: Gap  # The same in numbers
    # Share of the best model's residual, on the tests to which it was fitted, that is more concentrated than
    # noise
    structured_share: float
    leaves_noise: bool  # Whether that passes for noise, or for the error of a converter
    calibration: tuple[Estimate, ...]  # Gain, delay, stiffness or scale as calibrated in the best model
    further: FurtherError | None  # Error to expect on a further test, None from too few tests
    believed: RankedModel  # The best model in the ranking
    rejected: tuple[RankedModel, ...] = ()  # Models of one effect, which does not matter
    # Sentences on models that held-out tests contradict, and on effects that change nothing there
    choice_remarks: tuple[str, ...] = ()
    # Parameters of the best linear model, where the block has one of its own
    linear: tuple[Estimate, ...] = ()
    refining: tuple[type[Effect], ...] = ()  # Effects of the best model that are too little to be named
    # Whether the posterior of the parameters has converged, where it was sampled
    converged: bool | None = None
    # Sentences on parameters that the tests show in combination only, where the posterior was sampled
    inseparable: tuple[str, ...] = ()

    @property
    def all_effects(self) -> tuple[MissingEffect, ...]:
        """Effects that are named, then those of which one acts."""
        return *self.effects, *self.doubtful

    @property
    def block(self) -> ObservedBlock:
        """The block."""
        return self.problem.block

    @property
    def is_judged_by_parts(self) -> bool:
        """Whether models were chosen by their errors on left-out parts: the best one leaves no noise."""
        return self.problem.flat

    @property
    def best(self) -> Fit:
        """The model with the effects that are believed."""
        return self.believed.fit

    @property
    def verdict(self) -> Verdict:
        """The answer for this block in one word: an unknown effect weighs most, then a doubtful one.

        Where parts that are left out judge, a further effect in doubt does not undo the others.
        """
        if self.unknown is not None:
            return Verdict.UNKNOWN_EFFECT
        if self.doubtful and not (self.is_judged_by_parts and self.effects):
            return Verdict.NOT_IDENTIFIABLE
        return Verdict.NAMED if self.effects else Verdict.NO_MISSING_EFFECT

    @property
    def held_out(self) -> str:
        """What is held out, in words."""
        return describe_held_out(self.block.tests, self.gap.held_out)

    @property
    def candidates(self) -> tuple[RankedModel, ...]:
        """All models that were tried, those of the smallest error on held-out tests first.

        Of models that differ in nothing but linear effects there is one.
        """
        linear = {effect.label() for effect in self.block.linear}
        groups: dict[frozenset[str], list[RankedModel]] = {}
        is_ranked = any(row.fit is self.best for row in self.ranked)
        for row in (*(() if is_ranked else (self.believed,)), *self.ranked, *self.rejected):
            groups.setdefault(frozenset(row.names) - linear or frozenset(row.names), []).append(row)
        rows = []
        for group in groups.values():
            chosen = next((row for row in group if row.fit is self.best), group[0])
            share = sum(row.probability for row in group)
            rows.append(replace(chosen, is_believed=chosen.fit is self.best, probability=share))
        return tuple(sorted(rows, key=lambda row: row.held_out))

    @property
    def main_candidates(self) -> tuple[RankedModel, ...]:
        """Models to compare the believed one with: probable, good or linear ones, or of one effect."""
        linear = {effect.label() for effect in self.block.linear}
        rows = self.candidates
        probable = sorted(rows, key=lambda row: -row.probability)[:_MOST_LISTED]
        chosen = {id(row) for row in (*rows[:_MOST_LISTED], *probable)}
        return tuple(
            row for row in rows if id(row) in chosen or row.is_believed or len({*row.names} - linear) <= 1
        )

    @property
    def misstated(self) -> tuple[Estimate, ...]:
        """Values of structure and specimen, over the stated ones, with which the tests did not run."""
        return tuple(
            item
            for item in self.calibration
            if item.name in NOMINAL_VALUES
            and _is_contradiction(item)
            and not (self.is_judged_by_parts and item.name == "stiffness")
        )

    @property
    def either_misstated(self) -> tuple[Estimate, ...]:
        """Frequency and mass of the structure, each as it would be if the other were as stated.

        A linear specimen tells one combination of the two. Where that contradicts what was stated and
        neither does by itself, one of them is wrong, and the tests do not tell which.
        """
        names = [calibration.parameter.name for calibration in self.block.calibrations]
        if not set(_FREQUENCY_AND_MASS) <= set(names) or any(
            item.name in _FREQUENCY_AND_MASS for item in self.misstated
        ):
            return ()
        space, x = self.best.space, self.best.coordinates
        places = [names.index(name) for name in _FREQUENCY_AND_MASS]
        covariance = space.covariance_of_values(x, self.best.covariance)[np.ix_(places, places)]
        precision = np.linalg.inv(covariance + MODEL_ERROR**2 * np.eye(len(places)))
        size = np.diag(precision)
        values = 1.0 + precision @ (space.values(x)[places] - 1.0) / size
        rows = zip(_FREQUENCY_AND_MASS, values.tolist(), (1.0 / np.sqrt(size)).tolist(), strict=True)
        either = tuple(Estimate(name=name, value=v, sd=sd, units="-", signed=True) for name, v, sd in rows)
        return either if all(map(_is_contradiction, either)) else ()

    @property
    def not_fed_back(self) -> Estimate | None:
        """Offset of the recorded force that the controller clearly did not feel, None without one."""
        usual = max(float(self.block.measured(segment.test).std()) for segment in self.problem.segments)
        for item in self.calibration:
            least = max(_CLEAR * item.sd, _SMALLEST_OFFSET * usual)
            if item.name == "force_not_fed_back_n" and abs(item.value) > least:
                return item
        return None


def _is_contradiction(item: Estimate) -> bool:
    """Whether a value over the stated one is clearly another, and by more than goes without a remark."""
    return abs(item.value - 1.0) > max(NOMINAL_VALUES[item.name].tolerance, _CLEAR * item.sd)
