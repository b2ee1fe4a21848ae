"""Where a criterion comes from: enough to derive it again."""

import hashlib
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from typing import Any

import xarray as xr

SCHEMA_VERSION = 1
"""Version of the JSON of a criterion."""

_PACKAGES = ("reliab", "numpy", "scipy", "xarray")


def installed_versions() -> dict[str, str]:
    """Versions of the packages that computed a criterion."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    return tuple((name, version(name)) for name in _PACKAGES)


@dataclass(frozen=True, kw_only=True)
class Provenance:
    """Source of the ellipses, what was computed with, and what should be known before use.

    Parameters
    ----------
    source : str
        Where the ellipses came from, in words.
    n_motions, n_events : int
        Motions and earthquakes behind the criterion; 0 for a law taken from a publication.
    records_checksum : str
        SHA-256 over the sorted checksums of all records (or over a and b where records are unknown).
    window : str
        Stretch of the record over which the error was taken.
    packages : dict of str to str
        Package versions.
    settings : dict
        Parameters of the method.
    warnings : tuple of str
        Plain sentences for the user.
    """

    source: str
    n_motions: int = 0
    n_events: int = 0
    records_checksum: str = ""
    window: str = "record"
    packages: dict[str, str] = field(default_factory=installed_versions)
    settings: dict[str, Any] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def records_checksum(ellipses: xr.Dataset) -> str:
    """One checksum for all records behind ellipses, whatever their order.

    Parameters
    ----------
    ellipses : xarray.Dataset
        Ellipses with the coordinate `checksum`; without it, the values of a and b stand for the records.

    Returns
    -------
    str
        SHA-256 in hexadecimal digits.
    """
    if "checksum" in ellipses.coords:
        parts = sorted(str(each) for each in ellipses["checksum"].values)
    else:
        parts = [ellipses[name].values.astype("<f8").tobytes().hex() for name in ("a", "b")]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()
