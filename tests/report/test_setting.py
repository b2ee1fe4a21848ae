"""A report on another paper, with another title and date, a laboratory's name and logo, and a glossary."""

import datetime as dt
import json
import re

import pandas as pd
import pytest
import typst
from matplotlib.figure import Figure as Drawing

from reliab.core.errors import InputError
from reliab.report.content import TERMS, files_of, glossary_of
from reliab.report.document import Column, Document, Figure, Section, Table
from reliab.report.pdf import compile_report, templates
from reliab.report.prose import plain_text
from reliab.report.setting import ReportSetting

DATE = dt.date(2026, 1, 1)
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 3"><rect width="9" height="3"/></svg>'


def report(sections=1, *, sheet=False):
    blocks = tuple(
        Section(title=f"Section {k}", blocks=("A criterion of delays with --motions.",))
        for k in range(sections)
    )
    return Document(kind="Test", title="Own title", verdict="Good.", blocks=blocks, facts={}, sheet=sheet)


def headings(document, setting=None):
    inputs = {"date": "2026-01-01", "version": "0", **(setting or ReportSetting()).inputs()}
    files = {**templates(), **files_of(document), **(setting or ReportSetting()).files()}
    return str(typst.query(files, "heading", field="body", ignore_system_fonts=True, sys_inputs=inputs))


@pytest.fixture
def logo(tmp_path):
    path = tmp_path / "logo.svg"
    path.write_text(SVG, encoding="utf-8")
    return path


def test_each_part_of_a_setting_changes_the_report(logo):
    settings = [
        ReportSetting(),
        ReportSetting(title="Another"),
        ReportSetting(date=dt.date(2025, 5, 5)),
        ReportSetting(paper="letter"),
        ReportSetting(laboratory="Our laboratory"),
        ReportSetting(logo=logo),
    ]
    for sheet in (False, True):
        pdfs = [compile_report(report(sheet=sheet), date=DATE, setting=setting) for setting in settings]
        assert len(set(pdfs)) == len(settings)
    assert len({json.dumps(setting.to_dict()) for setting in settings}) == len(settings)


@pytest.mark.parametrize("height", [3.0, 4.5, 5.5])
def test_a_tall_figure_of_the_first_page_leaves_room_for_the_contents(height):
    """One page with facts, figure and contents, and one that holds all sections."""
    drawing = Drawing(figsize=(6.3, height))
    figure = Figure(drawing=drawing, caption="Nothing. " * 12, label="fig:one", leads=True)
    text = "A sentence of five words. " * 12
    blocks = tuple(
        Section(title=f"Section {k}", blocks=(figure, text) if k == 0 else (text,)) for k in range(6)
    )
    facts = {f"Fact {k}": "what is known of it " * 12 for k in range(5)}
    document = Document(kind="Test", title="Own title", verdict="Good. " * 30, blocks=blocks, facts=facts)
    pdf = compile_report(document, date=DATE)
    assert len(re.findall(rb"/Type ?/Page\b", pdf)) == 2


def test_letter_has_the_size_of_letter():
    pdf = compile_report(report(), date=DATE, setting=ReportSetting(paper="letter"))
    assert re.findall(rb"/MediaBox\s*\[([^]]*)\]", pdf) == [b"0 0 612 792"]


def test_invalid_settings_are_refused(tmp_path):
    with pytest.raises(InputError, match="known format"):
        ReportSetting(paper="a5")
    with pytest.raises(InputError, match="is no picture"):
        ReportSetting(logo=tmp_path / "logo.txt")
    with pytest.raises(InputError, match="Cannot read the logo"):
        ReportSetting(logo=tmp_path / "logo.svg")
    logo = tmp_path / "logo.png"
    logo.write_bytes(b"no picture")
    with pytest.raises(InputError, match="sound picture"):
        compile_report(report(), date=DATE, setting=ReportSetting(logo=logo))


def test_terms_of_a_report_are_explained_at_its_end():
    content = json.loads(files_of(report())["document.json"])
    assert [name[0]["text"] for name, _ in content["glossary"]] == ["criterion", "delay d"]
    assert "Words" in headings(report())
    assert "Words" not in headings(report(sheet=True))


def test_every_explained_word_is_found_by_its_own_name():
    for term in TERMS:
        spoken = plain_text(term.name)
        assert term in glossary_of(spoken), spoken


@pytest.mark.parametrize(("sections", "pages"), [(2, 1), (6, 3)])
def test_a_short_report_has_no_page_of_contents(sections, pages):
    """One page, or a first page, and as many as sections of 65 mm need."""
    assert pages_of(report(sections)) <= pages


def pages_of(document):
    inputs = {"date": "2026-01-01", "version": "0"}
    files = {**templates(), **files_of(document)}
    pngs = typst.compile(files, format="png", ignore_system_fonts=True, sys_inputs=inputs, ppi=10)
    return len(pngs) if isinstance(pngs, list) else 1


def test_sections_of_an_appendix_have_letters():
    blocks = tuple(Section(title=f"S{k}", blocks=(), appendix=k == 0) for k in range(2))
    document = Document(kind="Test", title="T", verdict="V", blocks=blocks)
    inputs = {"date": "2026-01-01", "version": "0"}
    files = {**templates(), **files_of(document)}
    content = json.loads(
        str(typst.query(files, "heading", field="numbering", ignore_system_fonts=True, sys_inputs=inputs))
    )
    assert content == ["1.1", "A.1"]


def test_a_long_narrow_table_stands_in_two_halves():
    """So that it needs fewer pages than one that takes the whole width."""
    frame = pd.DataFrame({"x": [f"row {k}" for k in range(200)]})
    narrow, wide = (
        Table(frame=frame, columns=(Column(key="x", heading="X", wide=wide),), caption="C")
        for wide in (False, True)
    )
    halves, complete = (
        pages_of(Document(kind="Test", title="T", verdict="V", blocks=(table,))) for table in (narrow, wide)
    )
    assert (halves, complete) == (3, 4)
