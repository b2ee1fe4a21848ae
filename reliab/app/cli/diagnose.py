"""`reliab diagnose`: where a campaign's model fails, what is missing, and the proof on held-out tests."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from reliab.app import completion, outputs
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import console, progress_bar, write_json
from reliab.app.declaration import argument

if TYPE_CHECKING:
    from reliab.discrepancy.result.diagnosis import Diagnosis


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
def diagnose(request: Request) -> None:
    """Find where model and test disagree, name what is missing, verify it on held-out tests."""
    from reliab.app.api.diagnosis import diagnose_campaign, report_diagnosis
    from reliab.report.kinds.discrepancy_report import findings_in_words
    from reliab.report.terminal import print_blocks

    setting = request.setting()  # refused before the long search, not after it

    def tell(diagnosis: "Diagnosis") -> None:
        if request.json_target != "-":
            console().print(f"{diagnosis.campaign.name}: {diagnosis.verdict}. {diagnosis.statement}")

    addition = request.ask(
        diagnose_campaign,
        *(outputs.Cover.__annotations__ if request.out is not None else ()),
        show=progress_bar,
        tell=tell,
    )
    if not write_json(addition.to_dict(), request.json_target):
        print_blocks(findings_in_words(addition.diagnosis), console())
    if request.out is not None:
        report_diagnosis(addition, request.campaign, request.out, setting=setting)
