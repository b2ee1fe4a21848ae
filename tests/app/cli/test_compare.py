"""`reliab compare` prints, writes and draws the ranking of what `reliab assess` finds."""

import json

import pandas as pd
import pytest
from late_runs import runs_of

import reliab
from reliab.app.cli import run


@pytest.fixture
def files(tmp_path):
    for name, frame in zip(("none.csv", "inverse.csv"), runs_of(3)[0], strict=True):
        frame.to_csv(tmp_path / name, index=False)
    return [str(tmp_path / name) for name in ("none.csv", "inverse.csv")]


@pytest.mark.slow
def test_the_ranking_is_printed_written_and_drawn(tmp_path, files, capsys):
    out, figure = tmp_path / "ranking.csv", tmp_path / "ranking.svg"
    arguments = ["compare", *files, "--f", "1", "--xi", "0.05"]
    saved_file = tmp_path / "ranking.json"
    assert run([*arguments, "--out", str(out), "--figure", str(figure), "--json", str(saved_file)]) == 0
    output = capsys.readouterr().out
    assert output.index("inverse.csv") < output.index("none.csv")
    assert list(pd.read_csv(out)["rank"]) == [1, 2]
    assert figure.read_text(encoding="utf-8").count("<svg") == 1
    content = json.loads(saved_file.read_text(encoding="utf-8"))
    assert [test["file"] for test in content["tests"]] == files[::-1]
    assert content == reliab.compare(files, f=1, xi=0.05).to_dict()


def test_options_of_verdicts_are_refused(files, capsys):
    assert run(["compare", *files, "--f", "1", "--check"]) == 2
    assert "--check" in capsys.readouterr().err
    assert run(["compare", files[0], "--f", "1", "--xi", "0.05"]) == 2
    assert "needs at least two tests" in capsys.readouterr().err


def test_compare_has_the_options_of_a_verdict_and_no_others(files, capsys):
    assert run(["compare", *files, "--f", "1", "--xi", "0.05", "--corrected", "a.csv"]) == 2
    assert "--corrected" in capsys.readouterr().err
