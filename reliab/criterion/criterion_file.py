"""A criterion as JSON: written with its provenance, and read with every key and number checked.

A verdict loads no pydantic: `criterion` imports this module where a file is read or written.
"""

import json
from collections.abc import Mapping
from dataclasses import asdict
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Strict

from reliab.core.described_files import parse_json, validate_description
from reliab.core.errors import InputError
from reliab.criterion.laws.law import Law
from reliab.criterion.laws.registry import law_from_dict, law_to_dict
from reliab.criterion.population import Population
from reliab.criterion.scope import SCHEMA_VERSION, Provenance

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


def from_text(text: str, location: str = "") -> dict[str, Any]:
    """Read the parts of a criterion."""
    rule = "This is no criterion that `reliab criterion --out` wrote"
    content = parse_json(text, rule=rule, remedy=_REMEDY, where=location)
    schema = content.get("schema_version") if isinstance(content, dict) else None
    if schema == 1:
        raise InputError(
            "This criterion is of version 1, which has no limits for leads",
            remedy="Derive it again with `reliab criterion --out FILE.json`",
            where=location,
        )
    if schema != SCHEMA_VERSION:
        raise InputError(
            f"A criterion must be JSON of schema version {SCHEMA_VERSION}",
            value="no schema_version" if schema is None else f"version {schema}",
            remedy="Use the version of reliab that wrote it, or derive it again",
            where=location,
        )
    rule = "A criterion must be as `reliab criterion --out` writes it"
    file_model = validate_description(_CriterionFile, content, rule=rule, remedy=_REMEDY, where=location)
    laws = {name: getattr(file_model, name) for name in ("law", "lead_law")}
    motions = {name: getattr(file_model, name) for name in ("population", "lead_population")}
    return {
        **{name: getattr(file_model, name) for name in PLAIN},
        **{name: None if law is None else law_from_dict(law) for name, law in laws.items()},
        **{name: None if part is None else part.build() for name, part in motions.items()},
        "provenance": Provenance(**dict(file_model.provenance)),
    }


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, defer_build=True)


class _Motions(_Part):
    frequencies: list[float]
    damping_ratios: list[float]
    events: list[str]
    log_alpha: list[list[list[float | None]]]
    log_beta: list[list[list[float | None]]]

    def build(self) -> Population:
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
