"""A document on the terminal says what its PDF says, without figures."""

import io

import pandas as pd
from matplotlib.figure import Figure as Drawing

from reliab.app.cli.literal_console import LiteralConsole
from reliab.report.document import (
    Column,
    Document,
    Equation,
    Figure,
    Points,
    Remark,
    Section,
    Source,
    Table,
    text_table,
)
from reliab.report.numbers import Scientific, Shortest
from reliab.report.prose import prose
from reliab.report.terminal import print_blocks, print_document

NUMBERS = Table(
    frame=pd.DataFrame({"name": ["one [b]", None], "x": [1.0, 12.25], "y": [2e-5, float("nan")]}),
    columns=(
        Column(key="name", heading="Name"),
        Column(key="x", heading=prose("$alpha$"), unit="mm", number=Shortest()),
        Column(key="y", heading="Small", number=Scientific(decimals=1)),
    ),
    caption="Two rows.",
)


def lines_of(show, item):
    stream = io.StringIO()
    show(item, LiteralConsole(file=stream, width=100))
    return stream.getvalue().splitlines()


def test_every_block_but_a_figure_is_printed():
    blocks = (
        prose("Where $alpha <= 1$, see @fig:a."),
        Figure(drawing=Drawing(), caption="Not shown.", label="fig:a"),
        Section(title="Inner", blocks=(Points(items=("first", prose("*second*"))), Remark(text="Look."))),
        Equation(math="a / b"),
    )
    assert lines_of(print_blocks, blocks) == [
        *("Where α ≤ 1, see the figure or table.", ""),
        *("Inner", "- first", "- second", "Look.", "a / b"),
    ]


def test_numbers_of_a_table_stand_at_the_right_as_in_print():
    caption, headings, _, first, second = lines_of(print_blocks, (NUMBERS,))
    assert (caption, headings.split()) == ("Two rows.", ["Name", "α", "[mm]", "Small"])
    assert first.split() == ["one", "[b]", "1", "2.0·10⁻⁵"]
    assert second.split() == ["–", "12.25", "–"]
    assert first.index("1 ") + 1 == second.index("12.25") + 5


def test_headings_stand_where_they_are_told():
    table = text_table([("a", "1"), ("b", "20")], {"x": "left", "y": "right"}, caption="")
    output = lines_of(print_blocks, (table,))
    assert [line.rstrip() for line in output[-2:]] == ["a   1", "b  20"]


def test_facts_stand_before_and_cited_sources_behind():
    report = Document(
        kind="K",
        title="T",
        verdict="V",
        facts={"Asked": "5 %", "Empty": ""},
        blocks=(prose("As in @one."),),
        sources=(Source(label="one", text="A book."), Source(label="two", text="Another.")),
    )
    assert lines_of(print_document, report) == ["Asked: 5 %", "As in [one].", "[one] A book."]
