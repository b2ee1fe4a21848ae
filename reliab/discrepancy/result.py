"""What a diagnosis says, as objects and as the JSON that `reliab diagnose` writes."""

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


class Verdict(StrEnum):
    """What a campaign says as a whole."""

    NAMED = "named"
    NO_MISSING_EFFECT = "no_missing_effect"
    UNKNOWN_EFFECT = "unknown_effect"
    NOT_IDENTIFIABLE = "not_identifiable"


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A parameter: name, value, standard deviation, units."""

    name: str
    value: float
    sd: float
    units: str

    def as_dict(self) -> dict[str, Any]:
        """Return the entry of `parameters`."""
        return {"value": self.value, "sd": self.sd, "units": self.units}


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
    """

    effect: type[Effect]
    probability: float
    estimates: tuple[Estimate, ...]
    rivals: tuple[Rival, ...]

    @property
    def name(self) -> str:
        """Name of the effect."""
        return str(self.effect.name)

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
            "parameters": {one.name: one.as_dict() for one in self.estimates},
            "rivals": [rival.as_dict() for rival in self.rivals],
        }


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """What is missing and is none of the known effects.

    Attributes
    ----------
    block : str
        Where it acts.
    expression : str
        Terms with their coefficients in SI units.
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
    floor : float
        The same of the noise: its smooth spectrum, fitted to what the final model leaves of the other tests,
        up to the highest frequency of a signal, and the held-out channel's own power above.
    """

    held_out: tuple[str, ...]
    channel: str
    before: float
    after: float
    floor: float

    @property
    def closed_fraction(self) -> float | None:
        """(before² − after²)/(before² − floor²), None where there was no gap."""
        open_gap = self.before**2 - self.floor**2
        return (self.before**2 - self.after**2) / open_gap if open_gap > 0.0 else None

    def as_dict(self) -> dict[str, Any]:
        """Return the entry `gap`."""
        return {
            "held_out": list(self.held_out),
            "channel": self.channel,
            "nrmse_before": self.before,
            "nrmse_after": self.after,
            "noise_floor": self.floor,
            "closed_fraction": self.closed_fraction,
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Ranked:
    """A fitted model with its probability among all that were fitted."""

    fit: Fit
    probability: float


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
        return tuple(effect for one in self.blocks for effect in one.effects)

    @property
    def doubtful(self) -> tuple[MissingEffect, ...]:
        """Effects that the data cannot tell from others."""
        return tuple(effect for one in self.blocks for effect in one.doubtful)

    @property
    def unknown(self) -> Unknown | None:
        """What is none of the library, in the first block that has it."""
        return next((one.unknown for one in self.blocks if one.unknown is not None), None)

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
        """The gap in the block where it was widest over its noise."""
        return max((one.gap for one in self.blocks), key=lambda gap: gap.before / max(gap.floor, 1e-300))

    @property
    def where(self) -> tuple[Finding, ...]:
        """All findings, the least probable under noise first."""
        found = [finding for one in self.blocks for finding in one.findings]
        return tuple(sorted(found, key=lambda finding: (finding.p_value, -finding.share_of_residual)))

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on what cannot be told apart, and the test that would tell."""
        return tuple(dict.fromkeys(effect.remark for effect in self.doubtful))

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
            "criterion_shift": self.criterion_shift,
            "remarks": list(self.remarks),
        }
