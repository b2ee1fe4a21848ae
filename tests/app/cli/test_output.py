"""Terminals and pipes that lack characters get others in their place, and JSON stays exact."""

import ast
import importlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from parsed import nodes

import reliab
from reliab.app.cli import main, take_help_literally
from reliab.app.cli.output import replace_unwritable_characters
from reliab.core.encodings import printable
from reliab.version import __version__

STRUCTURE = ["--f", "1", "--xi", "0.02"]
CRITERION = ["criterion", "--law", "guo_2017_18", *STRUCTURE]
COMMANDS = [["--help"], ["criterion", "--help"], CRITERION, ["run", "--list"]]
NUMERICS = ("numpy", "numba", "scipy", "pandas", "xarray", "matplotlib")


@pytest.fixture
def run_with(monkeypatch):
    """Function that runs the program with streams of an encoding; returns its code, output and messages."""

    def run(encoding, arguments):
        streams = {name: io.TextIOWrapper(io.BytesIO(), encoding=encoding) for name in ("stdout", "stderr")}
        with monkeypatch.context() as patch:
            patch.setenv("NO_COLOR", "1")
            patch.setattr(sys, "argv", ["reliab", *arguments])
            for name, stream in streams.items():
                patch.setattr(sys, name, stream)
            with pytest.raises(SystemExit) as end:
                main()
            text = []
            for stream in streams.values():
                stream.flush()
                text.append(stream.buffer.getvalue())
        return end.value.code, *text

    return run


@pytest.mark.parametrize("arguments", COMMANDS)
def test_no_command_ends_in_an_encoding_error(run_with, arguments):
    code, output, _ = run_with("cp1252", arguments)
    assert code == 0
    assert output.decode("cp1252")


def test_a_process_of_its_own_has_no_encoding_error_either():
    environment = {**os.environ, "PYTHONIOENCODING": "cp1252", "PYTHONUTF8": "0", "NO_COLOR": "1"}
    command = [sys.executable, "-c", "from reliab.app.cli import main; main()", "criterion", "--help"]
    process = subprocess.run(command, capture_output=True, env=environment, check=False)  # noqa: S603
    assert process.returncode == 0, process.stderr.decode("cp1252")
    assert b"UnicodeEncodeError" not in process.stderr


def test_symbols_are_written_out(run_with):
    text = run_with("ascii", ["criterion", "--ellipses", "real_suite", *STRUCTURE])[1].decode("ascii")
    assert "(A - 1)2/a + d2/b <= 1" in text
    assert "alpha" in text
    assert "?" not in text


def test_lines_without_a_table_keep_to_the_terminals_characters_as_well(run_with, monkeypatch):
    installation = importlib.import_module("reliab.app.api.studies")
    monkeypatch.setattr(
        installation,
        "describe_installation",
        lambda: {"executable": "/home/Jürgen/ξ", "packages": {"ψ": "±1"}},
    )
    for encoding, text in (
        ("ascii", "executable: /home/Jurgen/xi\npackages:\n  psi: +-1\n"),
        ("utf-8", "executable: /home/Jürgen/ξ\npackages:\n  ψ: ±1\n"),
    ):
        code, out, _ = run_with(encoding, ["info"])
        assert (code, out.decode(encoding)) == (0, text)


def test_characters_without_a_name_or_with_one_word_are_written_out_too(run_with, monkeypatch):
    installation = importlib.import_module("reliab.app.api.studies")
    monkeypatch.setattr(
        installation, "describe_installation", lambda: {"executable": "/\u2708/\ue000/\udcc3"}
    )
    code, out, _ = run_with("cp1252", ["info"])
    assert (code, out.decode("cp1252")) == (0, "executable: /?/?/?\n")


@pytest.mark.slow
def test_json_is_exact_whatever_the_encoding(run_with):
    arguments = [*CRITERION, "--json", "-"]
    exact, ascii_text = (run_with(encoding, arguments)[1] for encoding in ("utf-8", "cp1252"))
    assert json.loads(ascii_text.decode("cp1252")) == json.loads(exact.decode("utf-8"))


def test_an_unencodable_message_ends_with_its_sentence(run_with):
    code, _, message = run_with("cp1252", [*CRITERION[:1], "--law", "ξ", *STRUCTURE])
    assert code == 2
    assert b"Error" in message
    assert b"Traceback" not in message


