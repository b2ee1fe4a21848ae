"""The report of an assessed test, with the checksums of the files from which it was made."""

import hashlib
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.shipped import or_shipped

if TYPE_CHECKING:
    from reliab.assessment import Assessment, FrameAssessment
    from reliab.report import Setting


@dataclass(frozen=True)
class Report:
    """A report that is wanted."""

    file: Path  # Its PDF
    setting: "Setting"  # Paper, title, name and logo of the laboratory, and the date; today by default

    def write(
        self, assessment: "Assessment | FrameAssessment", *, test: Path, structure: Path | None
    ) -> None:
        """Write it."""
        from reliab.assessment import Assessment
        from reliab.report import write_pdf
        from reliab.report.kinds.assessment import assessment_report, frame_assessment_report

        files = {"file": or_shipped(test, "datasets", "test.csv")}
        if structure is not None:
            files["structure"] = structure
        document = (
            assessment_report(assessment, provenance=_checksums(files))
            if isinstance(assessment, Assessment)
            else frame_assessment_report(assessment, provenance=_checksums(files))
        )
        write_pdf(document, self.file, date=datetime.now(tz=UTC).date(), setting=self.setting)


def _checksums(files: dict[str, Path]) -> dict[str, object]:
    """Names and checksums of files, by what each of them is."""
    lines: dict[str, object] = {}
    for name, path in files.items():
        lines[name] = path.name
        lines[f"{name}, SHA-256"] = hashlib.sha256(path.read_bytes()).hexdigest()
    return lines
