"""A fault of the program itself is no answer: it has an exit code of its own and says how to report it."""

import re
import sys
from pathlib import Path

import pytest

from reliab import __main__
from reliab.core.errors import UNEXPECTED


@pytest.fixture
def run_failing(monkeypatch, tmp_path, capsys):
    """Run the program with a command line that fails; its exit code and what it wrote."""

    def run(failing):
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
        monkeypatch.setattr(sys, "argv", ["reliab", "assess", "a.csv"])
        failing()
        with pytest.raises(SystemExit) as end:
            __main__.main()
        return end.value.code, capsys.readouterr().err

    return run


def raise_fault():
    raise ZeroDivisionError("division by \x1b[31m zero")


def test_a_fault_ends_with_70_and_its_traceback_in_a_file(run_failing, monkeypatch):
    code, errors = run_failing(lambda: monkeypatch.setattr("reliab.app.cli.main", raise_fault))
    assert code == UNEXPECTED == 70
    assert "Traceback" not in errors
    assert "\x1b" not in errors
    assert re.fullmatch(r"Error: reliab itself has failed \(ZeroDivisionError\); .*`reliab info`.*\n", errors)
    content = Path(re.search(r"\S+\.txt", errors)[0]).read_text()
    assert content.startswith("reliab assess a.csv\n")
    assert "in raise_fault" in content


def test_a_fault_at_an_import_ends_alike(run_failing, monkeypatch):
    code, errors = run_failing(lambda: monkeypatch.setitem(sys.modules, "reliab.app.cli", None))
    assert code == UNEXPECTED
    assert "ModuleNotFoundError" in errors


def test_where_no_file_can_be_written_the_traceback_is_shown(run_failing, monkeypatch):
    def failing():
        monkeypatch.setattr("reliab.app.cli.main", raise_fault)
        monkeypatch.setattr("tempfile.tempdir", "/nowhere/at/all")

    code, errors = run_failing(failing)
    assert code == UNEXPECTED
    assert "in raise_fault" in errors
    assert "the traceback above" in errors
