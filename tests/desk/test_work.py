"""The desk gives the numbers of the command line, whatever the layout of a file, and keeps what it says."""

import json
from pathlib import Path

import layouts
import numpy as np
import pandas as pd
import pytest

from reliab.app.cli import run
from reliab.core.errors import InputError
from reliab.core.shipped import shipped
from reliab.desk.verdict_view import interval_html
from reliab.desk.work import compare, judge, look_at, points_of_rig

SAMPLE = shipped("datasets", "sample_test/test.csv")
FIRST = (layouts.mts_793, layouts.tdms)
CASES = [pytest.param(write, marks=[] if write in FIRST else pytest.mark.slow) for write in layouts.LAYOUTS]


@pytest.mark.default_cases(2)
@pytest.mark.parametrize("write", CASES)
def test_a_dropped_file_of_any_layout_gives_the_numbers_of_the_command_line(folder, tmp_path, capsys, write):
    path = write(tmp_path)
    uploaded = folder.keep(path.name, path.read_bytes())
    look = look_at(str(uploaded))
    assert {channel["channel"] for channel in look.channels} >= {"command", "measured"}
    assert look.refusal == ""
    news = []
    results = judge(str(uploaded), str(folder.new_place()), {"f": "1", "xi": "0.02"}, news.append)
    capsys.readouterr()
    assert run(["assess", str(path), "--f", "1", "--xi", "0.02", "--json", "-"]) == 0
    reference = json.loads(capsys.readouterr().out)
    assert json.loads(json.dumps(news[0].content)) == reference
    assert json.loads(Path(results.files["Numbers (JSON)"]).read_text(encoding="utf-8")) == reference


@pytest.mark.slow
def test_an_answer_keeps_its_report_and_files_in_its_folder(folder):
    place = folder.new_place()
    results = judge(str(SAMPLE), str(place), {"f": 1.0, "xi": 0.02}, lambda _news: None)
    assert sorted(path.name for path in place.iterdir()) == ["corrected.csv", "report.pdf", "verdict.json"]
    assert (place / "report.pdf").read_bytes().startswith(b"%PDF")
    assert "What to improve" in results.html


def test_an_unrecognised_file_lists_its_columns(tmp_path):
    path = tmp_path / "test.csv"
    lines = SAMPLE.read_text(encoding="utf-8").splitlines()
    header = next(k for k, line in enumerate(lines) if line.startswith("time_s"))
    path.write_text(
        "\n".join([*lines[:header], "time_s,first,second", *lines[header + 1 :]]), encoding="utf-8"
    )
    look = look_at(str(path))
    assert look.columns == ("time_s", "first", "second")
    assert "first" in look.refusal
    values = tmp_path / "channels.toml"
    values.write_text('[channels.command]\ncolumn = "first"\n[channels.measured]\ncolumn = "second"\n')
    look_again = look_at(str(path), channels=str(values))
    assert [trace.name for trace in look_again.traces] == ["command", "measured"]
    assert look_again.rate == pytest.approx(256.0, rel=1e-6)


def test_an_invalid_test_file_is_refused(tmp_path):
    path = tmp_path / "test.csv"
    path.write_bytes(b"\x7fELF" + bytes(2000))
    with pytest.raises(InputError, match="reliab does not read"):
        look_at(str(path))


@pytest.mark.slow
def test_tests_are_compared_by_their_names(folder):
    place = folder.new_place()
    text = SAMPLE.read_text(encoding="utf-8")
    files = [folder.keep(name, text, place=place) for name in ("none.csv", "adaptive.csv")]
    results = compare(list(map(str, files)), str(folder.new_place()), {"f": "1", "xi": "0.02"})
    assert "none.csv" in results.html
    ranking = json.loads(Path(results.files["Numbers (JSON)"]).read_text(encoding="utf-8"))
    assert {test["file"] for test in ranking["tests"]} == {"none.csv", "adaptive.csv"}


def test_the_tests_of_a_rig_are_points_with_amplitude_and_delay():
    points = points_of_rig(str(shipped("datasets", "sample_rig")))
    assert len(points) == 126
    assert all(0.9 < amplitude < 1.1 and 0.0 < delay < 5.0 for _, amplitude, delay in points)


@pytest.mark.slow
def test_a_frame_takes_the_place_of_f_and_xi_and_its_verdict_is_shown(folder, tmp_path):
    frame = shipped("datasets", "frames/two_actuators.toml")
    time = np.arange(0.0, 20.0, 1.0 / 128.0)
    displacement = {
        f"command_{k}_m": 0.01 * np.sin((3.0 + k) * time) * np.sin(0.15 * time) ** 2 for k in (1, 2)
    }
    late = {name.replace("command", "measured"): np.roll(values, 1) for name, values in displacement.items()}
    path = tmp_path / "two.csv"
    pd.DataFrame({"time_s": time, **displacement, **late}).to_csv(path, index=False)
    news = []
    results = judge(str(path), str(folder.new_place()), {"structure": str(frame)}, news.append)
    assert len(news[0].content["error"]["degrees_of_freedom"]) == 2
    assert interval_html(news[0].content) != ""
    assert "Report (PDF)" in results.files
