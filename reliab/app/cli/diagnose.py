"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from reliab.app import completion, outputs
from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import console, progress_bar, table, write_json
from reliab.app.declaration import argument
from reliab.core.significant_digits import percent, significant

if TYPE_CHECKING:
    from reliab.discrepancy.result.block_diagnosis import BlockDiagnosis
    from reliab.discrepancy.result.diagnosis import Diagnosis

_WHERE = {
    "block": "left",
    "varies with": "left",
    "share": "right",
    "p": "right",
    "most in": "left",
    "Hz": "right",
    "s": "right",
    "begins at": "right",
}
_EFFECTS = {"effect": "left", "probability": "right", "parameters": "left", "held out": "right"}
_CANDIDATES = {"model": "left", "left-out parts": "right", "held out": "right"}


class _Campaign(outputs.Folder, outputs.Cover, total=False):
    campaign: Annotated[
        Path,
        argument(
            "CAMPAIGN_DIR",
            "Folder with campaign.toml and the tests; or rig_a, rig_b, rig_c, which come with reliab.",
            completion=completion.campaigns,
        ),
    ]


@takes(_Campaign, needs=dict.fromkeys(outputs.Cover.__annotations__, "out"))
def diagnose(asked: Asked) -> None:
    """Find where model and test disagree, name what is missing, verify it on held-out tests."""
    from reliab.app.api.diagnosis import diagnose_campaign, report_diagnosis

    setting = asked.setting()  # refused before the long search, not after it

    def tell(diagnosis: "Diagnosis") -> None:
        if asked.json_target != "-":
            console().print(f"{diagnosis.campaign.name}: {diagnosis.verdict}. {diagnosis.statement}")

    addition = asked.ask(
        diagnose_campaign,
        *("json_target", *(outputs.Cover.__annotations__ if asked.out is not None else ())),
        show=progress_bar,
        tell=tell,
    )
    if not write_json(addition.to_dict(), asked.json_target):
        _show(addition.diagnosis)
    if asked.out is not None:
        report_diagnosis(addition, asked.campaign, asked.out, setting=setting)


def _show(diagnosis: "Diagnosis") -> None:
    """Print places, effects, models that were tried, and proof."""
    screen = console()
    _show_places(diagnosis)
    _show_effects(diagnosis)
    for block in diagnosis.blocks:
        if block.unknown is not None:
            what = block.unknown.expression or block.unknown.description
            screen.print(f"Unknown effect in the {block.unknown.block}: {what}")
        if len(block.candidates) > 1:
            _show_candidates(block)
    for remark in diagnosis.remarks:
        screen.print(remark)
    for block in diagnosis.blocks:
        screen.print(_proved(block))


def _show_places(diagnosis: "Diagnosis") -> None:
    """Print a row for each part of the residuals: what it varies with, where it lies, and where it begins."""
    if not diagnosis.where:
        return
    places = table("Where the calibrated model fails", _WHERE)
    for finding in diagnosis.where:
        low, high = (significant(value, 2) for value in finding.band)
        first, last = (significant(value) for value in finding.time)
        places.add_row(
            finding.block,
            finding.kind.replace("_", " "),
            percent(finding.share_of_residual, decimals=0),
            finding.chance,
            finding.test,
            f"{low} to {high}",
            f"{first} to {last}",
            finding.begin,
        )
    console().print(places)


def _show_effects(diagnosis: "Diagnosis") -> None:
    """Print a row for each effect: its parameters, and the error on held-out tests without and with it."""
    effects = (*diagnosis.effects, *diagnosis.doubtful)
    if not effects:
        return
    names = table("What is missing", _EFFECTS)
    for effect in effects:
        change = f"{effect.error_without:.4f} → {effect.error_with:.4f}"
        names.add_row(effect.name, f"{effect.probability:.3f}", "; ".join(effect.parameter_texts), change)
    console().print(names)


def _show_candidates(block: "BlockDiagnosis") -> None:
    """Print the models that were tried with their errors on left-out parts of fitted tests and on others."""
    shown = table(f"Models of the {block.block.block} block, error over the signal's RMS", _CANDIDATES)
    for row in block.candidates:
        mark = "→ " if row.fit is block.best else ""
        name = mark + (" + ".join(row.names) or "calibration alone")
        shown.add_row(name, f"{row.left_out:.4f}", f"{row.held_out:.4f}")
    console().print(shown)


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
