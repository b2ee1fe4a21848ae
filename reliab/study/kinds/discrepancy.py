"""Studies of a measured campaign: where it disagrees with its model, what is missing, the proof."""

import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from reliab.errors import InputError
from reliab.report import Document
from reliab.shipped import shipped
from reliab.study.description import Study
from reliab.study.kinds.kind import Kind
from reliab.study.stages import Stage, digest
from reliab.study.steps import Material, Show

if TYPE_CHECKING:
    from reliab.discrepancy import Addition

DIAGNOSIS: Final = "diagnosis.json"


class DiscrepancyStudy(Kind):
    """A campaign diagnosed."""

    name = "discrepancy"

    @staticmethod
    def stages(material: Material, show: Show) -> Sequence[Stage]:
        """Diagnose the campaign."""
        campaign = _folder(material.study)

        def work(folder: Path) -> None:
            with show("Diagnosing"):
                content = _diagnosed(campaign, digest(campaign)).as_dict()
            (folder / DIAGNOSIS).write_text(
                json.dumps(content, indent=2, ensure_ascii=False), encoding="utf-8"
            )

        inputs = {"campaign": digest(campaign)}
        return (Stage(name="diagnose", inputs=inputs, writes=(DIAGNOSIS,), work=work),)

    @staticmethod
    def report(study: Study, folder: Path) -> Document:
        """Report the diagnosis; it is made again where it was made in another process."""
        del folder
        from reliab.report.kinds.discrepancy import discrepancy_report

        campaign = _folder(study)
        addition = _diagnosed(campaign, digest(campaign))
        return discrepancy_report(
            addition.diagnosis,
            posteriors=addition.posteriors,
            provenance={
                **study.provenance,
                "campaign, SHA-256": digest(campaign),
            },
            notes=(study.purpose,) if study.purpose else (),
        )


def _folder(study: Study) -> Path:
    """Find the campaign: a folder, or the name of one that ships."""
    if study.campaign is None:
        raise InputError(
            "A study of a discrepancy needs a campaign",
            value="no [campaign]",
            remedy="Name its folder under [campaign]",
        )
    folder = Path(study.campaign.folder)
    return folder if folder.exists() else shipped("datasets", f"campaigns/{study.campaign.folder}")


@lru_cache(maxsize=1)
def _diagnosed(campaign: Path, checksum: str) -> "Addition":
    """Diagnose a campaign of a checksum, once in a process."""
    del checksum
    from reliab.discrepancy import add, diagnose, read_campaign

    return add(diagnose(read_campaign(campaign)))
