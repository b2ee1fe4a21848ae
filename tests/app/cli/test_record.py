"""`reliab record`: what it prints, writes and examines."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from reliab.app.cli import run

sys.path.insert(0, str(Path(__file__).parents[2] / "recordings"))

from layouts import COMMAND, MEASURED, TIME, csv_with_units_in_brackets, dspace, tdms


def test_a_record_is_written_shown_and_sound(tmp_path, capsys):
    source, out = csv_with_units_in_brackets(tmp_path), tmp_path / "t.nc"
    assert run(["record", str(source), "--out", str(out), "--attribute", "grade=S355"]) == 0
    output = capsys.readouterr().out
    assert "Dis command (mm)" in output
    assert "Not used: Voltage command" in output
    assert run(["record", str(out), "--check", "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out) == {str(out): []}


def test_several_files_become_a_folder_of_records(tmp_path, capsys):
    sources = [str(dspace(tmp_path)), str(tdms(tmp_path))]
    assert run(["record", *sources, "--out", str(tmp_path / "records"), "--json", "-"]) == 0
    assert len(json.loads(capsys.readouterr().out)) == 2
    assert sorted(path.name for path in (tmp_path / "records").iterdir()) == ["rths_001.nc", "t.nc"]


def test_no_record_is_written_over_another_of_the_same_call(tmp_path, capsys):
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        csv_with_units_in_brackets(tmp_path / name)
    sources = sorted(map(str, tmp_path.glob("*/*.csv")))
    assert len(sources) == 2
    assert run(["record", *sources, "--out", str(tmp_path / "records")]) == 2
    assert "have the same name" in capsys.readouterr().err
    assert not (tmp_path / "records").exists()


def test_a_recording_is_not_overwritten_by_its_record(tmp_path, capsys):
    source = csv_with_units_in_brackets(tmp_path)
    original = source.read_bytes()
    assert run(["record", str(source), "--csv", str(source)]) == 2
    assert "would overwrite a file that the command reads; found --csv" in capsys.readouterr().err
    assert source.read_bytes() == original


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (["--check"], 2),
        (["--check", "--rig", "3"], 2),
        (["--attribute", "grade"], 2),
        (["--units", "kN"], 2),
        (["--f", "0"], 2),
        (["--xi", "1.5"], 2),
        (["--mass", "-3"], 2),
    ],
)
def test_unanswerable_questions_are_refused(tmp_path, arguments, code, capsys):
    source = csv_with_units_in_brackets(tmp_path)
    assert run(["record", str(source), *arguments]) == code
    assert capsys.readouterr().err.startswith("Error: ")


def test_the_deciding_option_is_named(tmp_path, capsys):
    table = np.column_stack([TIME, COMMAND, np.roll(COMMAND, 3), MEASURED])
    np.savetxt(tmp_path / "t.csv", table, delimiter=",", header="Time,Target,Command,Measured", comments="")
    assert run(["assess", str(tmp_path / "t.csv"), "--f", "1", "--xi", "0.02"]) == 2
    assert "'Target' and 'Command'. Choose one with --command." in capsys.readouterr().err
