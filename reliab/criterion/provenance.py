"""Where a criterion comes from: enough to derive it again."""

import hashlib
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import scipy

from reliab.core.vocabulary import CurveName
from reliab.criterion.ellipse_table import Ellipses, EllipseTable
from reliab.version import __version__

SCHEMA_VERSION = 2
"""Version of the JSON of a criterion; version 1 had neither limits for leads nor inscribed ellipses."""

_SYNTHETIC = re.compile(r"SYN\d{3,}")  # as `reliab.motions.synthetic` names its earthquakes


def read_versions() -> dict[str, str]:
    """Versions of the packages that computed a criterion; without those that are not installed."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    versions = [("reliab", __version__), ("numpy", np.__version__), ("scipy", scipy.__version__)]
    with suppress(PackageNotFoundError):
        versions.append(("xarray", version("xarray")))
    return tuple(versions)


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Source of the ellipses, what was computed with, and what should be known before use."""

    source: str  # Where the ellipses came from, in words
    # Kind of the motions, "ground motions" or "synthetic ground motions", for headlines
    motions: str = "ground motions"
    n_motions: int = 0  # n_motions, n_events: Motions and earthquakes behind the criterion
    n_events: int = 0
    # SHA-256 over the sorted checksums of all records (or over a and b where records are unknown)
    records_checksum: str = ""
    window: str = "record"  # Stretch of the record over which the error was taken
    # Share α of the stiffness in the laboratory [-] for which the boundaries were computed
    experimental_fraction: float = 1.0
    # Ellipses behind the limits: "inscribed" in the motions' boundaries, or "ellipse", fitted to them
    curve: str = CurveName.ELLIPSE
    packages: dict[str, str] = field(default_factory=read_versions)  # Package versions
    settings: dict[str, Any] = field(default_factory=dict)  # Parameters of the method
    warnings: tuple[str, ...] = ()  # Plain sentences for the user
    population: str = ""  # The ground motions for which the criterion speaks, as the end of a sentence
    # Least value, 5 % and 95 % quantile and greatest value over these motions of what is known of them:
    # `magnitude`, `length` [s], `cycles`, and of responses `effective_duration` [s], `frequency_ratio` and
    # `sensitivity` [-]
    scope: dict[str, list[float]] = field(default_factory=dict)
    # Where the case that the criterion was carried to lies among them: "inside", "at the edge", "outside"
    position: str = "inside"
    # Share of the population's ground motions [-] from which one is promised: smaller ones cannot be kept
    promised_from: float = 0.0


def kind_of_motions(events: Sequence[str]) -> str:
    """Say whether motions are those of the built-in synthetic suite, by the names of their earthquakes.

    Returns "synthetic ground motions" if all are synthetic, "partly synthetic ground motions" if some are,
    and "ground motions" otherwise.

    >>> kind_of_motions(["SYN001", "SYN002"]), kind_of_motions(["KOBE", "SYN002"]), kind_of_motions(["KOBE"])
    ('synthetic ground motions', 'partly synthetic ground motions', 'ground motions')
    """
    synthetic = [_SYNTHETIC.fullmatch(event) is not None for event in events]
    if synthetic and all(synthetic):
        return "synthetic ground motions"
    return "partly synthetic ground motions" if any(synthetic) else "ground motions"


def records_checksum(ellipses: Ellipses) -> str:
    """One checksum for all records behind ellipses, whatever their order.

    `ellipses`: ellipses with the coordinate `checksum`; without it, the values of a and b stand for the
    records.
    """
    if isinstance(ellipses, EllipseTable):
        checksums, pair = ellipses.motion_values.get("checksum"), (ellipses.a, ellipses.b)
    else:
        checksums = ellipses["checksum"].values if "checksum" in ellipses.coords else None
        pair = (ellipses["a"].values, ellipses["b"].values)
    if checksums is not None:
        parts = sorted(str(checksum) for checksum in checksums)
    else:
        parts = [values.astype("<f8").tobytes().hex() for values in pair]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
