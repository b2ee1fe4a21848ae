"""Several tests in one call: a table, a CSV, a list, and a faulty file that costs only its row."""

import json
import shutil

import pandas as pd
import pytest

import reliab
from reliab.app import cli
from reliab.core.shipped import shipped
from reliab.core.significant_digits import percent_and_interval

PLAIN = ("--f", "1", "--xi", "0.02")
LINES = 3000  # of the shipped test, enough for a verdict


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tests")
    lines = shipped("datasets", "sample_test/test.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (folder / "good.csv").write_text("".join(lines[:LINES]), encoding="utf-8")
    (folder / "faulty.csv").write_text("time_s,command_m\n", encoding="utf-8")
    shutil.copy(folder / "good.csv", folder / "sound.csv")
    return folder


@pytest.fixture
def ask(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)

    def call(*arguments, command="assess"):
        code = cli.run([command, *arguments, *PLAIN])
        return code, *capsys.readouterr()

    return call


def test_a_faulty_file_costs_its_row_only(ask, folder):
    code, out, error = ask("good.csv", "faulty.csv", "sound.csv", "--out", "verdicts.csv")
    assert code == 2
    assert "1 of 3 files could not be judged: faulty.csv" in error
    rows = pd.read_csv(folder / "verdicts.csv").set_index("file")
    assert rows.index.tolist() == ["good.csv", "faulty.csv", "sound.csv"]
    assert rows.loc["good.csv"].drop("test").equals(rows.loc["sound.csv"].drop("test"))
    assert rows["fault"].isna().tolist() == [True, False, True]
    assert pd.isna(rows.loc["faulty.csv", "verdict"])
    assert "not judged" in out
    good = rows.loc["good.csv"]
    assert percent_and_interval(good["rms"], good["rms_low"], good["rms_high"])[0] in out
    assert rows.loc["faulty.csv", "fault"].removeprefix("faulty.csv: ")[:40] in out


def test_a_list_holds_the_answer_of_each_test(ask):
    code, out, _ = ask("good.csv", "sound.csv", "--json", "-")
    content = json.loads(ask("good.csv", "--json", "-")[1])
    assert code == 0
    assert json.loads(out)[0] == {"file": "good.csv", **content}


@pytest.mark.slow
def test_check_requires_every_test_to_be_reliable(ask):
    strict = ("good.csv", "sample_test", "--check", "--threshold")  # errors of 0.5 and 2.3 %
    assert [ask(*strict, threshold)[0] for threshold in ("0.1", "0.01")] == [0, 1]
    assert ask("good.csv", "faulty.csv", "--check")[0] == 2


def test_unexpanded_pattern_excludes_the_table(ask, folder):
    for _ in range(2):
        ask("g*.csv", "--out", "gtable.csv")
        assert pd.read_csv(folder / "gtable.csv")["file"].tolist() == ["good.csv"]


def test_a_report_of_several_tests_is_refused(ask, folder):
    code, _, error = ask("good.csv", "sound.csv", "--report", "verdict.pdf")
    assert (code, (folder / "verdict.pdf").exists()) == (2, False)
    assert "--report has no effect together with several tests" in error


def test_a_faulty_shared_file_ends_the_call(ask, folder):
    code, _, error = ask("good.csv", "sound.csv", "--criterion", "faulty.csv", "--out", "never.csv")
    assert (code, (folder / "never.csv").exists()) == (2, False)
    assert "not judged" not in error


def test_a_frame_gives_a_table_too(folder, monkeypatch):
    frame = shipped("datasets", "frames/benchmark_case_1.toml")
    monkeypatch.chdir(folder)
    tests = ["good.csv", "faulty.csv", "--structure", str(frame), "--out", "frame.csv"]
    assert cli.run(["assess", *tests]) == 2
    assert pd.read_csv(folder / "frame.csv")["verdict"].notna().tolist() == [True, False]


def test_the_shipped_test_is_known_by_its_name(ask):
    assert json.loads(ask("sample_test", "--json", "-")[1])["test"] == "test.csv"


def test_python_gives_the_same_table(ask, folder):
    ask("good.csv", "faulty.csv", "--out", "verdicts.csv")
    assessment = reliab.assess(["good.csv", "faulty.csv"], f=1, xi=0.02)
    text = pd.read_csv(folder / "verdicts.csv")
    table = assessment.to_dataframe()
    table["fault"] = table["fault"].str.replace("`delimiter`", "--delimiter")  # each in its own words
    pd.testing.assert_frame_equal(table, text, check_dtype=False)
    assert (assessment.reliable, list(assessment.faults)) == (False, ["faulty.csv"])
    assert "1 not judged" in repr(assessment)
    assert "good.csv" in assessment._repr_html_()


def test_python_refuses_a_repeated_test(folder):
    with pytest.raises(reliab.InputError, match="once"):
        reliab.assess([folder / "good.csv", folder / "good.csv"], f=1, xi=0.02)


@pytest.fixture
def runs(folder):
    """The same test with half as much delay again."""
    table = pd.read_csv(folder / "good.csv", comment="#")
    late = table["command_m"] + 1.5 * (table["measured_m"] - table["command_m"])
    table.assign(measured_m=late).to_csv(folder / "late.csv", index=False)
    return ("good.csv", "late.csv")


def test_runs_of_the_same_test_are_judged_together(ask, runs):
    content = json.loads(ask(*runs, "--json", "-", command="extrapolate")[1])
    assert [run["file"] for run in content["runs"]] == ["good.csv", "late.csv"]
    assert "third run" in content["warnings"][0]
    _, out, _ = ask(*runs, command="extrapolate")
    assert "2 runs of one test, RMS error against 5 %" in out
    assert percent_and_interval(**content["runs"][0]["error"])[0] in out


def test_one_run_or_a_faulty_one_is_no_same_test(ask):
    assert "two tests or more" in ask("good.csv", command="extrapolate")[2]
    code, _, error = ask("good.csv", "faulty.csv", command="extrapolate")
    assert code == 2
    assert "This run cannot be judged" in error


@pytest.mark.parametrize("option", ["--json", "--out", "--corrected"])
def test_a_test_is_not_replaced_by_its_verdict(ask, folder, option):
    """It may be the only recording that there is."""
    original = (folder / "good.csv").read_bytes()
    sources = ["sound.csv"] if option == "--out" else []
    code, _, error = ask("good.csv", *sources, option, "good.csv")
    assert (code, original) == (2, (folder / "good.csv").read_bytes())
    assert f"{option} good.csv" in error
