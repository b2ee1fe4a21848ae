"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reliab.cli.options import JsonTarget
from reliab.cli.output import console, progress_bar, table, write_json

if TYPE_CHECKING:
    from reliab.discrepancy import Diagnosis

RESULT_FILE = "diagnosis.json"

_SENTENCES = {
    "named": "The model lacks what is listed below.",
    "no_missing_effect": "Calibration alone explains the tests: nothing is missing.",
    "unknown_effect": "Something is missing that is none of the known effects.",
    "not_identifiable": "Something is missing, but these tests cannot tell what.",
}
_WHERE = {
    "block": "left",
    "channel": "left",
    "kind": "left",
    "share": "right",
    "p-value": "right",
    "test": "left",
}
_EFFECTS = {"effect": "left", "probability": "right", "parameter": "left", "value": "right", "± sd": "right"}


def diagnose(
    campaign: Annotated[
        Path, typer.Argument(metavar="CAMPAIGN_DIR", help="Folder with campaign.toml and the tests.")
    ],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for diagnosis.json.")
    ] = None,
    json_target: JsonTarget = None,
) -> None:
    """Find where simulation and measurement disagree, name what is missing, prove it on held-out tests."""
    from reliab.discrepancy import diagnose as diagnose_campaign
    from reliab.discrepancy import read_campaign

    measured = read_campaign(campaign)
    with progress_bar("Searching the blocks") as progress:
        found = diagnose_campaign(measured, progress=progress)
    content = found.as_dict()
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        write_json(content, str(out / RESULT_FILE))
    if not write_json(content, json_target):
        _show(found)


def _show(found: "Diagnosis") -> None:
    """Print verdict, places, effects and proof."""
    screen = console()
    screen.print(f"{found.campaign.name}: {found.verdict}. {_SENTENCES[found.verdict]}")
    if found.where:
        places = table("Where the calibrated model fails", _WHERE)
        for one in found.where:
            share, p_value = f"{one.share_of_residual:.0%}", f"{one.p_value:.0e}"
            places.add_row(one.block, one.channel, one.kind, share, p_value, one.test)
        screen.print(places)
    effects = (*found.effects, *found.doubtful)
    if effects:
        names = table("What is missing", _EFFECTS)
        for effect in effects:
            for estimate in effect.estimates:
                value, spread = f"{estimate.value:.4g} {estimate.units}", f"{estimate.sd:.2g}"
                names.add_row(effect.name, f"{effect.probability:.3f}", estimate.name, value, spread)
        screen.print(names)
    if found.unknown is not None:
        screen.print(f"Unknown effect in the {found.unknown.block}: {found.unknown.expression}")
    for remark in found.remarks:
        screen.print(remark)
    gap = found.gap
    closed = "" if gap.closed_fraction is None else f", {gap.closed_fraction:.1%} of the gap closed"
    screen.print(
        f"Held-out {', '.join(gap.held_out)}, {gap.channel}: error {gap.before:.4f} before,"
        f" {gap.after:.4f} after, noise {gap.floor:.4f} of the signal's RMS{closed}."
    )
