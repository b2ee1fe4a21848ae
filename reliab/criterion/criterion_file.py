"""A criterion as JSON: written with its provenance, and read with every key and number checked."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, fields
from typing import Any

from reliab.criterion.file_keys import require_keys
from reliab.criterion.laws import Law, law_from_dict, law_to_dict
from reliab.criterion.population import Population
from reliab.criterion.provenance import SCHEMA_VERSION, Provenance
from reliab.errors import InputError

PLAIN = {"threshold": float, "metric": str, "confidence": float, "method": str, "joint": bool}
"""Keys with plain values, and their types."""

_DIGITS = 18  # of which NumPy's whole numbers hold any
_KEYS = (*PLAIN, "law", "lead_law", "population", "lead_population", "provenance")


def to_text(
    plain: Mapping[str, Any],
    laws: Mapping[str, Law | None],
    populations: Mapping[str, Population | None],
    provenance: Provenance,
) -> str:
    """Write the parts of a criterion as JSON; numbers that are not finite are refused.

    Parameters
    ----------
    plain : mapping
        Plain values by their keys.
    laws, populations : mapping
        Laws and motions by their keys.
    provenance : Provenance
        Where the criterion comes from.

    Returns
    -------
    str
        The JSON.
    """
    content = {
        "schema_version": SCHEMA_VERSION,
        **plain,
        **{key: None if law is None else law_to_dict(law) for key, law in laws.items()},
        **{key: None if motions is None else motions.to_dict() for key, motions in populations.items()},
        "provenance": asdict(provenance),
    }
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)


def from_text(text: str) -> dict[str, Any]:
    """Read the parts of a criterion.

    Parameters
    ----------
    text : str
        JSON as :func:`to_text` writes it.

    Returns
    -------
    dict
        Arguments of a criterion.

    Raises
    ------
    InputError
        If the text is no such JSON, of another schema, lacks a key, has an unknown one, or holds a number
        that is not finite or a value of another type.
    """
    content = dict(require_keys(_checked(text), _KEYS, "A criterion's file"))
    for key, kind in PLAIN.items():
        value = content[key]
        allowed = (float, int) if kind is float else (kind,)
        if not isinstance(value, allowed) or (kind is float and isinstance(value, bool)):
            raise _broken(f"The key {key} of a criterion's file must be of type {kind.__name__}", repr(value))
        content[key] = kind(value)
    for key in ("law", "lead_law"):
        if content[key] is not None:
            content[key] = law_from_dict(_mapping(content[key], key))
    for key in ("population", "lead_population"):
        if content[key] is not None:
            content[key] = Population.from_dict(_mapping(content[key], key))
    content["provenance"] = _provenance(content["provenance"])
    return content


def _checked(text: str) -> dict[str, Any]:
    """Take everything but the version of the schema."""
    try:
        content = json.loads(text, parse_constant=_refuse_constant, parse_float=_finite, parse_int=_number)
    except (ValueError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise _broken(
            "A criterion must be JSON as written by `reliab criterion --out`", str(error)
        ) from error
    schema = content.pop("schema_version", None) if isinstance(content, dict) else None
    if schema == 1:
        raise InputError(
            "A criterion must be of the present schema, which has limits of its own for leads",
            value="version 1, which had none and rested on fitted ellipses",
            remedy="Derive it again with `reliab criterion --out FILE.json`",
        )
    if not isinstance(content, dict) or schema != SCHEMA_VERSION:
        raise InputError(
            f"A criterion must be JSON of schema version {SCHEMA_VERSION}",
            value="no schema_version" if schema is None else f"version {schema}",
            remedy="Use the version of reliab that wrote it, or derive it again",
        )
    return content


def _refuse_constant(name: str) -> float:
    raise _broken("Every number of a criterion's file must be finite", name)


def _number(text: str) -> float:
    """Take a number without a point, whole where NumPy can hold it."""
    return int(text) if len(text) <= _DIGITS else _finite(text)


def _finite(text: str) -> float:
    number = float(text)
    return number if math.isfinite(number) else _refuse_constant(text)


def _mapping(content: object, key: str) -> Mapping[str, Any]:
    if not isinstance(content, Mapping):
        raise _broken(f"The key {key} of a criterion's file must hold keys and values", repr(content))
    return content


def _provenance(content: object) -> Provenance:
    kept = dict(require_keys(content, [part.name for part in fields(Provenance)], "A criterion's provenance"))
    sentences = kept["warnings"]
    if not isinstance(sentences, list) or not all(isinstance(sentence, str) for sentence in sentences):
        raise _broken("The warnings of a criterion's provenance must be a list of sentences", repr(sentences))
    kept["warnings"] = tuple(sentences)
    for key, kind in (("n_motions", int), ("n_events", int), ("settings", dict), ("packages", dict)):
        if not isinstance(kept[key], kind):
            raise _broken(
                f"The key {key} of a criterion's provenance must be of type {kind.__name__}", kept[key]
            )
    return Provenance(**kept)


def _broken(rule: str, value: object) -> InputError:
    return InputError(rule, value=value, remedy="Derive the criterion again")
