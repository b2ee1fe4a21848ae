"""A fault of the program itself is no answer: it has an exit code of its own and says how to report it."""

import re
import sys
from pathlib import Path

import pytest

from reliab import __main__
from reliab.core.errors import UNEXPECTED


@pytest.fixture
def ended(monkeypatch, tmp_path, capsys):
    """Run the program with a command line that fails; its exit code and what it wrote."""

    def run(failing):
        monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
        monkeypatch.setattr(sys, "argv", ["reliab", "assess", "a.csv"])
        failing()
        with pytest.raises(SystemExit) as end:
            __main__.main()
        return end.value.code, capsys.readouterr().err

    return run


def raised():
    raise ZeroDivisionError("division by \x1b[31m zero")


def test_a_fault_ends_with_70_and_its_traceback_in_a_file(ended, monkeypatch):
    code, told = ended(lambda: monkeypatch.setattr("reliab.app.cli.main", raised))
    assert code == UNEXPECTED == 70
    assert "Traceback" not in told
    assert "\x1b" not in told
    assert re.fullmatch(r"Error: reliab itself has failed \(ZeroDivisionError\); .*`reliab info`.*\n", told)
    content = Path(re.search(r"\S+\.txt", told)[0]).read_text()
    assert content.startswith("reliab assess a.csv\n")
    assert "in raised" in content


def test_a_fault_at_an_import_ends_alike(ended, monkeypatch):
    code, told = ended(lambda: monkeypatch.setitem(sys.modules, "reliab.app.cli", None))
    assert code == UNEXPECTED
    assert "ModuleNotFoundError" in told


def test_where_no_file_can_be_written_the_traceback_is_shown(ended, monkeypatch):
    def failing():
        monkeypatch.setattr("reliab.app.cli.main", raised)
        monkeypatch.setattr("tempfile.tempdir", "/nowhere/at/all")

    code, told = ended(failing)
    assert code == UNEXPECTED
    assert "in raised" in told
    assert "the traceback above" in told
