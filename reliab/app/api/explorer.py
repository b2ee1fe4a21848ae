"""`reliab.write_explorer`: a web page with sliders for the tolerable region."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack

from reliab.app import questions
from reliab.app.api.arguments import exact_values
from reliab.app.declaration import asks
from reliab.core.plain_values import PlainResult
from reliab.core.shipped import or_shipped
from reliab.explore.page import Settings, by_length, write_page
from reliab.sweep.ellipse_file import open_windows
from reliab.sweep.results import REAL

_NINETY_FIVE = 0.95


@dataclass(frozen=True, kw_only=True)
class ExplorerPage(PlainResult):
    """A page that was written."""

    page: Path
    ellipses: str
    windows: tuple[str, ...]

    @property
    def size(self) -> int:
        """Size of the file [bytes]."""
        return self.page.stat().st_size

    def to_dict(self) -> dict[str, Any]:
        """Plain values with stable keys: `page`, `bytes`, `ellipses` and `windows`."""
        return {
            "page": str(self.page),
            "bytes": self.size,
            "ellipses": self.ellipses,
            "windows": list(self.windows),
        }


@asks(questions.Explorer)
def write_explorer(**asked: Unpack[questions.Explorer]) -> ExplorerPage:
    """Write a web page, for use without a network, of tolerable errors before a test.

    Returns
    -------
    ExplorerPage
        Where it is, and what is in it.

    Raises
    ------
    InputError
        If the ellipses cannot be read, a value is not allowed or the file cannot be written.
    """
    out, ellipses = Path(asked["out"]), Path(asked["ellipses"] or REAL)
    windows = open_windows(or_shipped(ellipses, "datasets", "ellipses.nc"))
    lengths = by_length(windows)
    stated = exact_values(f=asked["f"], xi=asked["xi"], alpha=asked["alpha"])
    settings = Settings(
        frequency=stated.get("f"),
        damping_ratio=stated.get("xi"),
        experimental_fraction=stated.get("alpha", 1.0),
        threshold=asked["threshold"],
        confidence=_NINETY_FIVE if asked["confidence"] is None else asked["confidence"],
        metric=asked["metric"],
    )
    name = ellipses.name
    write_page(out, lengths, settings, source=f"the ellipses of {name}")
    return ExplorerPage(page=out, ellipses=name, windows=tuple(lengths))
