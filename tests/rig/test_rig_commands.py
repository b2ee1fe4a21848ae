"""`reliab rig`: what the commands keep, and say."""

import json

import numpy as np
import pandas as pd
import pytest

from reliab.app.api.rigs import export_rig, list_rig
from reliab.app.cli import run

STRUCTURE = ("--f", "1", "--xi", "0.02")


@pytest.fixture(scope="module")
def tests_of_lab(tmp_path_factory):
    """Two files of a rig that is 2 ms late."""
    folder = tmp_path_factory.mktemp("laboratory")
    time = np.arange(0.0, 12.0, 1.0 / 128.0)
    for seed in (1, 2):
        phase = np.random.default_rng(seed).uniform(0.0, 6.0)
        command = 0.02 * np.sin(2.0 * np.pi * time + phase) * np.sin(np.pi * time / 12.0) ** 2
        late = np.interp(time - 0.002, time, command)
        columns = {"time_s": time, "command_m": command, "measured_m": late}
        pd.DataFrame(columns).to_csv(folder / f"test_{seed}.csv", index=False)
    return folder


def asked(capsys, *arguments):
    """What a command writes as JSON."""
    code = run([*map(str, arguments), "--json", "-"])
    out, err = capsys.readouterr()
    return code, json.loads(out) if out else None, err


def test_tests_are_added_once_listed_shown_exported_and_removed(tests_of_lab, tmp_path, capsys):
    rig, files = tmp_path / "rig", sorted(tests_of_lab.glob("*.csv"))
    stated = (*STRUCTURE, "--date", "2026-03-01", "--event", "KOBE", "--covariate", "current=0.4")
    code, content, _ = asked(capsys, "rig", "add", rig, *files, *stated)
    assert (code, len(content["added"]), content["tests"]) == (0, 2, 2)
    assert content["added"][0]["d_ms"] == pytest.approx(2.0, abs=0.1)
    assert asked(capsys, "rig", "add", rig, *files, *STRUCTURE)[1]["present"] == ["test_1.csv", "test_2.csv"]
    code, _, err = asked(capsys, "rig", "add", rig, files[0], "--f", "2")
    assert code == 2
    assert "f 2 now, 1 then" in err
    assert list_rig(rig).to_dict()["tests"][0]["current"] == 0.4
    _, content, _ = asked(capsys, "rig", "show", rig, "test_1.csv")
    assert content["terms"]["event"] == "KOBE"
    assert content["assessment"]["A"] == content["test"]["A"]
    assert run(["assess", content["record"]]) == 0
    assert run(["rig", "show", str(rig), "test_1.csv"]) == run(["rig", "list", str(rig)]) == 0
    assert "KOBE" in capsys.readouterr().out
    assert export_rig(rig, tmp_path / "table.csv") == 2
    assert pd.read_csv(tmp_path / "table.csv")["event"].tolist() == ["KOBE", "KOBE"]
    assert asked(capsys, "rig", "remove", rig, "test_1.csv")[1] == {"removed": ["test_1.csv"]}
    assert [row["name"] for row in list_rig(rig).to_dict()["tests"]] == ["test_2.csv"]


def test_a_file_that_is_no_test_costs_no_other(tests_of_lab, tmp_path, capsys):
    (tmp_path / "wrong.csv").write_text("no,test\n")
    good = tests_of_lab / "test_1.csv"
    code, content, err = asked(
        capsys, "rig", "add", tmp_path / "rig", tmp_path / "wrong.csv", good, *STRUCTURE
    )
    assert code == 2
    assert list(content["faults"]) == [str(tmp_path / "wrong.csv")]
    assert len(content["added"]) == 1
    assert "the other tests are in the rig" in err


@pytest.mark.parametrize("text", ["current", "A=1", "current=much", "=3"])
def test_a_covariate_is_a_new_name_with_a_number(text, tmp_path, capsys):
    code = run(["rig", "add", str(tmp_path / "rig"), "sample_test", *STRUCTURE, "--covariate", text])
    assert code == 2
    assert "Error:" in capsys.readouterr().err
