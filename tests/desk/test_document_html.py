"""Reports on a page say what they say in print, and texts of files are no markup."""

import re

import pandas as pd
import pytest

from reliab.app.api.rigs import document_of_rig
from reliab.core.shipped import shipped
from reliab.desk.work import document_html
from reliab.report.document import Column, Document, Points, Section, Table
from reliab.report.numbers import Fixed
from reliab.report.prose import formula, prose

HOSTILE = "<img src=x onerror=alert(1)>"


def test_texts_are_escaped_wherever_they_stand():
    frame = pd.DataFrame({"name": [HOSTILE], "value": [1.5]})
    table = Table(
        frame=frame,
        columns=(
            Column(key="name", heading=HOSTILE),
            Column(key="value", heading="d", unit="<i>", number=Fixed(decimals=2)),
        ),
        caption=HOSTILE,
    )
    document = Document(
        kind=HOSTILE, title=HOSTILE, verdict=HOSTILE, facts={HOSTILE: HOSTILE}, sheet=True,
        blocks=(Section(title=HOSTILE, blocks=(HOSTILE, Points(items=(HOSTILE,)), table)),),
    )  # fmt: skip
    html = document_html(document)
    assert "<img" not in html
    assert html.count("&lt;img") == 9
    assert ">1.50<" in html


def test_formulas_are_written_in_signs():
    text = document_html(
        Document(
            kind="k", title="t", verdict=prose("where $alpha k <= sqrt(a)$ is *small*"), blocks=(), sheet=True
        )
    )
    assert "<i>α k ≤ √(a)</i> is <b>small</b>" in text
    assert formula("omega^2 tau_c") == "ω^2 τ_c"


@pytest.mark.slow
def test_a_report_has_its_figures_as_pictures_with_words_and_its_tables_with_headings():
    html = document_html(document_of_rig(shipped("datasets", "sample_rig")))
    assert re.search(r'<img alt="[^"]{20,}" width="736" src="data:image/svg\+xml;base64,', html)
    assert "<svg" not in html
    assert html.count("<table>") == html.count("<thead>") > 2
    assert "What to expect of the next test" in html
