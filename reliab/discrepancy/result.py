"""What a diagnosis says, as objects and as the JSON that `reliab diagnose` writes."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reliab.discrepancy.blocks.observed import ObservedBlock
from reliab.discrepancy.campaign.campaign import Campaign
from reliab.discrepancy.degeneracy import remark
from reliab.discrepancy.fitting.fit import Fit
from reliab.discrepancy.fitting.problem import Problem
from reliab.discrepancy.locating.finding import Finding
from reliab.loop.effects import Effect

Array = NDArray[np.float64]


SHORT_RECORD = 256
"""Samples of a test below which a remark says that it is short."""


class Verdict(StrEnum):
    """What a campaign says as a whole."""

    NAMED = "named"
    NO_MISSING_EFFECT = "no_missing_effect"
    UNKNOWN_EFFECT = "unknown_effect"
    NOT_IDENTIFIABLE = "not_identifiable"


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A parameter: name, most probable value, standard deviation, units, central 90 % interval if sampled."""

    name: str
    value: float
    sd: float
    units: str
    interval: tuple[float, float] | None = None

    def as_dict(self) -> dict[str, Any]:
        """Return the entry of `parameters`."""
        sampled = {} if self.interval is None else {"interval_90": list(self.interval)}
        return {"value": self.value, "sd": self.sd, "units": self.units, **sampled}


@dataclass(frozen=True, kw_only=True)
class Rival:
    """Another effect in the place of a named one, with its probability and its error on held-out tests."""

    name: str
    probability: float
    held_out_nrmse: float

    def as_dict(self) -> dict[str, Any]:
        """Return the entry of `rivals`."""
        return {
            "name": self.name,
            "held_out_nrmse": self.held_out_nrmse,
            "probability": self.probability,
        }


