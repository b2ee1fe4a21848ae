"""Results behind the evidence pages are well formed, and the pages name what is there."""

import importlib
import inspect

import pandas as pd
import pytest
from pages import SITE, code

RESULTS = SITE.parents[1] / "tests" / "benchmarks" / "results"
SUBJECTS = sorted(path.stem for path in RESULTS.glob("*.csv") if path.stem != "sources")
PAGES = sorted((SITE / "evidence").glob("*.md"))


@pytest.fixture
def figures(monkeypatch):
    monkeypatch.syspath_prepend(SITE)
    return importlib.import_module("evidence_figures")


@pytest.mark.parametrize("subject", SUBJECTS)
def test_a_result_is_a_figure_or_an_interval_with_a_source(subject):
    rows = pd.read_csv(RESULTS / f"{subject}.csv")
    sources = set(pd.read_csv(RESULTS / "sources.csv")["source"])
    assert set(rows["source"]) <= sources
    assert (rows["value"].notna() | (rows["low"].notna() & rows["high"].notna())).all()
    is_inside = ~(rows["low"] > rows["value"]) & ~(rows["value"] > rows["high"])
    assert rows[~is_inside].empty
    assert not rows.duplicated(["table", "case", "quantity"]).any()


def test_every_source_has_a_figure():
    sources_of_figures = pd.concat([pd.read_csv(RESULTS / f"{subject}.csv") for subject in SUBJECTS])[
        "source"
    ]
    assert set(pd.read_csv(RESULTS / "sources.csv")["source"]) == set(sources_of_figures)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_shows_existing_tables_and_quantities(page, figures):
    """Its calls, without the drawing."""

    def check(subject, tables, quantities):
        for table in tables:
            rows = figures.read_results(subject, table)
            assert set(quantities) <= set(rows["quantity"]) or len(tables) > 1

    calls = {
        "show_table": lambda subject, table, quantities=(): check(subject, [table], quantities),
        "show_shares": lambda subject, tables, quantity, **_: check(subject, tables, [quantity]),
        "show_promises": lambda subject, tables, _: check(subject, list(tables), []),
        "show_probabilities": lambda subject, table, **_: check(subject, [table], []),
        "show_sources": lambda *subjects: [figures.show_sources(subject) for subject in subjects],
    }
    idle_functions = {name: lambda: None for name, _ in inspect.getmembers(figures, inspect.isfunction)}
    for cell in code(page):
        exec(cell.replace("from evidence_figures import *", ""), idle_functions | calls)  # noqa: S102 - our own page
