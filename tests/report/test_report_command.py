"""`reliab report` makes the report of a finished run again, and says what is missing elsewhere."""

import json

from reliab.cli import run


def test_a_folder_without_a_run_is_explained(tmp_path, capsys):
    assert run(["report", str(tmp_path)]) == 2
    assert "run" in capsys.readouterr().err


def test_the_report_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("reliab.study.write_report", lambda folder: folder / "report.pdf")
    assert run(["report", str(tmp_path), "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "folder": str(tmp_path),
        "report": str(tmp_path / "report.pdf"),
    }