@dataclass(frozen=True, kw_only=True)
class MissingEffect:
    """An effect that the nominal model lacks.

    Attributes
    ----------
    effect : type of Effect
        Which.
    probability : float
        Sum of the probabilities of all fitted models that contain it.
    estimates : tuple of Estimate
        Its parameters.
    rivals : tuple of Rival
        What else was tried in its place, the most probable first.
    error_with, error_without : float
        Error on held-out tests of the model with it, and of the same model refitted without it: RMS over
        that of the signal.
    on_bounds : tuple of str
        Parameters that lie on a bound of their range, so that their values and deviations mean little.
    """

    effect: type[Effect]
    probability: float
    estimates: tuple[Estimate, ...]
    rivals: tuple[Rival, ...]
    error_with: float
    error_without: float
    on_bounds: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the effect."""
        return self.effect.label()

    @property
    def remark(self) -> str:
        """What it cannot be told from, in a sentence, and the test that would tell."""
        rival = self.rivals[0] if self.rivals else None
        return remark(self.name, self.probability, None if rival is None else (rival.name, rival.probability))

    def as_dict(self) -> dict[str, Any]:
        """Return the entry of `effects`."""
        return {
            "name": self.name,
            "block": str(self.effect.block),
            "probability": self.probability,
            "parameters": {estimate.name: estimate.as_dict() for estimate in self.estimates},
            "rivals": [rival.as_dict() for rival in self.rivals],
            "held_out_nrmse_with": self.error_with,
            "held_out_nrmse_without": self.error_without,
            "parameters_on_bounds": list(self.on_bounds),
            **({"position": self.effect.position} if self.effect.position else {}),
        }


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """What is missing and is none of the known effects.

    Attributes
    ----------
    block : str
        Where it acts.
    expression : str
        Terms with their coefficients in SI units; empty where no term that was tried explains it.
    description : str
        The same in words.
    held_out_nrmse : float
        What the model with the expression leaves on held-out tests.
    """

    block: str
    expression: str
    description: str
    held_out_nrmse: float

    def as_dict(self) -> dict[str, Any]:
        """Return the entry `unknown`."""
        return {
            "block": self.block,
            "expression": self.expression,
            "description": self.description,
            "held_out_nrmse": self.held_out_nrmse,
        }


@dataclass(frozen=True, kw_only=True)
class Gap:
    """Difference between model and measurement on held-out tests, before and after the effects are added.

    Attributes
    ----------
    held_out : tuple of str
        Files.
    channel : str
        Column.
    before, after : float
        RMS of the difference over RMS of the signal, calibrated model and model with the effects.
    floors : mapping of str to float
        The same of what the recordings do not repeat, by where it was taken from, the most telling first;
        empty where the recordings do not tell.
    tests_before, tests_after : mapping of str to float
        `before` and `after` of each held-out test, by file.
    """

    held_out: tuple[str, ...]
    channel: str
    before: float
    after: float
    floors: Mapping[str, float]
    tests_before: Mapping[str, float]
    tests_after: Mapping[str, float]

    @property
    def source(self) -> str | None:
        """What the floor was taken from, None where it is not known."""
        return next(iter(self.floors), None)

    @property
    def floor(self) -> float | None:
        """RMS of what no model could explain over that of the signal, None where it is not known."""
        return next(iter(self.floors.values()), None)

    @property
    def model_error(self) -> float:
        """What remains above the floor, RMS over that of the signal; all of it where no floor is known."""
        return float(np.sqrt(max(self.after**2 - (self.floor or 0.0) ** 2, 0.0)))

    @property
    def closed_fraction(self) -> float | None:
        """(before² − after²)/(before² − floor²) in [0, 1], None without a floor or a gap above it."""
        if self.floor is None or not self.before**2 > self.floor**2:
            return None
        share = (self.before**2 - self.after**2) / (self.before**2 - self.floor**2)
        return min(max(share, 0.0), 1.0)

    @property
    def unexplained_share(self) -> float:
        """Energy that remains above the floor over the energy that the effects took away."""
        closed = max(self.before**2 - self.after**2, 0.0)
        return self.model_error**2 / max(closed, 1e-12 * self.before**2, 1e-300)

    def as_dict(self) -> dict[str, Any]:
        """Return the entry `gap`."""
        return {
            "held_out": list(self.held_out),
            "channel": self.channel,
            "nrmse_before": self.before,
            "nrmse_after": self.after,
            "noise_floor": self.floor,
            "noise_floor_source": self.source,
            "noise_floors": dict(self.floors),
            "model_error": self.model_error,
            "closed_fraction": self.closed_fraction,
            "tests": {
                file: {"nrmse_before": self.tests_before[file], "nrmse_after": self.tests_after[file]}
                for file in self.tests_after
            },
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Ranked:
    """A fitted model with its probability among all that were fitted."""

    fit: Fit
    probability: float


@dataclass(frozen=True, kw_only=True)
class FurtherError:
    """Error to expect on a further test: RMS over that of the signal at the judged frequencies.

    Attributes
    ----------
    value, low, high : float
        Median and ends of the 90 % prediction interval.
    tests : int
        Number of left-out tests that it rests on.
    """

    value: float
    low: float
    high: float
    tests: int

    def as_dict(self) -> dict[str, Any]:
        """Return the entry `further_test`."""
        return {"value": self.value, "low": self.low, "high": self.high, "tests": self.tests}


@dataclass(frozen=True, kw_only=True, eq=False)
class BlockDiagnosis:
    """All that was found in one observed block.

    Attributes
    ----------
    block : ObservedBlock
        The block.
    problem, proof : Problem
        It on the tests that are not held out, and on those that are.
    calibrated : Fit
        Calibration and offsets alone.
    best : Fit
        The model with the effects that are believed.
    ranked : tuple of Ranked
        All fitted models, the most probable first.
    effects : tuple of MissingEffect
        Effects of the library that are named, offsets among them.
    doubtful : tuple of MissingEffect
        Effects one of which acts, though the data do not tell which.
    unknown : Unknown or None
        What is none of the library.
    findings : tuple of Finding
        Where the calibrated model fails.
    residuals_before, residuals_after : dict of str to numpy.ndarray
        Measured minus predicted channel of the held-out tests by file, shape (n,) each.
    gap : Gap
        The same in numbers.
    structured_share : float
        Share of what the best model leaves of the tests it was fitted to that is concentrated as no noise is.
    leaves_noise : bool
        Whether that passes for noise, or for the error of a converter.
    calibration : tuple of Estimate
        Gain, delay, stiffness or scale as calibrated in the best model.
    further : FurtherError or None
        Error to expect on a further test, None from too few tests.
    converged : bool, optional
        Whether the posterior of the parameters has converged, where it was sampled. Where it has not,
        standard deviations are those of a normal approximation.
    """

    block: ObservedBlock
    problem: Problem
    proof: Problem
    calibrated: Fit
    best: Fit
    ranked: tuple[Ranked, ...]
    effects: tuple[MissingEffect, ...]
    doubtful: tuple[MissingEffect, ...]
    unknown: Unknown | None
    findings: tuple[Finding, ...]
    residuals_before: dict[str, Array]
    residuals_after: dict[str, Array]
    gap: Gap
    structured_share: float
    leaves_noise: bool
    calibration: tuple[Estimate, ...]
    further: FurtherError | None
    converged: bool | None = None

    @property
    def verdict(self) -> Verdict:
        """The answer for this block in one word."""
        if self.unknown is not None:
            return Verdict.UNKNOWN_EFFECT
        if self.doubtful:
            return Verdict.NOT_IDENTIFIABLE
        return Verdict.NAMED if self.effects else Verdict.NO_MISSING_EFFECT

    def as_dict(self) -> dict[str, Any]:
        """Return the entry of `blocks`."""
        return {
            "block": str(self.block.block),
            "verdict": str(self.verdict),
            "effects": [effect.name for effect in (*self.effects, *self.doubtful)],
            "unknown": None if self.unknown is None else self.unknown.as_dict(),
            "gap": self.gap.as_dict(),
            "unexplained_share": self.gap.unexplained_share,
            "residual_is_noise": self.leaves_noise,
            "structured_share": self.structured_share,
            "calibration": {estimate.name: estimate.as_dict() for estimate in self.calibration},
            "further_test": None if self.further is None else self.further.as_dict(),
            "posterior_converged": self.converged,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosis:
    """What a campaign says.

    Attributes
    ----------
    campaign : Campaign
        The campaign.
    blocks : tuple of BlockDiagnosis
        Every observed block.
    criterion_shift : dict, optional
        Ratios of the criterion's parameters with and without the effects, where they were computed.
    """

    campaign: Campaign
    blocks: tuple[BlockDiagnosis, ...]
    criterion_shift: dict[str, float] | None = None

    @property
    def effects(self) -> tuple[MissingEffect, ...]:
        """Effects that are named in any block."""
        return tuple(effect for diagnosed in self.blocks for effect in diagnosed.effects)

    @property
    def doubtful(self) -> tuple[MissingEffect, ...]:
        """Effects that the data cannot tell from others."""
        return tuple(effect for diagnosed in self.blocks for effect in diagnosed.doubtful)

    @property
    def unknown(self) -> Unknown | None:
        """What is none of the library, in the first block that has it."""
        return next((diagnosed.unknown for diagnosed in self.blocks if diagnosed.unknown is not None), None)

    @property
    def verdict(self) -> Verdict:
        """The answer in one word."""
        if self.unknown is not None:
            return Verdict.UNKNOWN_EFFECT
        if self.doubtful:
            return Verdict.NOT_IDENTIFIABLE
        return Verdict.NAMED if self.effects else Verdict.NO_MISSING_EFFECT

    @property
    def gap(self) -> Gap:
        """The gap in the block where it was widest over what is left of it."""
        return max(
            (diagnosed.gap for diagnosed in self.blocks), key=lambda gap: gap.before / max(gap.after, 1e-300)
        )

    @property
    def where(self) -> tuple[Finding, ...]:
        """All findings, the least probable under noise first."""
        findings = [finding for diagnosed in self.blocks for finding in diagnosed.findings]
        return tuple(sorted(findings, key=lambda finding: (finding.p_value, -finding.share_of_residual)))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on what limits the answer: doubts, bounds, convergence, model error, short records."""
        remarks = [effect.remark for effect in self.doubtful]
        for block in self.blocks:
            remarks += _limits_of(block)
        remarks += [
            f"{test.file} has {test.size} samples only: what it says of an effect is little."
            for test in self.campaign.tests
            if test.size < SHORT_RECORD
        ]
        return tuple(dict.fromkeys(remarks))

    def as_dict(self) -> dict[str, Any]:
        """Return what `reliab diagnose --json` writes."""
        unknown = self.unknown
        return {
            "campaign": self.campaign.name,
            "verdict": str(self.verdict),
            "where": [finding.as_dict() for finding in self.where],
            "effects": [effect.as_dict() for effect in (*self.effects, *self.doubtful)],
            "unknown": None if unknown is None else unknown.as_dict(),
            "gap": self.gap.as_dict(),
            "blocks": [diagnosed.as_dict() for diagnosed in self.blocks],
            "criterion_shift": self.criterion_shift,
            "remarks": list(self.remarks),
        }


def _limits_of(block: BlockDiagnosis) -> list[str]:
    """Sentences on what limits the answer for a block."""
    name, gap = str(block.block.block), block.gap
    remarks = [
        f"{parameter} of {effect.name} lies on a bound of its range: its value and deviation mean little."
        for effect in (*block.effects, *block.doubtful)
        for parameter in effect.on_bounds
    ]
    if block.converged is False:
        remarks.append(
            f"The posterior of the {name} has not converged: its deviations are a normal approximation."
        )
    if not block.leaves_noise:
        floor = "unknown" if gap.floor is None else f"{gap.floor:.3g} by the {gap.source}"
        remarks.append(
            f"What the model of the {name} leaves is no noise but an error of the model:"
            f" {gap.model_error:.3g} of the signal's RMS on held-out tests; its noise floor is {floor}."
            " No probability is stated above 0.99."
        )
    return remarks
