"""TOML and JSON in which users describe something, read within bounds and checked at once by a schema.

The parsers themselves have no bounds: nesting ends in a `RecursionError`, a name of 100,000 parts takes
minutes, and a whole number of 5,000 digits ends in an error of another kind.
"""

import json
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from reliab.core.encodings import encoding_of_file
from reliab.core.errors import InputError
from reliab.core.files import LIMITS, require_small

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError

Model = TypeVar("Model", bound="BaseModel")

DEEPEST: Final = 32
"""Largest number of tables and lists within each other; what is described here needs seven."""

_LARGEST_WHOLE = 2**63  # as TOML has it
_DIGITS = 18  # of which NumPy's whole numbers hold any
_KEY_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_LONG_NAME = re.compile(rf"""(?<![\w"'.-])(?:{_KEY_PART}[ \t]*+\.[ \t]*+){{{DEEPEST}}}""")


def read_toml(path: str | Path, *, rule: str, remedy: str) -> dict[str, Any]:
    """Read a TOML file."""
    return parse_toml(
        read_description(path, rule=rule, remedy=remedy), rule=rule, remedy=remedy, where=str(path)
    )


def read_description(path: str | Path, *, rule: str, remedy: str, kind: str = "description") -> str:
    """Read the text of a description; arguments and errors as for :func:`read_toml`."""
    try:
        encoding = encoding_of_file(path)
        require_small(path, LIMITS[kind].bytes, remedy=remedy)
        return Path(path).read_text(encoding=encoding)
    except FileNotFoundError:
        raise InputError("No such file", remedy=remedy, where=str(path)) from None
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or "bytes that are not text"
        raise InputError(rule, value=reason, remedy=remedy, where=str(path)) from None


def parse_toml(text: str, *, rule: str, remedy: str, where: str) -> dict[str, Any]:
    """Parse the text of a TOML file; `where` names it, the rest as for :func:`read_toml`."""
    if _LONG_NAME.search(text):
        raise _too_deep(where)
    try:
        content = tomllib.loads(text, parse_float=lambda number: _finite(number, where))
    except RecursionError:
        raise _too_deep(where) from None
    except tomllib.TOMLDecodeError as error:
        raise InputError(rule, value=str(error), remedy=remedy, where=where) from None
    except InputError:
        raise
    except ValueError:  # Python takes 4,300 digits
        raise _too_large("one of more than 4,300 digits", where) from None
    _require_bounded(content, where)
    return content


def read_json(path: str | Path, *, rule: str, remedy: str) -> Any:  # noqa: ANN401 - JSON holds anything
    """Read a JSON file; as :func:`read_toml`, but whole numbers of many digits become floating-point ones."""
    text = read_description(path, rule=rule, remedy=remedy, kind="criterion")
    return parse_json(text, rule=rule, remedy=remedy, where=str(path))


def parse_json(text: str, *, rule: str, remedy: str, where: str = "") -> Any:  # noqa: ANN401
    """Parse the text of a JSON file; `where` names it, the rest as for :func:`read_json`."""

    def finite(number: str) -> float:
        return _finite(number, where)

    def number(digits: str) -> float:
        return int(digits) if len(digits) <= _DIGITS else finite(digits)

    try:
        content = json.loads(text, parse_constant=finite, parse_float=finite, parse_int=number)
    except RecursionError:
        raise _too_deep(where) from None
    except InputError:
        raise
    except ValueError as error:
        raise InputError(rule, value=str(error), remedy=remedy, where=where) from None
    _require_bounded(content, where)
    return content


def _finite(number: str, source: str) -> float:
    value = float(number)
    if not math.isfinite(value):
        raise InputError("Not a finite number", value=number, remedy="Correct it", where=source)
    return value


def _require_bounded(content: object, source: str) -> None:
    """Refuse what lies too deep, or is a whole number of more than 64 bits."""
    level, depth = [content], 0
    while level:
        depth += 1
        if depth > DEEPEST:
            raise _too_deep(source)
        for value in level:
            if isinstance(value, int) and abs(value) >= _LARGEST_WHOLE:
                raise _too_large(f"one of {value.bit_length()} bits", source)
        level = [item for value in level for item in _parts(value)]


def _too_large(value: str, source: str) -> InputError:
    rule, remedy = "A whole number must be below 2⁶³", "Write it with a decimal point"
    return InputError(rule, value=value, remedy=remedy, where=source)


def _parts(value: object) -> list[Any]:
    if isinstance(value, Mapping):
        return list(value.values())
    return value if isinstance(value, list) else []


def _too_deep(source: str) -> InputError:
    return InputError(
        f"Tables and lists are nested more than {DEEPEST} deep",
        remedy="Write the description as its examples are written",
        where=source,
    )


def validate_description(
    schema: "type[Model]", content: object, *, rule: str, remedy: str, where: str = ""
) -> "Model":
    """Return what parsed TOML or JSON describes by a schema, or refuse it with all faults in words."""
    from pydantic import ValidationError

    try:
        return schema.model_validate(content)
    except ValidationError as error:
        raise InputError(rule, value=faults_in_words(error), remedy=remedy, where=where) from None


def faults_in_words(error: "ValidationError") -> str:
    """Say in words what a schema holds to be wrong, and where."""
    return "; ".join(_fault(details) for details in error.errors())


def keys_of(location: Iterable[str | int]) -> list[str]:
    """Return the keys that lead to a fault, without the tags in parentheses by which a union is resolved."""
    return [str(key) for key in location if not str(key).startswith("(")]


def _fault(details: Mapping[str, Any]) -> str:
    place = ".".join(keys_of(details["loc"])) or "the file"
    entry = details["input"]
    if details["type"] == "extra_forbidden":
        return f"{place} is not a known {'table' if isinstance(entry, Mapping) else 'key'}"
    if details["type"] == "missing":
        return f"{place} is missing"
    error = details.get("ctx", {}).get("error")
    refusal = (
        error if isinstance(error, InputError) else InputError(details["msg"].removeprefix("Value error, "))
    )
    value = f", not {entry!r}" if isinstance(entry, str | int | float | bool) else ""
    advice = f" ({_as_clause(refusal.remedy)})" if refusal.remedy else ""
    return f"{place}: {_as_clause(refusal.rule)}{value}{advice}"


def _as_clause(sentence: str) -> str:
    return f"{sentence[:1].lower()}{sentence[1:]}"
