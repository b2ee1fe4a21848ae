import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from reliab.app.cli.motions import app
from reliab.core.errors import InputError
from reliab.motions.loading import load_motions

AT2 = """PEER NGA STRONG MOTION DATABASE RECORD
Nowhere-01, 10/18/1989, Testing Station, {component}
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      6, DT=   .0050 SEC,
   .1000000E+00  -.2000000E+00   .3000000E+00  -.4000000E+00   .5000000E+00
  -.6000000E-01
"""


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Two sound records of one event."""
    folder = tmp_path / "records"
    folder.mkdir()
    for component in (90, 180):
        record = AT2.replace(".6000000E-01", f".{component:03}0000E-01").format(component=component)
        (folder / f"N{component}.AT2").write_text(record)
    return folder


@pytest.fixture
def faulty(folder: Path) -> Path:
    """The same with two faulty records."""
    (folder / "cut[1].AT2").write_text(AT2.replace("      6", "      9"))
    (folder / "empty.AT2").write_text("")
    return folder


def test_list_shows_every_motion_with_its_event(folder: Path) -> None:
    result = run("list", folder)
    assert result.exit_code == 0
    assert re.search(r"2 motions from 1 event\b", result.stdout)
    assert "N90" in result.stdout
    assert "0.5000" in result.stdout


def test_list_names_omitted_records(faulty: Path) -> None:
    (faulty / "slow.txt").write_text("# dt: 10 s\n# units: g\n0.1\n-0.2\n")
    (faulty / "strange.v9").write_text("no record")
    result = run("list", faulty)
    assert result.exit_code == 0
    assert "2 motions from 1 event" in result.stdout
    assert "Left out: empty.AT2, line 1: The file is empty" in result.stdout
    assert (
        "Left out: slow.txt, line 1: Implausible time step: those of records are 0.0005 to 0.1 s"
        in result.stdout
    )
    assert "confirm it with --time-step" in result.stdout
    assert "confirm it with --time-step" in " ".join(run("check", faulty / "slow.txt").stdout.split())
    assert "Left out: cut[1].AT2, line 6: Fewer samples than the header states" in result.stdout
    assert "strange.v9: an unknown format" in result.stdout
    content = json.loads(run("list", faulty, "--json", "-").stdout)
    assert [row["motion"] for row in content["motions"]] == ["N180", "N90"]
    names = [Path(fault["file"]).name for fault in content["faults"]]
    assert sorted(names) == ["cut[1].AT2", "empty.AT2", "slow.txt"]
    assert [Path(fault["file"]).name for fault in content["skipped"]] == ["strange.v9"]


def test_list_of_nothing_but_bad_records_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "slow.txt").write_text("# dt: 10 s\n# units: g\n0.1\n-0.2\n")
    result = run("list", tmp_path)
    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith(f"{tmp_path / 'slow.txt'}, line 1: ")


def test_list_has_stable_keys_in_json(folder: Path) -> None:
    result = run("list", folder, "--json", "-")
    rows = json.loads(result.stdout)["motions"]
    assert [row["motion"] for row in rows] == ["N180", "N90"]
    assert set(rows[0]) == {
        *("motion", "event", "set", "time_step", "samples", "duration", "pga_g"),
        *("arias_intensity", "significant_duration", "mean_period", "checksum"),
    }
    assert rows[0]["samples"] == 6
    assert rows[0]["duration"] == pytest.approx(0.025)
    assert rows[0]["pga_g"] == pytest.approx(0.5)
    assert rows[0]["checksum"] == load_motions(folder)[0].checksum


def test_json_can_go_to_a_file_beside_the_table(folder: Path, tmp_path: Path) -> None:
    result = run("list", folder, "--json", tmp_path / "out.json")
    assert "2 motions" in result.stdout
    assert len(json.loads((tmp_path / "out.json").read_text())["motions"]) == 2


def test_an_unwritable_json_file_is_explained(folder: Path, tmp_path: Path) -> None:
    result = run("list", folder, "--json", tmp_path / "gone" / "out.json")
    assert isinstance(result.exception, InputError)
    assert "Cannot write the JSON file" in str(result.exception)


def test_sets_are_chosen_by_name(folder: Path) -> None:
    (folder / "catalog.csv").write_text("motion,set,file\na,near,N90.AT2\nb,held_out,N180.AT2\n")
    assert [row["motion"] for row in json.loads(run("list", folder, "--json", "-").stdout)["motions"]] == [
        "a"
    ]
    result = run("list", folder, "--sets", "near", "--sets", "held_out", "--json", "-")
    assert [row["motion"] for row in json.loads(result.stdout)["motions"]] == ["a", "b"]


def test_a_missing_source_is_bad_input() -> None:
    result = run("list", "nowhere")
    assert isinstance(result.exception, InputError)


def test_check_of_sound_records_says_so(folder: Path) -> None:
    result = run("check", folder)
    assert (result.exit_code, result.stdout) == (0, "2 records, no faults.\n")
    assert json.loads(run("check", folder, "--json", "-").stdout) == {"records": 2, "faults": [], "notes": []}


def test_check_shows_all_faults_and_exits_with_two(faulty: Path) -> None:
    result = run("check", faulty)
    assert result.exit_code == 2
    assert "2 faults in 2 files" in result.stdout
    words = " ".join(result.stdout.split())
    assert "empty" in words
    assert "cut" in words


def test_one_fault_of_one_file_is_counted_in_the_singular(folder: Path) -> None:
    (folder / "empty.AT2").write_text("")
    assert re.search(r"1 fault in 1 file\b", run("check", folder).stdout)


def test_check_reports_faults_in_json_with_stable_keys(faulty: Path) -> None:
    result = run("check", faulty, "--json", "-")
    assert result.exit_code == 2
    content = json.loads(result.stdout)
    assert content["records"] == 3
    assert [set(fault) for fault in content["faults"]] == [{"file", "line", "rule", "value", "remedy"}] * 2
    assert content["faults"][0] == {
        "file": str(faulty / "cut[1].AT2"),
        "line": 6,
        "rule": "Fewer samples than the header states",
        "value": "6 of 9",
        "remedy": "The file was cut short: export or download it again",
    }


def test_check_takes_several_sources_and_built_in_suites(folder: Path) -> None:
    result = run("check", folder, folder / "N90.AT2", "synthetic", "--json", "-")  # each by itself
    assert json.loads(result.stdout) == {"records": 103, "faults": [], "notes": []}


def test_import_writes_a_readable_suite(folder: Path, tmp_path: Path) -> None:
    result = run("import", folder, "--out", tmp_path / "suite")
    assert result.exit_code == 0
    assert re.search(r"2 motions from 1 event\b", result.stdout)
    assert list(load_motions(tmp_path / "suite")) == list(load_motions(folder))


def test_import_declares_units_step_and_event(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("10\n-20\n")
    result = run(
        *("import", tmp_path / "a.txt", "--out", tmp_path / "suite", "--units", "gal"),
        *("--time-step", "0.02", "--event", "KOBE", "--json", "-"),
    )
    assert json.loads(result.stdout) == {
        "catalogue": str(tmp_path / "suite/catalog.csv"),
        "motions": ["a"],
        "events": 1,
        "skipped": [],
    }
    (motion,) = load_motions(tmp_path / "suite")
    assert (motion.event, motion.time_step, motion.peak_acceleration) == ("KOBE", 0.02, 0.2)


def test_import_does_not_overwrite(folder: Path) -> None:
    result = run("import", folder, "--out", folder)
    assert isinstance(result.exception, InputError)
    assert "is not empty" in str(result.exception)


def test_synthesize_writes_a_suite_of_its_own(tmp_path: Path) -> None:
    assert run("synthesize", "--out", tmp_path / "a", "--count", 4).exit_code == 0
    assert run("synthesize", "--out", tmp_path / "b", "--count", 4, "--seed", 7).exit_code == 0
    first, second = load_motions(tmp_path / "a"), load_motions(tmp_path / "b")
    assert len(first) == len(second) == 4
    assert {motion.checksum for motion in first}.isdisjoint(motion.checksum for motion in second)


def test_the_real_records_are_sound(real_motions_folder: Path) -> None:
    result = run("check", real_motions_folder)
    assert (result.exit_code, result.stdout) == (0, "101 records, no faults.\n")
