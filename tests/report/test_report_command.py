"""`reliab report` makes the report of a finished run again, and says what is missing elsewhere."""

import json

from reliab.app.cli import run


def test_a_folder_without_a_run_is_explained(tmp_path, capsys):
    assert run(["report", str(tmp_path)]) == 2
    assert "run" in capsys.readouterr().err


def test_the_report_is_named(tmp_path, monkeypatch, capsys):
    def written(folder, setting):
        assert setting.title == "Ours"
        return folder / "report.pdf"

    monkeypatch.setattr("reliab.app.api.studies.write_report", written)
    assert run(["report", str(tmp_path), "--title", "Ours", "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "folder": str(tmp_path),
        "report": str(tmp_path / "report.pdf"),
    }
