"""A report refers to what it holds; numbers in tables are aligned."""

import json

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure as Drawing

from reliab.report.content import files_of
from reliab.report.document import Column, Document, Equation, Figure, Section, Source, Table
from reliab.report.numbers import Fixed, Scientific, Significant
from reliab.report.prose import prose


def document(*blocks, **changes):
    return Document(**{"kind": "K", "title": "T", "verdict": "V", "blocks": blocks, **changes})


def test_a_reference_to_nothing_is_refused():
    with pytest.raises(ValueError, match="fig:missing"):
        document(prose("See @fig:missing."))


def test_a_label_is_used_once():
    with pytest.raises(ValueError, match="be used once; eq:a"):
        document(
            Equation(math="a", label="eq:a"), Section(title="S", blocks=(Equation(math="b", label="eq:a"),))
        )


def test_sources_are_numbered_as_they_are_referred_to():
    sources = tuple(Source(label=name, text=name) for name in ("one", "two", "three"))
    report = document(prose("As in @three and @one."), sources=sources)
    content = json.loads(files_of(report)["document.json"])
    assert [row["label"] for row in content["sources"]] == ["three", "one"]


def figure(label, **options):
    return Figure(drawing=Drawing(figsize=(2, 1)), caption="C", label=label, **options)


def test_one_figure_stands_on_the_first_page_and_there_only():
    report = document(Section(title="S", blocks=(figure("fig:a"), figure("fig:b", leads=True))))
    content = json.loads(files_of(report)["document.json"])
    assert [part["label"] for part in content["leading"]] == ["fig:b"]
    assert [part["label"] for part in content["blocks"][0]["blocks"]] == ["fig:a"]
    with pytest.raises(ValueError, match="two are marked"):
        document(figure("fig:a", leads=True), Section(title="S", blocks=(figure("fig:b", leads=True),)))


def test_an_appendix_stands_behind_the_other_sections():
    report = document(Section(title="Method", blocks=(), appendix=True), Section(title="Result", blocks=()))
    content = json.loads(files_of(report)["document.json"])
    assert [part["title"] for part in content["blocks"]] == ["Result"]
    assert [part["title"] for part in content["appendix"]] == ["Method"]


def test_a_table_needs_its_columns():
    with pytest.raises(ValueError, match="b is missing"):
        Table(frame=pd.DataFrame({"a": [1]}), columns=(Column(key="b", heading="b"),), caption="")


def cells(values, number):
    table = Table(
        frame=pd.DataFrame({"x": values}), columns=(Column(key="x", heading="x", number=number),), caption=""
    )
    (block,) = json.loads(files_of(document(table))["document.json"])["blocks"]
    return [row[0] for row in block["rows"]]


@pytest.mark.parametrize(
    "number", [Fixed(decimals=3), Significant(digits=3), Scientific(decimals=1), Fixed(decimals=0)]
)
def test_numbers_end_at_the_same_place_after_the_point(number):
    text = cells([23.268, 0.3333, -1234.5, np.nan, np.inf, 0.0], number)
    ends = {len(f"{cell['digits']}{cell['lacks']}".partition(".")[2]) for cell in text}
    assert len(ends) == 1


@pytest.mark.parametrize("value", [9.995, 0.09996, 99.96, 123456.0, -0.5, 1e-12])
def test_significant_digits_are_kept(value):
    contents = Significant(digits=3)(value)
    text = contents.digits.replace("−", "-")
    assert float(f"{text}e{contents.exponent or 0}") == pytest.approx(float(f"{value:.2e}"), rel=6e-3)
    assert len(text.lstrip("-").replace(".", "").lstrip("0")) >= 3


def test_values_of_a_template_are_never_marks():
    assert prose("{name}", name="$a$ *b* @c") == ("$a$ *b* @c",)
