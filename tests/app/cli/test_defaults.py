"""A laboratory's own defaults: from the user's folder or a named file; never what decides or is written."""

import json
from functools import wraps

import pytest

import reliab
from reliab.app.api import monitor
from reliab.app.cli import COMMAND_LINE_ONLY, _commands, run, user_file
from reliab.core.errors import InputError
from reliab.core.shipped import shipped

TEST = str(shipped("datasets", "sample_test/test.csv"))
LABORATORY = '[assess]\nf = "1±0.01"\nxi = 0.02\nalpha = 0.9\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The folder where commands run, beside a home without configuration."""
    for variable in ("HOME", "XDG_CONFIG_HOME", "APPDATA"):
        monkeypatch.setenv(variable, str(tmp_path / "home"))
    monkeypatch.delenv("RELIAB_CONFIG", raising=False)
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    return here


def values(capsys, *arguments):
    assert run(["assess", TEST, "--json", "-", *arguments]) == 0
    output = capsys.readouterr()
    return json.loads(output.out), output.err


def test_a_named_file_holds_unless_the_command_line_says_otherwise(folder, capsys):
    (folder / "lab.toml").write_text(LABORATORY, encoding="utf-8")
    answer, sentences = values(capsys, "--config", "lab.toml")
    assert (answer["f"], answer["xi"], answer["alpha"]) == (1.0, 0.02, 0.9)
    assert answer["stated"]["f"]["deviation"] == 0.01
    assert "lab.toml" in sentences
    assert values(capsys, "--config=lab.toml", "--alpha", "0.8")[0]["alpha"] == 0.8


@pytest.mark.usefixtures("folder")
def test_the_file_of_the_users_folder_is_named_on_the_screen(capsys):
    user_file().parent.mkdir(parents=True)
    user_file().write_text(LABORATORY, encoding="utf-8")
    answer, sentences = values(capsys)
    assert answer["alpha"] == 0.9
    assert str(user_file()) in sentences


def test_the_folder_of_a_command_states_nothing(folder, capsys):
    (folder / "reliab.toml").write_text(f'{LABORATORY}json = "../x"\n', encoding="utf-8")
    assert run(["assess", TEST, "--f", "1", "--xi", "0.02"]) == 0
    assert "reliab.toml of this folder is not read" in capsys.readouterr().err
    assert not (folder.parent / "x").exists()
    assert run(["assess", TEST]) == 2  # no frequency


@pytest.mark.parametrize("key", ["json", "out", "report", "check", "threshold", "exact", "criterion"])
def test_outputs_and_decisions_are_refused_even_in_a_named_file(folder, capsys, key):
    (folder / "lab.toml").write_text(f'[assess]\n{key} = "x"\n', encoding="utf-8")
    assert run(["assess", TEST, "--config", "lab.toml", "--f", "1", "--xi", "0.02"]) == 2
    assert f"{key} of [assess]" in capsys.readouterr().err


def test_output_options_are_refused_in_a_file():
    for command in _commands().commands.values():
        for option in command.params:
            if option.opts[0].startswith("--") and (option.help or "").startswith(("Write", "Keep")):
                assert option.name in COMMAND_LINE_ONLY


def test_files_are_taken_from_the_folder_of_the_defaults(folder, capsys):
    user_file().parent.mkdir(parents=True)
    user_file().write_text('[assess]\nchannels = "channels.toml"\n', encoding="utf-8")
    (folder / "channels.toml").write_text("[command]\nscale = 2\n", encoding="utf-8")
    assert run(["assess", TEST, "--f", "1", "--xi", "0.02"]) == 2
    assert str(user_file().parent / "channels.toml") in capsys.readouterr().err


def test_the_environment_names_another_file(folder, capsys, monkeypatch):
    (folder / "laboratory.toml").write_text("[explore]\nf = 0.75\n", encoding="utf-8")
    monkeypatch.setenv("RELIAB_CONFIG", "laboratory.toml")
    assert run(["info"]) == 0
    monkeypatch.setenv("RELIAB_CONFIG", "missing.toml")
    assert run(["info"]) == 2
    assert "missing.toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    ["[assess\n", "[judge]\nf = 1\n", "f = 1\n", "[assess]\npitch = 1\n", "[motions]\nsets = 1\n"],
)
def test_unknown_commands_and_options_are_refused(folder, capsys, text):
    (folder / "lab.toml").write_text(text, encoding="utf-8")
    assert run(["info", "--config", "lab.toml"]) == 2
    assert "lab.toml" in capsys.readouterr().err


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("named", [["--config"], ["--config", "missing.toml"]])
def test_a_config_without_a_file_is_refused(capsys, named):
    assert run(["info", *named]) == 2
    assert capsys.readouterr().err.startswith("Error: ")


def test_a_default_of_the_wrong_kind_is_refused(folder):
    (folder / "lab.toml").write_text('[assess]\nrate = "much"\n', encoding="utf-8")
    assert run(["assess", TEST, "--config", "lab.toml", "--f", "1", "--xi", "0.02"]) == 2


class Verdict:
    reliable = True

    def to_dict(self):
        return {}


def test_a_default_of_the_structure_is_idle_beside_a_frame(folder, monkeypatch):
    calls = {}

    @wraps(reliab.assess)
    def assess(**values):
        calls.clear()
        calls.update(values)
        return Verdict()

    monkeypatch.setattr("reliab.app.api.assessment.assess", assess)
    laboratory = LABORATORY.replace("[assess]\n", "[assess]\nresolution = 0.01\n")
    (folder / "lab.toml").write_text(laboratory, encoding="utf-8")
    assert run(["assess", TEST, "--config", "lab.toml", "--structure", "frame.toml", "--json", "-"]) == 0
    assert calls.keys().isdisjoint({"f", "xi", "alpha", "resolution"})
    assert run(["assess", TEST, "--config", "lab.toml", "--json", "-"]) == 0
    assert (calls["f"], calls["xi"], calls["resolution"]) == ("1±0.01", "0.02", "0.01")


@pytest.mark.parametrize("service", ["follow_test", "export_monitor"])
def test_a_default_of_the_structure_is_idle_beside_the_model_of_a_monitor(folder, monkeypatch, service):
    calls = {}

    @wraps(getattr(monitor, service))
    def answer(**values):
        calls.update(values)
        raise InputError("asked")

    monkeypatch.setattr(monitor, service, answer)
    (folder / "lab.toml").write_text("[monitor]\nf = 1.2\nxi = 0.03\nfeedback-lag = 2\n", encoding="utf-8")
    asked = [TEST] if service == "follow_test" else ["--export", "c", "loop", "--rate", "256"]
    assert run(["monitor", *asked, "--config", "lab.toml", "--model", "model.toml"]) == 2
    assert str(calls["model"]) == "model.toml"
    assert calls.keys().isdisjoint({"f", "xi", "feedback_lag"})
    assert run(["monitor", *asked, "--config", "lab.toml", "--model", "model.toml", "--f", "1.2"]) == 2
    assert calls["f"] == "1.2"  # what the command line states is refused beside a model
