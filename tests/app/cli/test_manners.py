"""How the command line behaves whatever the command: examples, versions, interruption, colour."""

import errno
import io
import json
import os
import re
import shlex
import sys
from typing import Any

import pytest
import typer

import reliab
from reliab.app.cli import EXAMPLES, application, run, spread

COMMANDS = typer.main.get_group(application()).commands


def test_every_command_has_an_example_except_groups():
    assert set(EXAMPLES) == {name for name, command in COMMANDS.items() if not hasattr(command, "commands")}


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_is_printed_by_the_help_and_understood(name, capsys):
    assert run([name, "--help"]) == 0
    assert EXAMPLES[name].split(" --")[0] in " ".join(capsys.readouterr().out.replace("│", " ").split())
    first, *arguments = spread(shlex.split(EXAMPLES[name])[1:], typer.main.get_command(application()))
    assert first == name
    assert COMMANDS[name].make_context(name, arguments).params


def command_texts(command, path=()):
    """Each command and group with its path, and every text that its help is made of."""
    texts = [
        command.help,
        *(getattr(parameter, "help", None) for parameter in command.params),
        command.epilog,
    ]
    yield path, [text for text in texts if text]
    for name, inner in getattr(command, "commands", {}).items():
        yield from command_texts(inner, (*path, name))


@pytest.mark.parametrize(
    ("path", "texts"),
    [
        pytest.param(*item, id=" ".join(item[0]))
        for item in command_texts(typer.main.get_command(application()))
    ],
)
def test_help_shows_every_character_of_its_texts(path, texts, monkeypatch, capsys):
    """Units in brackets, asterisks, colons: nothing of it is markup."""
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 500)
    command: Any = typer.main.get_command(application())
    for name in path:
        command = command.commands[name]
    assert run([*path, "--help-all" if getattr(command, "advanced_names", ()) else "--help"]) == 0
    output = "".join(capsys.readouterr().out.split())
    assert [text for text in texts if "".join(text.split()) not in output] == []


def test_info_names_versions_and_shipped_data(capsys):
    assert run(["info"]) == 0
    output = capsys.readouterr().out
    assert f"reliab: {reliab.__version__}" in output
    assert run(["info", "--json", "-"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["packages"]["numpy"][0].isdigit()
    assert "real_suite" not in content
    assert content["shipped"]["datasets"].endswith("MB")


def test_an_interrupted_command_ends_with_130_and_a_sentence(monkeypatch, capsys):
    def interrupted(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr("reliab.app.api.studies.describe_installation", interrupted)
    assert run(["info"]) == 130
    assert capsys.readouterr().err.strip() == "Interrupted. No file is half written; run the command again."


@pytest.mark.parametrize(
    "arguments",
    [["assess", "nothing", "--f", "1"], pytest.param(["run", "nothing"], marks=pytest.mark.of_studies)],
)
def test_an_unknown_name_is_answered_by_the_known_names(arguments, capsys):
    assert run(arguments) == 2
    message = capsys.readouterr().err
    assert re.search(r"(nothing|No study 'nothing') not found\.|No study 'nothing'\.", message)
    assert ("sample_test" if arguments[0] == "assess" else "quick") in message


@pytest.mark.slow
def test_the_explorer_answers_in_json_too(tmp_path, capsys):
    page = tmp_path / "page.html"
    assert run(["explore", "--out", str(page), "--json", "-"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["bytes"] == page.stat().st_size
    assert (answer["page"], answer["ellipses"]) == (str(page), "real_suite")
    assert "record" in answer["windows"]


@pytest.mark.parametrize("columns", ["40", "79"])
def test_help_fits_narrow_terminals(monkeypatch, capsys, columns):
    monkeypatch.setenv("COLUMNS", columns)
    assert run(["assess", "--help"]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= int(columns)


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("variable", "coloured"), [("", True), ("1", False)])
def test_errors_are_coloured_unless_no_color_is_set(monkeypatch, variable, coloured):
    monkeypatch.setenv("NO_COLOR", variable)
    monkeypatch.setattr("sys.stderr", Terminal())
    assert run(["assess", "missing.csv", "--f", "1"]) == 2
    assert ("\x1b[31m" in sys.stderr.getvalue()) == coloured


def test_system_errors_are_one_sentence(monkeypatch, capsys):
    def write_suite(*_, **__):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), "/locked/suite")

    monkeypatch.setattr("reliab.app.api.simulation.write_suite", write_suite)
    assert run(["motions", "synthesize", "--count", "2", "--out", "suite"]) == 2
    assert capsys.readouterr().err == "Error: /locked/suite: Permission denied\n"


ENDINGS = {
    "assess sample_test --f 1 --xi 0.02 --report": ".pdf",
    "assess sample_test --f 1 --xi 0.02 --out": ".csv",
    "assess sample_test --f 1 --xi 0.02 --corrected": ".csv or .nc",
    "design --f 1 --xi 0.02 --figure": ".svg or .png or .pdf",
    "compare sample_test sample_test --f 1 --xi 0.02 --out": ".csv",
    "compare sample_test sample_test --f 1 --xi 0.02 --figure": ".svg or .png or .pdf",
    "criterion --ellipses real_suite --f 1 --xi 0.02 --out": ".json",
    "ellipses --motions synthetic --f 1 --xi 0.02 --out": ".nc",
    "explore --out": ".html",
    "record sample_test --csv": ".csv",
    "rig export no_rig --out": ".csv",
    "rig report no_rig --out": ".pdf",
}


@pytest.mark.parametrize("command", ENDINGS)
def test_a_file_is_not_written_under_the_ending_of_another_kind(command, tmp_path, capsys):
    file = tmp_path / "kept.doc"
    assert run([*command.split(), str(file)]) == 2
    heard = capsys.readouterr()
    assert heard.out == ""
    assert f"must end in {ENDINGS[command]}; found kept.doc" in " ".join(heard.err.split())
    assert not file.exists()
