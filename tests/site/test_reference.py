"""Reference pages say what the code has: public names, commands, keys of files, and formulas."""

import importlib
import re
import sys

import pytest
import typer
from pages import PAGES, SITE, name_of

import reliab
from reliab.app.cli import application
from reliab.discrepancy.campaign.reading import CampaignDescription
from reliab.simulation.frames.frame_tables import FrameDescription

API = (SITE / "reference" / "python.md").read_text(encoding="utf-8")
REFERENCE_NAMES = re.findall(r"^\.\. auto\w+:: ([\w.]+)$", API, re.MULTILINE)
FILES = (CampaignDescription, FrameDescription)


@pytest.fixture
def keys(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(SITE), *sys.path])
    pytest.importorskip("sphinx", reason="the site is built by sphinx, which is not installed here")
    return importlib.import_module("keys")


@pytest.mark.parametrize("name", [*REFERENCE_NAMES, *re.findall(r"`(reliab\.[\w.]+)`", API)])
def test_a_name_of_the_reference_is_the_public_one(name):
    """The package offers it, or it is imported from the module that defines it."""
    module, _, public_name = name.rpartition(".")
    thing = getattr(importlib.import_module(module), public_name)
    assert public_name in reliab.__all__ if module == "reliab" else thing.__module__ == module  # type: ignore[attr-defined]
    assert module == "reliab" or public_name not in reliab.__all__  # type: ignore[attr-defined]


def test_every_command_stands_in_the_table_of_functions():
    commands_of_table = re.findall(r"`reliab (\w+)`", API)
    assert sorted(commands_of_table) == sorted(typer.main.get_group(application()).commands)


def description_of(schema):
    """Keys of every table, with what the schema says of them."""
    for table in (schema, *schema["$defs"].values()):
        yield from table["properties"].items()


@pytest.mark.parametrize("file", FILES)
def test_every_key_of_a_file_stands_in_its_reference(file, keys):
    text = keys.reference(file)
    for key, entry in description_of(file.model_json_schema()):
        rows = [line for line in text.splitlines() if line.startswith(f"| `{key}` | ")]
        described_so = [row for row in rows if row.endswith(f" | {entry['description']} |")]
        assert described_so
        if isinstance(entry.get("default"), float):
            assert any(f"| `{entry['default']:.6g}` |" in row for row in described_so)
    page = (SITE / "reference" / "files.md").read_text(encoding="utf-8")
    assert f"{{keys}} {file.__module__}.{file.__name__}\n" in page


def test_numbers_with_a_unit_in_their_key_have_it_in_the_reference(keys):
    rows = [line for file in FILES for line in keys.reference(file).splitlines() if "number, " in line]
    units = {row.split("|")[1].strip(" `"): row.split("|")[3].strip() for row in rows}
    assert units["stiffness_n_per_m"] == "N/m"
    assert units["damping_n_s_per_m"] == "N·s/m"
    assert units["delay_s"] == "s"
    assert units["delay_ms"] == "ms"
    assert units["damping_ratio"] == ""


@pytest.mark.parametrize(
    "page", [*PAGES, SITE.parents[1] / "reliab" / "README.md"], ids=lambda page: page.stem
)
def test_formulas_are_drawn_without_a_rest_of_their_source(page):
    """What the converter does not know it leaves: a command with its backslash, the mark of a column."""
    convert = pytest.importorskip("latex2mathml.converter", reason="it belongs to the site").convert
    text = re.sub(r"```.*?```|`[^`]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    for formula in re.findall(r"\$\$(.+?)\$\$|\$([^$\n]+)\$", text, flags=re.DOTALL):
        mathml = convert("".join(formula).strip())
        assert "\\" not in mathml
        assert "&amp;" not in mathml
        assert "<mo>&#x00026;</mo>" not in mathml


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_no_formula_is_set_as_code(page):
    """An indented line outside of fences is code for Markdown."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert [line for line in text.splitlines() if line.startswith("    ") and "=" in line] == []


@pytest.mark.parametrize("key", ["frame", "damping"])
def test_the_reference_tells_that_frame_matrices_contain_the_specimen(key):
    """A frame that is described without its specimen has other frequencies and another error."""
    assert "of the whole structure, with its specimen" in (
        FrameDescription.model_fields[key].description or ""
    )
