"""Reference of the keys of a TOML file, from the schema by which the file is read.

    ```{keys} package.module.Description
    ```

on a page becomes a heading and a table of keys for every table of the file, and `{effects}` the library of
what a specimen may do.
"""

import json
import re
from collections.abc import Iterator
from importlib import import_module
from typing import Any, Final

from docutils import nodes
from pydantic import BaseModel
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from reliab.effects.effect import Role
from reliab.effects.registry import library

Schema = dict[str, Any]

UNITS: Final = {
    "_n_s_per_m": "N·s/m",
    "_n_per_m": "N/m",
    "_per_s2": "1/s²",
    "_per_s": "1/s",
    "_kg": "kg",
    "_hz": "Hz",
    "_pa": "Pa",
    "_m4": "m⁴",
    "_ms": "ms",
    "_m": "m",
    "_s": "s",
}
"""Units by the ends of keys, the longest first."""

_BOUNDS: Final = {
    "exclusiveMinimum": "> {}",
    "minimum": "≥ {}",
    "exclusiveMaximum": "< {}",
    "maximum": "≤ {}",
}
_TYPES: Final = {"string": "text", "boolean": "true or false", "integer": "whole number", "number": "number"}
_SMALLEST, _LARGEST = 1e-30, 1e30  # what computers need, not what a reader must know


def reference(description: type[BaseModel]) -> str:
    """Write the reference of a file as Markdown.

    Parameters
    ----------
    description : type
        What the file is read into.

    Returns
    -------
    str
        A heading and a table of keys for every table of the file, what stands outside of them first.
    """
    schema = description.model_json_schema()
    return "\n".join(_sections(schema, schema["$defs"], ""))


def _sections(table: Schema, named: Schema, path: str) -> Iterator[str]:
    """Yield the lines on a table of the file and on those inside it."""
    yield f"\n### {f'`{path}`' if path else 'Outside of all tables'}\n"
    yield f"{' '.join(table['description'].split())}\n"
    inside = [(key, *_inner(entry, named)) for key, entry in table["properties"].items()]
    required = table.get("required", ())
    yield "| key | value | unit | default | meaning |"
    yield "|---|---|---|---|---|"
    for key, tables, repeated in inside:
        entry = table["properties"][key]
        value = ("tables" if repeated else "table") if tables else _value(entry, named)
        unit = next((units for end, units in UNITS.items() if key.endswith(end)), "")
        default = "**required**" if key in required else _default(entry, has_tables=bool(tables))
        yield f"| `{key}` | {value} | {unit} | {default} | {entry['description']} |"
    for key, tables, repeated in inside:
        inner = f"{path.strip('[]')}.{key}".removeprefix(".")
        for one in tables:
            yield from _sections(one, named, f"[[{inner}]]" if repeated else f"[{inner}]")


def _inner(entry: Schema, named: Schema) -> tuple[list[Schema], bool]:
    """Find the tables that a key may hold, and whether it holds several of one kind."""
    if "$ref" in entry:
        return [named[entry["$ref"].rpartition("/")[2]]], False
    if "items" in entry and "$ref" in entry["items"]:
        return _inner(entry["items"], named)[0], True
    found = [_inner(way, named) for way in entry.get("anyOf", entry.get("oneOf", ()))]
    return [table for tables, _ in found for table in tables], any(repeated for _, repeated in found)


def _value(entry: Schema, named: Schema) -> str:
    """Say what a key holds, with its bounds."""
    if "const" in entry:
        return f'"{entry["const"]}"'
    if ways := entry.get("anyOf"):
        return " or ".join(dict.fromkeys(_value(way, named) for way in ways if way.get("type") != "null"))
    if "$ref" in entry or entry["type"] == "object":
        return "table"
    if entry["type"] == "array":
        pieces = entry.get("prefixItems")
        if pieces:
            return f"{len(pieces)} × {_value(pieces[0], named)}"
        kind, *bounds = _value(entry["items"], named).split(", ")
        several = re.sub("^(list|number|whole number)", r"\1s", kind)
        return ", ".join([f"list of {several}", *bounds])
    return ", ".join([_TYPES[entry["type"]], *_bounds(entry)])


def _bounds(entry: Schema) -> Iterator[str]:
    """Say what a number must be."""
    for name, text in _BOUNDS.items():
        if name in entry and abs(entry[name]) < _LARGEST:
            yield "> 0" if entry[name] == _SMALLEST else text.format(f"{entry[name]:g}")


def _default(entry: Schema, *, has_tables: bool) -> str:
    """Write the default as TOML; nothing where a key that is left out has none."""
    value = entry.get("default")
    if has_tables or value in (None, [], ""):
        return ""
    return f"`{value:.6g}`" if isinstance(value, float) else f"`{json.dumps(value)}`"


def effects() -> str:
    """Write the effects that a specimen may have, with their parameters, as Markdown."""
    lines = ["| name | what it does | parameters |", "|---|---|---|"]
    for effect in library().values():
        if effect.role is Role.FORCE:
            parameters = [f"`{each.name}`: {each.meaning} [{each.units}]" for each in effect.parameters]
            lines.append(f"| `{effect.name}` | {effect.description} | {'<br>'.join(parameters)} |")
    return "\n".join(lines)


class Keys(SphinxDirective):
    """The directive; its argument is the class that describes a file."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Put the reference into the page."""
        module, _, name = self.arguments[0].rpartition(".")
        home = import_module(module)
        self.env.note_dependency(str(home.__file__))
        self.env.note_dependency(__file__)
        text = reference(getattr(home, name))
        return self.parse_text_to_nodes(text, allow_section_headings=True)


class Effects(SphinxDirective):
    """The directive of the effects; it takes no argument."""

    def run(self) -> list[nodes.Node]:
        """Put the table into the page."""
        return self.parse_text_to_nodes(effects())


def setup(site: Sphinx) -> dict[str, bool]:
    """Make the directive known to Sphinx."""
    site.add_directive("keys", Keys)
    site.add_directive("effects", Effects)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
