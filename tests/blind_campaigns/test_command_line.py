"""A batch goes on where one seed cannot be drawn."""

import pytest

from blind_campaigns import command_line


@pytest.mark.slow
def test_undrawable_seed_is_skipped_and_said(tmp_path, monkeypatch, capsys):
    draw = command_line.generate

    def sometimes(seed, folder, *, options):
        if seed % 2 == 0:
            raise RuntimeError("no laboratory could show it")
        return draw(seed, folder, options=options)

    monkeypatch.setattr(command_line, "generate", sometimes)
    arguments = ["--seed", "0", "--count", "2", "--kind", "none", "--observation", "specimen_only"]
    command_line.main([*arguments, "--out", str(tmp_path)])
    lines = capsys.readouterr().out.splitlines()
    assert "skipped: no laboratory could show it" in lines[0]
    assert "none" in lines[1]
    assert [path.name for path in (tmp_path / "labels").iterdir()] == ["campaign_0001.json"]
