"""The results for a whole campaign."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from reliab.discrepancy.campaign.campaign import Campaign, Channel
from reliab.discrepancy.locating.finding import Finding
from reliab.discrepancy.result.block_diagnosis import STRUCTURE, BlockDiagnosis, Verdict
from reliab.discrepancy.result.gap import Gap
from reliab.discrepancy.result.missing_effect import MissingEffect, Unknown
from reliab.discrepancy.result.showing import draw_gap, table_of_diagnosis
from reliab.discrepancy.result.statements import is_explained, remainder_statement, statement
from reliab.renamed import renamed_method
from reliab.significant import significant
from reliab.vocabulary import Block

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {Block.NUMERICAL: "numerical substructure"}

SHORT_RECORD = 256
"""Samples of a test below which a remark says that it is short."""

_LIKE_A_STRUCTURE = {"added_mass", "viscous_damping"}


@renamed_method("0.4", "as_dict", "to_dict")
@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosis:
    """The results for a campaign.

    Attributes
    ----------
    campaign : Campaign
        The campaign.
    blocks : tuple of BlockDiagnosis
        Every observed block.
    faults : tuple of str, optional
        Faults of the recordings, sentences.
    criterion_shift : dict, optional
        Ratios of the criterion's parameters with and without the effects, where they were computed.
    """

    campaign: Campaign
    blocks: tuple[BlockDiagnosis, ...]
    faults: tuple[str, ...] = ()
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
        """The effect outside the library, in the first block that has one."""
        return next((diagnosed.unknown for diagnosed in self.blocks if diagnosed.unknown is not None), None)

    @property
    def verdict(self) -> Verdict:
        """The answer in one word."""
        return Verdict.of(self.effects, self.doubtful, self.unknown)

    @property
    def statement(self) -> str:
        """The verdict in a sentence."""
        return statement(self.verdict, self.blocks)

    @property
    def is_explained(self) -> bool:
        """Whether what the models leave can be taken for noise in every block."""
        return all(is_explained(block) for block in self.blocks)

    @property
    def gap(self) -> Gap:
        """The gap in the block where it shrank by the largest factor."""
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
        """Sentences on what limits the answer: faults, doubts, bounds, convergence, errors of models."""
        remarks = [*self.faults, *(effect.remark for effect in self.doubtful)]
        for block in self.blocks:
            remarks += _limits_of(block)
        remarks += [
            f"{test.file} has only {test.size} samples: it says little about any effect."
            for test in self.campaign.tests
            if test.size < SHORT_RECORD
        ]
        return tuple(dict.fromkeys(remarks))

    def plot(self, axes: "Axes | None" = None) -> "Axes":
        """Draw the error on held-out tests before and after; returns its axes."""
        return draw_gap(self.campaign.name, self.blocks, axes)

    def __repr__(self) -> str:
        named = ", ".join(effect.name for effect in (*self.effects, *self.doubtful))
        return f"<Diagnosis of {self.campaign.name}: {self.verdict}{f' ({named})' if named else ''}>"

    def _repr_html_(self) -> str:
        effects = (*self.effects, *self.doubtful)
        return table_of_diagnosis(self.campaign.name, self.verdict, effects, self.gap, self.remarks)

    def to_dict(self) -> dict[str, Any]:
        """Return what `reliab diagnose --json` writes."""
        unknown = self.unknown
        return {
            "campaign": self.campaign.name,
            "verdict": str(self.verdict),
            "where": [finding.to_dict() for finding in self.where],
            "effects": [effect.to_dict() for effect in (*self.effects, *self.doubtful)],
            "unknown": None if unknown is None else unknown.to_dict(),
            "gap": self.gap.to_dict(),
            "blocks": [diagnosed.to_dict() for diagnosed in self.blocks],
            "criterion_shift": self.criterion_shift,
            "remarks": list(self.remarks),
        }


def _limits_of(block: BlockDiagnosis) -> list[str]:
    """Sentences on what limits the answer for a block."""
    name, gap = _NAMES.get(block.block.block, str(block.block.block)), block.gap
    remarks = [
        f"{parameter} of {effect.name} lies on a bound of its range: its value and its standard deviation"
        " mean little."
        for effect in (*block.effects, *block.doubtful)
        for parameter in effect.on_bounds
    ]
    remarks += [
        f"The tests ran with a {STRUCTURE[item.name].meaning} of {significant(item.value)} ± "
        f"{significant(item.sd, 1)} times the"
        " nominal one: check the table [structure] of the campaign."
        for item in block.misstated
    ]
    remarks += [offset.remark for offset in block.uncertain_offsets]
    named = {effect.name for effect in (*block.effects, *block.doubtful)}
    if block.block.inputs == (Channel.GROUND,) and named & _LIKE_A_STRUCTURE:
        remarks.append(
            "In a single channel an added mass or a damper looks like a natural frequency or a damping ratio"
            " that is stated wrongly: check the table [structure], or record command and force as well."
        )
    if block.block.block is not Block.NUMERICAL and gap.after > 1.0:
        remarks.append(
            f"The model of the {name} misses held-out tests by more than their signal: check the units and"
            " signs of the columns, and the nominal values."
        )
    if block.converged is False:
        remarks.append(
            f"The posterior of the {name} has not converged: standard deviations are those of a normal"
            " approximation."
        )
    if not block.leaves_noise:
        remarks.append(remainder_statement(name, gap, block.structured_share))
    return remarks
