"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from reliab.cli.completion import campaigns
from reliab.cli.options import (
    OF_REPORT,
    JsonTarget,
    Laboratory,
    Logo,
    Paper,
    ReportDate,
    ReportTitle,
    given_options,
    setting_of,
)
from reliab.cli.output import console, progress_bar, table, write_json
from reliab.errors import InputError
from reliab.significant import significant

if TYPE_CHECKING:
    from reliab.discrepancy.adding import Addition
    from reliab.discrepancy.result import BlockDiagnosis, Diagnosis
    from reliab.report import Setting

RESULT_FILE = "diagnosis.json"
REPORT_FILE = "report.pdf"

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
    context: typer.Context,
    campaign: Annotated[
        Path,
        typer.Argument(
            metavar="CAMPAIGN_DIR",
            autocompletion=campaigns,
            help="Folder with campaign.toml and the tests; or rig_a, rig_b, rig_c, which ship.",
        ),
    ],
    *,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for diagnosis, report and model.")
    ] = None,
    title: ReportTitle = None,
    date: ReportDate = None,
    paper: Paper = "a4",
    laboratory: Laboratory = None,
    logo: Logo = None,
    json_target: JsonTarget = None,
) -> None:
    """Find where simulation and measurement disagree, name what is missing, prove it on held-out tests."""
    from reliab.discrepancy import diagnose as diagnose_campaign
    from reliab.discrepancy.adding import add
    from reliab.discrepancy.campaign import campaign_folder, read_campaign

    setting = setting_of(title, date, paper, laboratory, logo)
    if out is None:
        _refuse_without_report(context)
    folder = campaign_folder(campaign)
    measured = read_campaign(folder)
    if out is not None:
        _make(out)
    with progress_bar("Searching the blocks") as progress:
        diagnosis = diagnose_campaign(measured, progress=progress)
    quiet = json_target == "-"
    if not quiet:
        console().print(f"{diagnosis.campaign.name}: {diagnosis.verdict}. {diagnosis.statement}")
    with progress_bar("Sampling posteriors") as progress:
        addition = add(diagnosis, out=out, progress=progress)
    content = addition.to_dict()
    if out is not None:
        write_json(content, str(out / RESULT_FILE))
    if not write_json(content, json_target):
        _show(addition.diagnosis)
    if out is not None:
        _report(addition, folder, out, setting)


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "The folder for the diagnosis must be writable",
            value=error.strerror,
            remedy="Name another",
            where=str(folder),
        ) from None


def _refuse_without_report(context: typer.Context) -> None:
    """Refuse what a report only uses."""
    for name in given_options(context):
        if name in OF_REPORT:
            raise InputError(
                f"--{name} has no effect without --out, where the report is written", remedy="Give --out"
            )


def _report(addition: "Addition", campaign: Path, out: Path, setting: "Setting") -> None:
    from datetime import UTC, datetime

    from reliab.report import write_pdf
    from reliab.report.kinds.discrepancy import discrepancy_report
    from reliab.study import digest

    newest = max(path.stat().st_mtime for path in campaign.iterdir())
    document = discrepancy_report(
        addition.diagnosis,
        posteriors=addition.posteriors,
        provenance={"campaign": campaign.name, "campaign, SHA-256": digest(campaign)},
    )
    day = datetime.fromtimestamp(newest, tz=UTC).date()
    write_pdf(document, out / REPORT_FILE, date=day, setting=setting)


def _show(diagnosis: "Diagnosis") -> None:
    """Print places, effects and proof."""
    screen = console()
    if diagnosis.where:
        places = table("Where the calibrated model fails", _WHERE)
        for finding in diagnosis.where:
            share, p_value = f"{finding.share_of_residual:.0%}", f"{finding.p_value:.0e}"
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
                value, spread = f"{estimate.value:.4g} {estimate.units}", significant(estimate.sd, 2)
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
    closed = "" if gap.stated_share is None else f", {gap.stated_share:.1%} of the gap closed"
    floor = "not known" if gap.floor is None else f"{gap.floor:.4f} ({gap.source})"
    return (
        f"{block.block.block}, held-out {', '.join(gap.held_out)}, {gap.channel}: error {gap.before:.4f}"
        f" before, {gap.after:.4f} after, noise {floor} of the signal's RMS{closed}."
    )
