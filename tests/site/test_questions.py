"""Every page answers five questions that a reader with nothing but that page asks.

`questions.toml` holds them, with the words of the page that answer each. A new page has its questions first.
"""

import importlib
import re
import tomllib
from pathlib import Path

import pandas as pd
import pytest
from pages import PAGES, SITE, code, name_of

QUESTIONS = tomllib.loads((Path(__file__).parent / "questions.toml").read_text(encoding="utf-8"))
FEWEST_WORDS, MOST_WORDS = 4, 15  # of an answer


def included_pages(page):
    """Return the lines of the files that a page includes."""
    for target in re.findall(r"^```\{include\} (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE):
        yield from (page.parent / target).read_text(encoding="utf-8").splitlines()


def generated_lines(page):
    """Return the lines that the extensions of the site write into a page."""
    text = page.read_text(encoding="utf-8")
    directives = set(re.findall(r"^```\{(commands|options|keys|effects)\}", text, re.MULTILINE))
    if not directives:
        return
    pytest.importorskip("sphinx", reason="the site is built by sphinx, which is not installed here")
    options, keys = importlib.import_module("options"), importlib.import_module("keys")
    if "commands" in directives:
        yield from options.command_table().splitlines()
    if "options" in directives:
        yield from options.option_tables().splitlines()
    for part in re.findall(r"^```\{keys\} ([\w.]+)\.(\w+)$", text, re.MULTILINE):
        yield from keys.reference(getattr(importlib.import_module(part[0]), part[1])).splitlines()


def results_of_page(page):
    """Return a line for each result that a page shows, "case | quantity"."""
    for subject, table in re.findall(r'show_table\("(\w+)", "([^"]+)"', "\n".join(code(page))):
        rows = pd.read_csv(SITE.parents[1] / "tests" / "benchmarks" / "results" / f"{subject}.csv")
        rows = rows[rows["table"] == table]
        yield from rows["case"] + " | " + rows["quantity"]


@pytest.mark.default_cases(len(PAGES))
@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_page_answers_its_five_questions(page, monkeypatch):
    monkeypatch.syspath_prepend(SITE)
    source = page.read_text(encoding="utf-8").splitlines()
    lines = [*source, *included_pages(page), *generated_lines(page), *results_of_page(page)]
    questions = QUESTIONS[name_of(page)]
    assert len({entry["question"] for entry in questions}) == 5
    for entry in questions:
        assert any(entry["answer"] in line for line in lines), entry
        assert FEWEST_WORDS <= len(entry["answer"].split()) <= MOST_WORDS, entry


def test_every_question_has_an_existing_page():
    assert set(QUESTIONS) == {name_of(page) for page in PAGES}
