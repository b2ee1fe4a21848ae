"""The report of an assessed test, with the checksums of the files from which it was made."""

import hashlib
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reliab.report import Document, Setting


def file_report(document: "Document", report: Path, setting: "Setting") -> None:
    """Write the report of a test.

    Parameters
    ----------
    document : Document
        The report.
    report : pathlib.Path
        Its PDF.
    setting : Setting
        Paper, title, name and logo of the laboratory, and the date; today by default.
    """
    from reliab.report import write_pdf

    write_pdf(document, report, date=datetime.now(tz=UTC).date(), setting=setting)


def checksums(files: Mapping[str, Path]) -> dict[str, object]:
    """Names and checksums of files, by what each of them is."""
    lines: dict[str, object] = {}
    for name, path in files.items():
        lines[name] = path.name
        lines[f"{name}, SHA-256"] = hashlib.sha256(path.read_bytes()).hexdigest()
    return lines
