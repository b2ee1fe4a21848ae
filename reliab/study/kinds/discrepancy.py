"""Studies of a measured campaign: where it disagrees with its model, what is missing, the proof."""

import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from reliab.report import Document
from reliab.shipped import shipped
from reliab.study.description import Study, Table
from reliab.study.kinds.kind import Kind
from reliab.study.material import Show
from reliab.study.stages import Stage, digest, made_with

if TYPE_CHECKING:
    from reliab.discrepancy import Addition

DIAGNOSIS: Final = "diagnosis.json"


class CampaignTable(Table):
    """`[campaign]`: a measured campaign, its folder or the name of one that ships."""

    folder: str


class DiscrepancyStudy(Study):
    """A campaign diagnosed."""

    campaign: CampaignTable


def stages(study: DiscrepancyStudy, show: Show) -> Sequence[Stage]:
    """Diagnose the campaign."""
    campaign = _folder(study)

    def work(folder: Path) -> None:
        with show("Diagnosing"):
            content = _diagnosed(campaign, digest(campaign)).as_dict()
        (folder / DIAGNOSIS).write_text(json.dumps(content, indent=2, ensure_ascii=False), encoding="utf-8")

    inputs = {"campaign": digest(campaign)}
    return (Stage(name="diagnose", inputs=inputs, writes=(DIAGNOSIS,), work=work),)


def report(study: DiscrepancyStudy, folder: Path) -> Document:
    """Report the diagnosis; it is made again where it was made in another process."""
    from reliab.report.kinds.discrepancy import discrepancy_report

    campaign = _folder(study)
    addition = _diagnosed(campaign, digest(campaign))
    return discrepancy_report(
        addition.diagnosis,
        posteriors=addition.posteriors,
        provenance={**study.provenance, "campaign, SHA-256": digest(campaign), **made_with(folder)},
        notes=(study.purpose,) if study.purpose else (),
    )


def _folder(study: DiscrepancyStudy) -> Path:
    """Find the campaign: a folder, or the name of one that ships."""
    folder = Path(study.campaign.folder)
    return folder if folder.exists() else shipped("datasets", f"campaigns/{study.campaign.folder}")


@lru_cache(maxsize=1)
def _diagnosed(campaign: Path, checksum: str) -> "Addition":
    """Diagnose a campaign of a checksum, once in a process."""
    del checksum
    from reliab.discrepancy import add, diagnose, read_campaign

    return add(diagnose(read_campaign(campaign)))


KIND: Final = Kind(name="discrepancy", tables=DiscrepancyStudy, stages=stages, report=report)
"""A measured campaign: where it disagrees with its model, what is missing, the proof."""
