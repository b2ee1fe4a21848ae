"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from pathlib import Path
from typing import TYPE_CHECKING

from reliab.app import declaration, options
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import console, say, say_briefly, write_json
from reliab.app.declaration import argument, single

if TYPE_CHECKING:
    from reliab.discrepancy.result.diagnosis import Diagnosis


_CAMPAIGN = single(
    "campaign",
    Path,
    argument("CAMPAIGN_DIR", completion=declaration.campaigns),
    "Folder with campaign.toml and the tests; or rig_a, rig_b, rig_c, which come with reliab.",
)


@takes(
    options.FOLDER,
    options.Cover,
    options.DETAILS,
    _CAMPAIGN,
    needs=dict.fromkeys(options.Cover.__annotations__, "out"),
)
def diagnose(request: Request) -> None:
    """Find where model and test disagree, name what is missing, verify it on held-out tests."""
    from reliab.app.api.diagnosis import diagnose_campaign, report_diagnosis

    setting = request.setting()  # refused before the long search, not after it

    addition = request.ask(
        diagnose_campaign,
        "details",
        *(options.Cover.__annotations__ if request.out is not None else ()),
    )
    if not write_json(addition.to_dict(), request.json_target):
        _show(addition.diagnosis, details=request.details, written=request.out is not None)
    if request.out is not None:
        report_diagnosis(addition, request.campaign, request.out, setting=setting)


def _show(diagnosis: "Diagnosis", *, details: bool, written: bool) -> None:
    from reliab.report.kinds.discrepancy_outcome import outcome_in_words
    from reliab.report.kinds.discrepancy_report import findings_in_words
    from reliab.report.terminal import print_blocks

    outcome = outcome_in_words(diagnosis)
    headline = f"{diagnosis.campaign.name}: {outcome.verdict}"
    action = outcome.action if written else f"{outcome.action} --out FOLDER writes it, with a report."
    if details:
        say(headline, style="bold")
        print_blocks(findings_in_words(diagnosis), console())
        say(action)
        return
    findings = [*outcome.findings, *map("Note: {}".format, diagnosis.remarks)]
    where = "Where and how it was found: run with --details."
    say_briefly(headline, findings, [action], hidden=lambda _shown: where)
