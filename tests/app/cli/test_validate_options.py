"""Every option of `reliab validate` and `reliab run` changes the answer, or is refused."""

import inspect
import json
from typing import Any

import pytest
import typer
from typer.testing import CliRunner

from reliab.app.cli.studies import run as run_command
from reliab.app.cli.validate import validate
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.study.description import Study

app, runs = typer.Typer(), typer.Typer()
app.command()(validate)
runs.command()(run_command)

TABLE2 = shipped("datasets", "paper/table2.csv")
BASE = ("--ellipses", TABLE2, "--law", "table", "--confidence", 0.8, "--trials", 64, "--scheme", "k_fold")

CHANGES = {
    "scheme": ("--scheme", "random_halves"),
    "method": ("--method", "quantile"),
    "joint": ("--each",),
    "law": ("--law", "guo_2017_15", "--confidence", 0.95),
    "confidence": ("--confidence", 0.7),
    "trials": ("--trials", 128),
}
UNSUPPORTED = {
    "motions": ("--motions", "synthetic"),
    "results": ("--results", "real_suite"),
    "sets": ("--sets", "far_field"),
    "f": ("--f", 2),
    "xi": ("--xi", 0.05),
    "threshold": ("--threshold", 0.01),
    "metric": ("--metric", "mte"),
    "window": ("--window", "arias"),
    "alpha": ("--alpha", 0.5),
    "leave_out": ("--leave-out", "f"),
    "learn": ("--learn", "far_field"),
    "judge": ("--judge", "far_field"),
    "calibration": ("--calibration",),
}


def invoke(application, *arguments):
    return CliRunner().invoke(application, [str(argument) for argument in arguments])


@pytest.fixture(scope="module")
def base():
    return json.loads(invoke(app, *BASE, "--json", "-").stdout)


def test_the_walk_knows_every_option():
    options = set(inspect.signature(validate).parameters) - {"context", "ellipses", "json_target"}
    assert set(CHANGES) | set(UNSUPPORTED) == options


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("option", CHANGES)
def test_an_option_changes_the_answer(option, base):
    lines = json.loads(invoke(app, *BASE, *CHANGES[option], "--json", "-").stdout)
    assert lines["rows"] != base["rows"]


@pytest.mark.parametrize("option", UNSUPPORTED)
def test_an_option_unsupported_by_the_table_is_refused(option):
    assert isinstance(invoke(app, *BASE, *UNSUPPORTED[option]).exception, InputError)


@pytest.mark.parametrize(
    "options",
    [
        ("--method", "dirichlet"),
        ("--joint",),
        ("--law", "table"),
        ("--confidence", 0.9),
        ("--leave-out", "f"),
    ],
)
def test_calibration_refuses_options_of_criteria(options):
    result = invoke(app, "--ellipses", TABLE2, "--calibration", *options)
    assert "has no effect together with `calibration`" in str(result.exception)


def test_calibration_answers_by_bins():
    content = json.loads(
        invoke(
            app, "--ellipses", TABLE2, "--calibration", "--scheme", "k_fold", "--trials", 64, "--json", "-"
        ).stdout
    )
    assert sum(row["tests"] for row in content["bins"]) == 100 * 64
    assert content["bins"][0]["observed"] < 0.2
    assert content["bins"][-1]["observed"] > 0.8


@pytest.mark.parametrize(
    ("wrong", "option"),
    [
        (("--law", "guo_2017_18", "--method", "dirichlet", "--confidence", 0.95), "`method` has no effect"),
        (("--law", "guo_2017_18", "--each", "--confidence", 0.95), "`joint` has no effect"),
        (("--law", "guo_2017_18", "--confidence", 0.9), "has a confidence of 95 %"),
        (("--law", "guo_2017_18", "--threshold", 0.1), "0.05"),
    ],
)
def test_published_laws_refuse_other_promises(wrong, option):
    assert option in str(invoke(app, "--ellipses", TABLE2, *wrong).exception)


@pytest.mark.slow
def test_structures_missing_from_a_store_are_refused():
    result = invoke(app, "--ellipses", "real_suite", "--f", 0.8, "--xi", 0.02, "--confidence", 0.8)
    assert "`f=0.8`" in str(result.exception)


@pytest.mark.parametrize(
    "options", [("validation",), ("--out", "x"), ("--motions", "synthetic"), ("--sets", "far_field")]
)
def test_a_list_of_studies_refuses_unused_options(options):
    assert isinstance(invoke(runs, "--list", *options).exception, InputError)


@pytest.mark.of_studies
def test_options_of_run_reach_the_study(monkeypatch, tmp_path):
    calls: dict[str, Any] = {}

    def remember(study, folder, **_):
        calls.update(study=study, folder=folder)
        return folder / "report.pdf"

    monkeypatch.setattr("reliab.study.running.run_study", remember)
    invoke(runs, "thresholds", "--out", tmp_path / "here", "--motions", tmp_path, "--sets", "far_field")
    assert isinstance(calls["study"], Study)
    assert calls["folder"] == tmp_path / "here"
    assert calls["study"].motions.sources == (str(tmp_path),)  # type: ignore[attr-defined]
    assert calls["study"].motions.sets == ("far_field",)  # type: ignore[attr-defined]
    invoke(runs)
    assert calls["study"].motions.results == "real_suite"  # type: ignore[attr-defined]
