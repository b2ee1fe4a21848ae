"""A laboratory's own defaults: the command line comes first, and what does not exist is refused."""

import json

import pytest

from reliab.cli import run
from reliab.shipped import shipped

TEST = str(shipped("datasets", "sample_test/test.csv"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("RELIAB_CONFIG", raising=False)
    return tmp_path


def stated(capsys, *arguments):
    assert run(["assess", TEST, "--json", "-", *arguments]) == 0
    return json.loads(capsys.readouterr().out)


def test_options_of_the_file_hold_unless_the_command_line_says_otherwise(folder, capsys):
    text = '[assess]\nf = "1±0.01"\nxi = 0.02\nthreshold = 0.03\n'
    (folder / "reliab.toml").write_text(text, encoding="utf-8")
    answer = stated(capsys)
    assert (answer["f"], answer["xi"], answer["threshold"]) == (1.0, 0.02, 0.03)
    assert answer["stated"]["f"]["deviation"] == 0.01
    assert stated(capsys, "--threshold", "0.05")["threshold"] == 0.05


def test_the_environment_names_another_file(folder, capsys, monkeypatch):
    (folder / "laboratory.toml").write_text("[explore]\nf = 0.75\n", encoding="utf-8")
    monkeypatch.setenv("RELIAB_CONFIG", "laboratory.toml")
    assert run(["info"]) == 0
    monkeypatch.setenv("RELIAB_CONFIG", "missing.toml")
    assert run(["info"]) == 2
    assert "missing.toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    ["[assess\n", "[judge]\nf = 1\n", "f = 1\n", "[assess]\nfrequency = 1\n", "[motions]\nsets = 1\n"],
)
def test_what_does_not_exist_is_refused(folder, capsys, text):
    (folder / "reliab.toml").write_text(text, encoding="utf-8")
    assert run(["info"]) == 2
    assert "reliab.toml" in capsys.readouterr().err


def test_a_default_of_the_wrong_kind_is_refused(folder):
    (folder / "reliab.toml").write_text('[assess]\nthreshold = "much"\n', encoding="utf-8")
    assert run(["assess", TEST, "--f", "1", "--xi", "0.02"]) == 2
