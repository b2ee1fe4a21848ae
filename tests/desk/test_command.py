"""The command `reliab desk`: what it needs and refuses."""

import subprocess
import sys

import pytest

from reliab.app.cli import run


def test_without_panel_the_command_says_how_to_install_it(tmp_path, monkeypatch, capsys):
    for name in [name for name in sys.modules if name.startswith("reliab.desk")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "panel", None)
    assert run(["desk", str(tmp_path)]) == 2
    errors = " ".join(capsys.readouterr().err.split())
    assert 'pip install "reliab[desk]"' in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize(
    ("arguments", "sentence"), [(["nothing_here"], "no such folder"), ([".", "--port", "99999"], "--port")]
)
def test_invalid_settings_of_the_server_are_refused(tmp_path, monkeypatch, capsys, arguments, sentence):
    monkeypatch.chdir(tmp_path)
    assert run(["desk", "--no-browser", *arguments]) == 2
    assert sentence in " ".join(capsys.readouterr().err.split())


def test_other_commands_do_not_import_panel():
    code = "import sys; from reliab.app.cli import run; run(['--help']); assert 'panel' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)  # noqa: S603
