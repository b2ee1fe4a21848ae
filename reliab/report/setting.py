"""How a report is set for those who hand it on: paper, title, date, name and logo of the laboratory."""

import datetime as dt
import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from reliab.core.errors import InputError
from reliab.core.files import ordinary
from reliab.report.prose import literal

PAPERS: Final = {"a4": "a4", "letter": "us-letter"}
"""Names of paper, and what typst calls them."""

_PICTURES: Final = (".svg", ".png", ".jpg", ".jpeg")


@dataclass(frozen=True, kw_only=True)
class ReportSetting:
    """What a laboratory decides about a report."""

    title: str = ""  # Title in place of the report's own
    date: dt.date | None = None  # Date in place of that of the results
    paper: str = "a4"  # Paper
    laboratory: str = ""  # Name of the laboratory, on the first page and at the foot of all
    logo: Path | None = None  # Its logo, an SVG, PNG or JPEG picture, on the first page

    def __post_init__(self) -> None:
        """Check paper and logo."""
        if self.paper not in PAPERS:
            raise InputError(
                "Unknown format of paper",
                value=self.paper,
                remedy=f"Choose {' or '.join(PAPERS)}",
            )
        if self.logo is not None and self.logo.suffix.lower() not in _PICTURES:
            raise InputError(
                "The logo is no picture",
                value=self.logo.name,
                remedy=f"Give one that ends in {', '.join(_PICTURES)}",
            )
        self.files()

    def inputs(self) -> dict[str, str]:
        """Return what the template reads, by name."""
        logo = "" if self.logo is None else f"logo{self.logo.suffix.lower()}"
        texts = {"title": literal(self.title), "laboratory": literal(self.laboratory)}
        return {**texts, "paper": PAPERS[self.paper], "logo": logo}

    def files(self) -> dict[str, bytes]:
        """Return the logo by the name that the template knows; empty without one."""
        if self.logo is None:
            return {}
        try:
            return {self.inputs()["logo"]: ordinary(self.logo).read_bytes()}
        except OSError as error:
            raise InputError(
                f"Cannot read the logo: {error.strerror}", remedy="Check the path", where=str(self.logo)
            ) from error

    def to_dict(self) -> dict[str, Any]:
        """Put everything that changes a report into plain values, the logo by its checksum."""
        # By hand, since it identifies inputs of a run and is no result.
        logos = [hashlib.sha256(content).hexdigest() for content in self.files().values()]
        return {**self.inputs(), "date": None if self.date is None else self.date.isoformat(), "logos": logos}
