"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from reliab.app.cli.completion import campaigns
from reliab.app.cli.demand import argument, option, takes
from reliab.app.cli.options import JSON_TARGET, OF_REPORT, Reported
from reliab.app.cli.output import console, progress_bar, table, write_json
from reliab.core.significant_digits import percent

if TYPE_CHECKING:
    from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
    from reliab.discrepancy.result.diagnosis import Diagnosis

_WHERE = {
    "block": "left",
    "channel": "left",
    "kind": "left",
    "share": "right",
    "p-value": "right",
    "test": "left",
}
_EFFECTS = {"effect": "left", "probability": "right", "parameter": "left", "value": "right", "± sd": "right"}


@dataclass(frozen=True, kw_only=True)
class DiagnoseDemand(Reported):
    """Options of `reliab diagnose`, arguments of `reliab.diagnose_campaign`."""

    campaign: Path = argument(
        "CAMPAIGN_DIR",
        "Folder with campaign.toml and the tests; or rig_a, rig_b, rig_c, which come with reliab.",
        autocompletion=campaigns,
    )
    out: Path | None = option("DIR", "Folder for diagnosis, report and model.")
    json_target: str | None = JSON_TARGET

    belongs_to: ClassVar[Mapping[str, str]] = dict.fromkeys(OF_REPORT, "out")


@takes(DiagnoseDemand)
def diagnose(demand: DiagnoseDemand) -> None:
    """Find where simulation and measurement disagree, name what is missing, verify it on held-out tests."""
    from reliab.app.api.diagnosis import diagnose_campaign, report_diagnosis

    setting = demand.setting  # refused before the long search, not after it

    def tell(diagnosis: "Diagnosis") -> None:
        if demand.json_target != "-":
            console().print(f"{diagnosis.campaign.name}: {diagnosis.verdict}. {diagnosis.statement}")

    addition = demand.ask(
        diagnose_campaign,
        *("json_target", *(OF_REPORT if demand.out is not None else ())),
        show=progress_bar,
        tell=tell,
    )
    if not write_json(addition.to_dict(), demand.json_target):
        _show(addition.diagnosis)
    if demand.out is not None:
        report_diagnosis(addition, demand.campaign, demand.out, setting=setting)


def _show(diagnosis: "Diagnosis") -> None:
    """Print places, effects and proof."""
    screen = console()
    if diagnosis.where:
        places = table("Where the calibrated model fails", _WHERE)
        for finding in diagnosis.where:
            share, p_value = percent(finding.share_of_residual, decimals=0), f"{finding.p_value:.0e}"
            places.add_row(finding.block, finding.channel, finding.kind, share, p_value, finding.test)
        screen.print(places)
    _show_effects(diagnosis)
    for block in diagnosis.blocks:
        if block.unknown is not None:
            what = block.unknown.expression or block.unknown.description
            screen.print(f"Unknown effect in the {block.unknown.block}: {what}")
    for remark in diagnosis.remarks:
        screen.print(remark)
    for block in diagnosis.blocks:
        screen.print(_proved(block))


def _show_effects(diagnosis: "Diagnosis") -> None:
    """Print the effects with their parameters, and the error with and without each."""
    screen = console()
    effects = (*diagnosis.effects, *diagnosis.doubtful)
    if effects:
        names = table("What is missing", _EFFECTS)
        for effect in effects:
            for estimate in effect.estimates:
                value, spread = estimate.words
                mark = " (on a bound)" if estimate.name in effect.on_bounds else ""
                name = f"{estimate.name}{mark}"
                names.add_row(effect.name, f"{effect.probability:.3f}", name, value, spread)
        screen.print(names)
        for effect in effects:
            screen.print(
                f"{effect.name}: error on held-out tests {effect.error_with:.4f} with it,"
                f" {effect.error_without:.4f} without it."
            )


def _proved(block: "BlockDiagnosis") -> str:
    """Sentence on the gap of a block."""
    gap = block.gap
    floor = "not known" if gap.floor is None else f"{gap.floor:.4f} ({gap.source})"
    worst = next(iter(gap.by_test), None)
    least = (
        f" The least explained test is {worst.files[0]} ({worst.kind}): {worst.before:.4f} before,"
        f" {worst.after:.4f} after."
        if worst is not None and len(gap.tests_after) > 1
        else ""
    )
    return (
        f"{block.block.block}, held-out {block.held_out}, {gap.channel}: error over the signal's "
        f"RMS {gap.before:.4f} before, {gap.after:.4f} after, noise {floor}; {gap.conclusion}.{least}"
    )
