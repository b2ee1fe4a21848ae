"""What those who cite the package read: the citation file, and a summary of the length that journals take."""

import re
from pathlib import Path

import pandas as pd
import pytest

from reliab.criterion.methods.registry import METHODS
from reliab.effects.registry import library
from reliab.report.document import SOURCES
from reliab.version import __version__

ROOT = Path(__file__).parents[1]
MOST_WORDS = 1000  # of the summary, without its head
NAMING = ("README.md", "reliab/README.md", "reports/site/explanation/paper.md", "reports")


def test_the_citation_states_this_version():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"version: {__version__}\n" in citation
    release_date = re.search(r"^date-released: (\S+)$", citation, re.MULTILINE)[1]
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## [{__version__}] - {release_date}\n" in changes


def test_the_summary_has_the_sections_and_the_length_of_a_software_journal():
    _, head, text = (ROOT / "reports" / "paper.md").read_text(encoding="utf-8").split("---\n", maxsplit=2)
    assert "authors:" in head
    sections = re.findall(r"^# (.*)$", text, re.MULTILINE)
    assert {"Summary", "Statement of need", "State of the field", "References"} <= set(sections)
    assert len(text.split()) <= MOST_WORDS


def test_citations_of_the_paper_equal_its_list():
    text = (ROOT / "reports/paper.md").read_text(encoding="utf-8")
    bibliography = (ROOT / "reports/paper.bib").read_text(encoding="utf-8")
    entries = re.findall(r"^@\w+\{(\w+),$", bibliography, re.MULTILINE)
    assert sorted(set(re.findall(r"@(\w+\d{4})", text))) == sorted(entries)
    assert f"title = {{{paper_title()}}}" in bibliography.casefold()


def test_numbers_of_the_paper_are_those_of_the_package():
    text = (ROOT / "reports/paper.md").read_text(encoding="utf-8")
    table = pd.read_csv(ROOT / "reports/site/other_methods.csv")
    names = ("tracking_indicator", "pei", "fei", "face", "rebuilt")
    ranks = ", ".join(f"{table[name].corr(table['true'], method='spearman'):.2f}" for name in names)
    assert f"| {len(table)} tests; {ranks} |" in text
    assert f"On {len(table)} tests" in text
    assert f"| {len(METHODS)} methods |" in text
    assert f"| {len(list(library()))} effects |" in text
    earthquakes = pd.read_csv(ROOT / "datasets/real_suite/earthquakes.csv")
    assert f"| 100 motions, {len(earthquakes)} earthquakes |" in text


def paper_title():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    return re.search(r'^  - type: article\n    title: "(.*)"$', citation, re.MULTILINE)[1].casefold()


def texts():
    """Every text for readers, and what reports say of the paper."""
    pages = {
        path.relative_to(ROOT).as_posix(): path for path in ROOT.rglob("*.md") if ".venv" not in path.parts
    }
    lines = {name: path.read_text(encoding="utf-8") for name, path in pages.items()}
    lines["reports"] = next(source.text for source in SOURCES if source.label == "guo2017")
    return lines


@pytest.mark.parametrize(("name", "text"), [pytest.param(*item, id=item[0]) for item in texts().items()])
def test_the_paper_has_one_title_wherever_it_is_named(name, text):
    """In italics after its authors, or in a list of references: authors, year, title."""
    titles = re.findall(r"Guo and others,?(?: \(2017\),)? \*([^*]+)\*", text)
    titles += re.findall(r"^Guo(?:, T\.)? and others \(2017\)\. ([^.]+)\.", text, re.MULTILINE)
    assert {" ".join(title.split()).casefold() for title in titles} <= {paper_title()}
    assert titles or name not in NAMING
