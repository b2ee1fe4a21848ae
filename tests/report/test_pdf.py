"""The same report gives the same bytes; text of users stays text; fonts are embedded."""

import datetime as dt
import json
import re
import shutil
import subprocess
import time
import zlib

import pandas as pd
import pytest
import typst
from hypothesis import given, settings, strategies as st
from matplotlib.figure import Figure as Drawing

from reliab.core.errors import InputError
from reliab.report.content import files_of
from reliab.report.document import Column, Document, Equation, Figure, Section, Source, Table
from reliab.report.numbers import Fixed
from reliab.report.pdf import compile_report, templates, write_pdf
from reliab.report.prose import literal, prose

DATE = dt.date(2026, 1, 1)
NASTY = (
    "#panic()",
    "$ x",
    "*a* _b_ `c`",
    "@fig:none <label>",
    "\\ // /* */",
    "a\x00b\u202ec",
    "= Heading",
    '"] #eval("1") [',
    "#" * 300,
    "{value} {0}",
    "Пример 例 مثال",
)


def report(text="Text.", **changes):
    drawing = Drawing(figsize=(4, 2))
    drawing.subplots().plot([1.0, 2.0], [3.0, 4.0])
    frame = pd.DataFrame({"name": [text, "other"], "value": [1.25, None]})
    columns = (
        Column(key="name", heading=text),
        Column(key="value", heading="Value", unit="ms²", number=Fixed()),
    )
    blocks = (
        prose("See @fig:one, @tab:one, @eq:one, @sec:one, @guo, {text}, $xi$.", text=text),
        Equation(math="(A - 1)^2 / a + d^2 / b <= 1", label="eq:one"),
        Table(frame=frame, columns=columns, caption=text, label="tab:one"),
        Figure(drawing=drawing, caption=text, label="fig:one"),
    )
    content = {
        "kind": "Test",
        "title": text,
        "verdict": text,
        "blocks": (Section(title=text, blocks=blocks, label="sec:one"),),
        "facts": {text: text},
        "provenance": {text: text},
        "sources": (Source(label="guo", text=text),),
    }
    return Document(**{**content, **changes})


@pytest.fixture(scope="module", autouse=True)
def first_pdf(tmp_path_factory):
    """A report that is written before all others, and when."""
    path = tmp_path_factory.mktemp("first") / "report.pdf"
    write_pdf(report(), path, date=DATE)
    return path.read_bytes(), time.monotonic()


def streams(pdf):
    for match in re.finditer(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL):
        try:
            yield zlib.decompress(match[1])
        except zlib.error:
            yield match[1]


@pytest.mark.parametrize("tool", [("pdfinfo",), ("qpdf", "--check")])
def test_tools_read_a_report_without_complaint(tmp_path, tool):
    if shutil.which(tool[0]) is None:
        pytest.skip(f"{tool[0]} is not installed")
    write_pdf(report(), tmp_path / "report.pdf", date=DATE)
    read = subprocess.run([*tool, tmp_path / "report.pdf"], check=True, capture_output=True, text=True)  # noqa: S603 - a tool
    assert read.stderr == ""


def test_catalogue_of_a_tagged_report_omits_a_harmful_default():
    pdf = compile_report(report(), date=DATE)
    assert b"/Marked true" in pdf
    assert b"/Suspects" not in pdf


def test_the_date_is_written():
    assert compile_report(report(), date=DATE) != compile_report(report(), date=dt.date(2026, 1, 2))


def test_every_font_is_embedded():
    pdf = compile_report(report(), date=DATE)
    content = b"\n".join([pdf, *streams(pdf)])
    description = len(re.findall(rb"/Type\s*/FontDescriptor", content))
    assert description >= 3
    assert len(re.findall(rb"/FontFile[23]?\s", content)) == description


@pytest.mark.parametrize("sheet", [False, True])
def test_typst_has_nothing_to_warn_of(sheet):
    files = {**templates(), **files_of(report(sheet=sheet))}
    inputs = {"date": "2026-01-01", "version": "0"}
    _, warnings = typst.compile_with_warnings(files, ignore_system_fonts=True, sys_inputs=inputs)
    assert warnings == []


def headings(document):
    files = {**templates(), **files_of(document)}
    inputs = {"date": "2026-01-01", "version": "0"}
    result = typst.query(files, "heading", field="body", ignore_system_fonts=True, sys_inputs=inputs)
    return result if isinstance(result, str) else str(result)


@pytest.mark.default_cases(3)
@pytest.mark.parametrize("text", NASTY)
def test_text_of_users_is_set_as_it_is(text):
    (first, *_) = json.loads(headings(report(text)))
    assert first == {"func": "text", "text": literal(text)}
    assert compile_report(report(text), date=DATE).startswith(b"%PDF")


@settings(max_examples=settings().max_examples // 4)  # every example is set as a PDF
@given(st.text(min_size=1, max_size=60))
def test_any_text_can_be_set(text):
    pdf = compile_report(report(text), date=DATE)
    assert pdf.startswith(b"%PDF")


def test_an_unwritable_file_is_explained(tmp_path):
    with pytest.raises(InputError, match="Cannot write the file"):
        write_pdf(report(), tmp_path / "missing" / "report.pdf", date=DATE)


def test_scripts_without_letters_in_the_fonts_stand_as_numbers():
    assert literal("Пример مثال דוגמה ≤ ₂") == "Пример مثال דוגמה ≤ ₂"
    assert literal("例 ไทย 🌋") == r"\u4f8b \u0e44\u0e17\u0e22 \U0001f30b"


def test_bytes_are_the_same_whenever_it_is_written(first_pdf, tmp_path):
    """Last, so that the second has changed."""
    first, written_at = first_pdf
    time.sleep(max(0.0, 1.1 + written_at - time.monotonic()))
    write_pdf(report(), tmp_path / "second.pdf", date=DATE)
    assert (tmp_path / "second.pdf").read_bytes() == first
