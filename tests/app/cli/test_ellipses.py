"""`reliab ellipses`: both sides and both curves of each boundary."""

import json
import math

import pytest
import typer
from typer.testing import CliRunner

from reliab.app.cli import motions as module
from reliab.app.cli.motions import ellipses

app = typer.Typer()
app.command()(ellipses)


def run(*arguments: object) -> str:
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def records(tmp_path_factory):
    folder = tmp_path_factory.mktemp("records")
    t = [0.01 * k for k in range(1500)]
    record = "\n".join(
        f"{x},{math.sin(7.0 * x) * math.sin(3.1 * x) * math.exp(-((x - 6.0) ** 2) / 6.0)}" for x in t
    )
    (folder / "EVENT.csv").write_text("time [s],acceleration [m/s2]\n" + record)
    return folder


def questions(records):
    return ["--motions", records, "--f", 1, "--f", 2, "--xi", 0.05, "--threshold", 0.05, "--threshold", 0.5]


@pytest.fixture(scope="module")
def rows(records):
    output = run(*questions(records), "--json", "-")
    return json.loads(output)["ellipses"]


def test_keys_of_the_lag_are_kept_and_those_of_leads_and_inscribed_ellipses_added(rows):
    assert len(rows) == 4
    for row in rows:
        assert {"motion", "f", "xi", "threshold", "metric", "a", "b", "sse", "n"} <= set(row)
        for suffix in ("_lead", "_inscribed", "_lead_inscribed"):
            assert {f"{name}{suffix}" for name in ("a", "b", "sse", "n", "no_ellipse")} <= set(row)
    small = [row for row in rows if row["threshold"] == 0.05]
    assert {row["f"] for row in small} == {1.0, 2.0}
    for row in small:
        assert row["b_inscribed"] * row["a_inscribed"] < row["b"] * row["a"]
        assert row["b_lead"] > row["b"]
        assert row["no_ellipse"] is None


def test_unreached_lead_side_is_null_with_its_reason(rows):
    (row,) = (row for row in rows if row["threshold"] == 0.5 and row["f"] == 2.0)
    assert row["a_lead"] is None
    assert row["no_ellipse_lead"] == "not_reached"
    assert row["a_lead_inscribed"] > 0.0


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(("page", "pages"), [(3, 2), (4, 1)])
def test_a_long_table_is_printed_page_by_page_with_every_boundary_once(
    records, rows, page, pages, monkeypatch
):
    monkeypatch.setattr(module, "_PAGE", page)
    monkeypatch.setenv("COLUMNS", "250")
    output = run(*questions(records))
    boundaries = [line for line in output.splitlines() if "EVENT" in line]
    assert len(boundaries) == len(rows)
    for line, row in zip(boundaries, rows, strict=True):
        assert [float(cell) for cell in line.split()[1:3]] == [row["f"], row["xi"]]
    assert output.count("4 boundaries") == 1
    assert output.count("inscribed, lead") == 2 * pages
