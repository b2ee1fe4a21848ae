"""No text in a table that the program writes is a formula of a spreadsheet."""

import csv

import pandas as pd
import pytest

from reliab.app.api.assessment_files import write_tests
from reliab.core.plain_values import read_table, write_table

FORMULA = '=HYPERLINK("http://x")'


def cells(path):
    with path.open(encoding="utf-8") as table:
        return [cell for row in csv.reader(table) for cell in row]


def is_harmless(cell):
    return not cell.strip().startswith(("=", "+", "-", "@")) or cell.lstrip("+-")[:1].isdigit()


@pytest.mark.parametrize("index", [True, False])
def test_a_table_is_read_as_it_was_written_and_holds_no_formula(tmp_path, index):
    table = pd.DataFrame({"=name": [FORMULA, "+1"], "number": [-0.5, 2.0], "whole": [-1, 2]})
    write_table(table, tmp_path / "table.csv", index=index)
    assert all(map(is_harmless, cells(tmp_path / "table.csv")))
    read = read_table(tmp_path / "table.csv")[list(table)]
    assert read["=name"].map(str).tolist() == [FORMULA, "+1"]
    assert read["number"].tolist() == [-0.5, 2.0]


def test_every_text_of_a_verdict_is_escaped(tmp_path):
    texts = dict.fromkeys(("file", "test", "verdict", "metric", "fault"), FORMULA)
    write_tests([{**texts, "reasons": [FORMULA], "warnings": [FORMULA]}], tmp_path / "verdicts.csv")
    assert all(map(is_harmless, cells(tmp_path / "verdicts.csv")))
