"""`reliab.write_explorer`: a web page with sliders for the tolerable region."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reliab.core.shipped import or_shipped
from reliab.explore.page import Settings, by_length, write_page
from reliab.sweep.ellipse_file import open_windows


@dataclass(frozen=True, kw_only=True)
class ExplorerPage:
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


def write_explorer(
    *,
    out: str | Path = "criterion.html",
    ellipses: str | Path = "real_suite",
    f: float | None = None,
    xi: float | None = None,
    alpha: float = 1.0,
    threshold: float | None = None,
    confidence: float = 0.95,
    metric: str | None = None,
) -> ExplorerPage:
    """Write a web page, for use without a network, of tolerable errors before a test.

    Parameters
    ----------
    out : str or pathlib.Path, optional
        The HTML file.
    ellipses : str or pathlib.Path, optional
        Ellipses as `reliab ellipses --out` keeps them, or "real_suite".
    f, xi, alpha : float, optional
        Natural frequency [Hz], damping ratio [-] and share of the stiffness in the laboratory [-] with which
        the page opens.
    threshold, confidence : float, optional
        Error of the whole test [-] and share of the population's ground motions [-] with which it opens.
    metric : {"rms", "mte"}, optional
        Error of the whole test.

    Returns
    -------
    ExplorerPage
        Where it is, and what is in it.

    Raises
    ------
    InputError
        If the ellipses cannot be read, a value is not allowed or the file cannot be written.
    """
    windows = open_windows(or_shipped(Path(ellipses), "datasets", "ellipses.nc"))
    lengths = by_length(windows)
    settings = Settings(
        frequency=f,
        damping_ratio=xi,
        experimental_fraction=alpha,
        threshold=threshold,
        confidence=confidence,
        metric=metric,
    )
    name = Path(ellipses).name
    write_page(out, lengths, settings, source=f"the ellipses of {name}")
    return ExplorerPage(page=Path(out), ellipses=name, windows=tuple(lengths))
