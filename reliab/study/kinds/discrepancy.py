"""Studies of a measured campaign: where it disagrees with its model, what is missing, the proof."""

import json
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from reliab.core.files import written_whole
from reliab.core.progress import show_task
from reliab.core.shipped import shipped
from reliab.report.content import read_content, save_content
from reliab.report.document import Document
from reliab.study.description import Study, StudyKind, StudyTable
from reliab.study.stages import Stage, digest, software_provenance

if TYPE_CHECKING:
    from reliab.discrepancy.adding import Addition

DIAGNOSIS: Final = "diagnosis.json"
CONTENT: Final = "report"


class CampaignTable(StudyTable):
    """`[campaign]`: a measured campaign, its folder or the name of one that ships."""

    folder: str


class DiscrepancyStudy(Study):
    """A campaign diagnosed."""

    campaign: CampaignTable


def stages(study: DiscrepancyStudy) -> Sequence[Stage]:
    """Diagnose the campaign, write the result, then draw what the report shows of it."""
    campaign = _folder(study)

    def work(folder: Path) -> None:
        with show_task("Diagnosing"):
            content = _diagnose(campaign, digest(campaign)).to_dict()
        with written_whole(folder / DIAGNOSIS) as file:
            file.write_text(json.dumps(content, indent=2, ensure_ascii=False), encoding="utf-8")

    def draw(folder: Path) -> None:
        with show_task("Drawing"):
            save_content(_document(study, campaign, folder), folder / CONTENT)

    inputs = {"campaign": digest(campaign)}
    description = study.model_dump(mode="json")
    return (
        Stage(name="diagnose", inputs=inputs, writes=(DIAGNOSIS,), work=work),
        Stage(
            name="draw", inputs={**inputs, **description}, reads=(DIAGNOSIS,), writes=(CONTENT,), work=draw
        ),
    )


def report(study: DiscrepancyStudy, folder: Path) -> Mapping[str, bytes]:
    """Report the diagnosis from what was drawn; the campaign need not be there any more."""
    del study
    return read_content(folder / CONTENT)


def _document(study: DiscrepancyStudy, campaign: Path, folder: Path) -> Document:
    from reliab.report.kinds.discrepancy_report import discrepancy_report

    addition = _diagnose(campaign, digest(campaign))
    return discrepancy_report(
        addition.diagnosis,
        posteriors=addition.posteriors,
        provenance={**study.provenance, "campaign, SHA-256": digest(campaign), **software_provenance(folder)},
        notes=(study.purpose,) if study.purpose else (),
    )


def _folder(study: DiscrepancyStudy) -> Path:
    """Find the campaign: a folder, or the name of one that ships."""
    from reliab.discrepancy.campaign.reading import campaign_folder

    folder = campaign_folder(study.campaign.folder)
    return folder if folder.exists() else shipped("datasets", f"campaigns/{study.campaign.folder}")


@lru_cache(maxsize=1)
def _diagnose(campaign: Path, checksum: str) -> "Addition":
    """Diagnose a campaign of a checksum, once in a process."""
    del checksum
    from reliab.discrepancy.adding import add
    from reliab.discrepancy.campaign.reading import read_campaign
    from reliab.discrepancy.diagnose import diagnose

    return add(diagnose(read_campaign(campaign)))


KIND: Final = StudyKind(name="discrepancy", tables=DiscrepancyStudy, stages=stages, report=report)
"""A measured campaign: where it disagrees with its model, what is missing, the proof."""
