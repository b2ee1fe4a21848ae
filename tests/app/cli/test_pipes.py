"""Pipes: closed ones have an exit code of their own, and tables in them are whole."""

import ast
import io
import os
import subprocess
import sys
from pathlib import Path

import pytest
from parsed import nodes

import reliab
from reliab.app.cli import run
from reliab.app.cli.output import console, replace_unwritable_characters, show_table
from reliab.report.document import text_table
from reliab.report.terminal import rich_table

LAW = ("criterion", "--law", "guo_2017_18", "--f", "1", "--xi", "0.02")
QUICK = (("--help",), ("criterion", "--help"), ("info",))
COMMANDS = (("run", "--list"), LAW, (*LAW, "--json", "-"))


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("arguments", COMMANDS)
def test_an_unread_command_in_this_process_ends_with_141(arguments, monkeypatch):
    """As the program starts it; a process of its own takes seconds to import what it computes with."""
    reading, writing = os.pipe()
    os.close(reading)
    with io.TextIOWrapper(io.FileIO(writing, "wb"), encoding="utf-8") as pipe, io.StringIO() as errors:
        monkeypatch.setattr(sys, "stdout", replace_unwritable_characters(pipe))
        monkeypatch.setattr(sys, "stderr", errors)
        with pytest.raises(SystemExit) as end:
            raise SystemExit(run(arguments))
        assert (end.value.code, errors.getvalue()) == (141, "")


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("arguments", "errors"),
    [
        *((command, subprocess.PIPE) for command in QUICK),
        (QUICK[0], subprocess.STDOUT),
        *(pytest.param(command, subprocess.PIPE, marks=pytest.mark.slow) for command in COMMANDS),
        pytest.param(COMMANDS[-1], subprocess.STDOUT, marks=pytest.mark.slow),
    ],
)
def test_an_unread_command_ends_with_141(arguments, errors):
    process = subprocess.Popen(  # noqa: S603 - this very package
        [sys.executable, "-m", "reliab", *arguments], stdout=subprocess.PIPE, stderr=errors
    )
    process.stdout.close()
    sentences = process.stderr.read() if process.stderr else b""
    if process.stderr:
        process.stderr.close()
    assert (process.wait(), sentences) == (141, b"")


@pytest.mark.slow
def test_an_unread_refusal_ends_with_141():
    command = [sys.executable, "-m", "reliab", "assess", "missing.csv", "--f", "1"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)  # noqa: S603 - the line above
    process.stderr.close()
    assert (process.stdout.read(), process.wait()) == (b"", 141)
    process.stdout.close()


def test_buffered_output_reports_a_closed_pipe_once():
    reading, writing = os.pipe()
    os.close(reading)
    with io.TextIOWrapper(io.FileIO(writing, "wb")) as pipe:
        stream = replace_unwritable_characters(pipe)
        stream.write("a few words")
        with pytest.raises(SystemExit) as end:
            stream.flush()
        assert end.value.code == 141
        stream.write("more words")
        stream.close()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a full device")
def test_a_full_disk_is_bad_input_and_no_answer():
    with Path("/dev/full").open("wb") as full:
        process = subprocess.run(
            [sys.executable, "-m", "reliab", "--version"], stdout=full, stderr=subprocess.PIPE, check=False
        )
    assert process.returncode == 2
    assert process.stderr.decode().splitlines() == ["Error: No space left on device"]


@pytest.mark.parametrize("length", [3, 50, 700])
def test_no_cell_and_no_row_of_a_table_is_broken_in_a_pipe(length, capsys):
    cells = [[chr(ord("a") + column) * length + str(row) for column in range(12)] for row in range(3)]
    show_table("A title", [f"heading {cell}" for cell in cells[0]], cells)
    output = capsys.readouterr().out
    assert "…" not in output
    for row in cells:
        assert row in [line.split() for line in output.splitlines()]


def test_sentences_after_a_wide_table_are_broken_as_before_it(capsys):
    terminal, sentence = console(), "words " * 60
    for output in (sentence, rich_table(text_table([], ["x" * 500], caption="")), sentence):
        terminal.print(output)
    lines = capsys.readouterr().out.splitlines()
    assert lines[:3] == lines[-3:]


def test_every_table_is_printed_on_the_literal_console():
    """Only that console is made in the rooms of the command line, but for the bar of progress."""
    folder = Path(reliab.__file__).parent / "app" / "cli"
    result = {
        path.name
        for path in folder.rglob("*.py")
        for node in nodes(path)
        if isinstance(node, ast.Call)
        and getattr(node.func, "id", "") in {"Console", "LiteralConsole", "print"}
    }
    assert result == {"output.py"}


@pytest.mark.parametrize("command", [("assess",), ("motions", "check")])
def test_long_names_are_whole_in_a_pipe(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    names = [f"{'long_name_' * 20}{number}.csv" for number in range(2)]
    for name in names:
        Path(name).write_text("time_s,command_m\n0,nothing\n", encoding="utf-8")
    structure = ("--f", "1", "--xi", "0.02") if command == ("assess",) else ()
    assert run([*command, *names, *structure]) == 2
    output = capsys.readouterr().out
    for name in names:
        assert name in output
