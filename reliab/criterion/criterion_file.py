"""A criterion as JSON: written with its provenance, and read with every key and number checked."""

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Annotated, Any

import numpy as np
import scipy
from pydantic import BaseModel, ConfigDict, Strict

from reliab.core.described_files import described, parse_json
from reliab.core.errors import InputError
from reliab.core.vocabulary import CurveName
from reliab.criterion.ellipse_table import Ellipses, EllipseTable
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import law_from_dict, law_to_dict
from reliab.criterion.population import Population
from reliab.version import __version__

SCHEMA_VERSION = 2
"""Version of the JSON of a criterion; version 1 had neither limits for leads nor inscribed ellipses."""

_SYNTHETIC = re.compile(r"SYN\d{3,}")  # as `reliab.motions.synthetic` names its earthquakes


def installed_versions() -> dict[str, str]:
    """Versions of the packages that computed a criterion; without those that are not installed."""
    return dict(_versions())


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    installed = [("reliab", __version__), ("numpy", np.__version__), ("scipy", scipy.__version__)]
    with suppress(PackageNotFoundError):
        installed.append(("xarray", version("xarray")))
    return tuple(installed)


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
    packages: dict[str, str] = field(default_factory=installed_versions)  # Package versions
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
        checksums, pair = ellipses.of_motions.get("checksum"), (ellipses.a, ellipses.b)
    else:
        checksums = ellipses["checksum"].values if "checksum" in ellipses.coords else None
        pair = (ellipses["a"].values, ellipses["b"].values)
    if checksums is not None:
        parts = sorted(str(checksum) for checksum in checksums)
    else:
        parts = [values.astype("<f8").tobytes().hex() for values in pair]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


PLAIN = ("threshold", "metric", "confidence", "method", "joint")
"""Keys with plain values."""

_REMEDY = "Derive the criterion again"


def to_text(
    plain: Mapping[str, Any],
    laws: Mapping[str, Law | None],
    populations: Mapping[str, Population | None],
    provenance: Provenance,
) -> str:
    """Write the parts of a criterion as JSON; numbers that are not finite are refused."""
    content = {
        "schema_version": SCHEMA_VERSION,
        **plain,
        **{key: None if law is None else law_to_dict(law) for key, law in laws.items()},
        **{key: None if motions is None else motions.to_dict() for key, motions in populations.items()},
        "provenance": asdict(provenance),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)


def from_text(text: str, where: str = "") -> dict[str, Any]:
    """Read the parts of a criterion."""
    rule = "This is no criterion that `reliab criterion --out` wrote"
    content = parse_json(text, rule=rule, remedy=_REMEDY, where=where)
    _require_schema(content, where)
    rule = "A criterion must be as `reliab criterion --out` writes it"
    checked = described(_CriterionFile, content, rule=rule, remedy=_REMEDY, where=where)
    laws = {name: getattr(checked, name) for name in ("law", "lead_law")}
    motions = {name: getattr(checked, name) for name in ("population", "lead_population")}
    return {
        **{name: getattr(checked, name) for name in PLAIN},
        **{name: None if law is None else law_from_dict(law) for name, law in laws.items()},
        **{name: None if part is None else part.built() for name, part in motions.items()},
        "provenance": Provenance(**dict(checked.provenance)),
    }


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


class _Motions(_Part):
    frequencies: list[float]
    damping_ratios: list[float]
    events: list[str]
    log_alpha: list[list[list[float | None]]]
    log_beta: list[list[list[float | None]]]

    def built(self) -> Population:
        return Population.from_dict(dict(self))


class _ProvenanceTable(_Part):
    source: str
    motions: str
    n_motions: int
    n_events: int
    records_checksum: str
    window: str
    experimental_fraction: float
    curve: str
    packages: dict[str, str]
    settings: dict[str, Any]
    warnings: Annotated[tuple[str, ...], Strict(strict=False)]
    population: str = ""
    scope: dict[str, list[float]] = {}
    position: str = "inside"
    promised_from: float = 0.0


class _CriterionFile(_Part):
    schema_version: int
    threshold: float
    metric: str
    confidence: float
    method: str
    joint: bool
    law: dict[str, Any]
    lead_law: dict[str, Any] | None
    population: _Motions | None
    lead_population: _Motions | None
    provenance: _ProvenanceTable


def _require_schema(content: object, where: str) -> None:
    schema = content.get("schema_version") if isinstance(content, dict) else None
    if schema == 1:
        raise InputError(
            "This criterion is of version 1, which has no limits for leads",
            remedy="Derive it again with `reliab criterion --out FILE.json`",
            where=where,
        )
    if schema != SCHEMA_VERSION:
        raise InputError(
            f"A criterion must be JSON of schema version {SCHEMA_VERSION}",
            value="no schema_version" if schema is None else f"version {schema}",
            remedy="Use the version of reliab that wrote it, or derive it again",
            where=where,
        )