def modules_after(program, *names):
    """Which of these modules a fresh interpreter has imported after a program, and what it printed."""
    program = f"import sys; {program}; print(sorted({set(names)} & set(sys.modules)))"
    command = [sys.executable, "-c", program]
    result = subprocess.run(command, capture_output=True, text=True, check=True)  # noqa: S603
    *output, modules = result.stdout.rstrip("\n").split("\n")
    return modules, output


def test_version_and_help_are_printed_without_numerics():
    arguments = "from reliab.app.cli import run; run(['--version'])"
    assert modules_after(arguments, *NUMERICS, "rich") == ("[]", [__version__])
    assert modules_after("from reliab.app.cli import run; run(['criterion', '--help'])", *NUMERICS)[0] == "[]"


def test_a_criterion_from_ellipses_imports_no_kernels():
    arguments = (
        "from reliab.criterion.derivation import derive_criterion; "
        "from reliab.sweep.ellipse_dataset import open_ellipses"
    )
    idle = (
        "numba",
        "scipy.stats",
        "scipy.signal",
        "scipy.optimize",
        "emcee",
        "arviz_stats",
        "matplotlib",
        "zarr",
    )
    assert modules_after(arguments, *idle)[0] == "[]"


WORDS_OF_FILES = ("words", "units", "naming")
"""Modules of words that are looked for in files, in their languages, and never shown."""


def printable_characters():
    """Characters of all texts of the package but docstrings outside of the commands, and texts of reports."""
    characters = set()
    for path in Path(reliab.__file__).parent.rglob("*.py"):
        nodes_with_docstrings = (ast.Module, ast.ClassDef, ast.FunctionDef)
        docstrings = {
            id(node.body[0].value)  # type: ignore[attr-defined]
            for node in nodes(path)
            if isinstance(node, nodes_with_docstrings) and ast.get_docstring(node, clean=False) is not None
        }
        if "report" not in path.parts and path.stem not in WORDS_OF_FILES:
            texts = (node for node in nodes(path) if isinstance(node, ast.Constant))
            texts = (node.value for node in texts if id(node) not in docstrings or "cli" in path.parts)
            characters |= set("".join(text for text in texts if isinstance(text, str)))
    return {character for character in characters if character == printable(character)}


@pytest.mark.slow
def test_no_character_of_ours_becomes_a_question_mark():
    output = printable_characters()
    assert {"ξ", "█", "±", "²", "−"} <= output
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    replace_unwritable_characters(stream)
    missing = set()
    for character in sorted(output - {"?"}):
        stream.write(character)
        stream.flush()
        if b"?" in stream.buffer.getvalue():
            missing.add(character)
            stream.buffer.truncate(0)
    assert missing == set()


def test_bars_and_tolerances_are_written_out(run_with):
    code, design, _ = run_with("ascii", ["design", *STRUCTURE, "--details"])
    assert code == 0
    assert "########" in design.decode("ascii")
    assert "?" not in design.decode("ascii")
    code, _, refusal = run_with("ascii", ["design", "--f", "1±0.01", "--xi", "0.02"])
    assert code == 2
    assert b"found --f 1 +- 0.01." in refusal


@pytest.mark.slow
def test_bars_are_drawn_and_tolerances_read_in_the_c_locale():
    locale = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "NO_COLOR": "1"}
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONIOENCODING"}

    def asked(frequency):
        program = [sys.executable, "-m", "reliab", "design", "--f", frequency, "--xi", "0.02", "--details"]
        return subprocess.run(  # noqa: S603 - this very package
            program, capture_output=True, env={**environment, **locale}, check=False
        )

    design = asked("1").stdout.decode("ascii")
    assert "########" in design
    assert "?" not in design
    assert len({len(row) for row in design.splitlines() if row.startswith("|")}) <= 2, "columns are straight"
    refusal = asked("1±0.01")
    assert refusal.returncode == 2
    assert b"found --f 1 +- 0.01." in refusal.stderr


def test_help_of_commands_within_commands_keeps_its_brackets():
    inner = click.Command("inner", help="Mass [kg].", params=[click.Option(["--late"], help="Late [ms].")])
    group = click.Group("outer", commands={"inner": inner}, help="All [of them].")
    take_help_literally(group)
    assert (group.help, inner.help) == (r"All \[of them].", r"Mass \[kg].")
    assert inner.params[0].help == r"Late \[ms]."
