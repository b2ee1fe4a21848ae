import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, strategies as st

from reliab.core.errors import InputError
from reliab.motions.catalogue import write_motion, write_suite
from reliab.motions.checking import inspect
from reliab.motions.loading import load_motions, read_motion
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite

LABELS = st.text("abcXYZ019 /.,;-_()'\"äß", max_size=12).map(lambda text: " ".join(text.split()))


def motion(name: str = "a", **changes: object) -> Motion:
    arguments: dict[str, object] = {"acceleration": [0.1, -1.0 / 3.0, 1e-300], "time_step": 1 / 150} | changes
    return Motion(name=name, **arguments)


@given(
    samples=st.lists(st.floats(-49.0, 49.0), min_size=2, max_size=30).filter(any),
    time_step=st.floats(1e-5, 10.0),
    name=LABELS.filter(bool),
    event=LABELS,
)
def test_a_written_suite_reads_back_bit_by_bit(
    samples: list[float], time_step: float, name: str, event: str
) -> None:
    original = Motion(
        name=name, acceleration=np.array(samples), time_step=time_step, event=event, set_name="s"
    )
    with tempfile.TemporaryDirectory() as folder:
        write_suite(MotionSuite.from_motions([original]), Path(folder) / "suite")
        (second,) = load_motions(Path(folder) / "suite")
    assert second == original
    assert second.acceleration.tobytes() == original.acceleration.tobytes()


def test_a_written_motion_reads_back_without_its_catalogue(tmp_path: Path) -> None:
    original = motion("KOBE", event="of units: g")
    write_motion(original, tmp_path / "KOBE.txt")
    assert read_motion(tmp_path / "KOBE.txt") == original


def test_names_sharing_a_file_name_make_two_files(tmp_path: Path) -> None:
    names = ["K/1", "K_1", "k 1", "..", "ÄÖ", "ß"]
    write_suite(MotionSuite.from_motions(map(motion, names)), tmp_path / "out")
    suite = load_motions(tmp_path / "out")
    assert suite.names == tuple(names)
    files = [path for path in (tmp_path / "out").rglob("*.txt") if path.is_file()]
    assert len({path.as_posix().lower() for path in files}) == len(names)
    assert inspect(tmp_path / "out").faults == []


def test_one_event_can_replace_all(tmp_path: Path) -> None:
    write_suite(MotionSuite.from_motions([motion("a"), motion("b")]), tmp_path / "out", event="KOBE")
    assert load_motions(tmp_path / "out").events == ("KOBE", "KOBE")
    assert read_motion(tmp_path / "out/motions/a.txt").event == "KOBE"


def test_an_empty_folder_is_filled_and_another_is_left_alone(tmp_path: Path) -> None:
    suite = MotionSuite.from_motions([motion()])
    (tmp_path / "empty").mkdir()
    assert write_suite(suite, tmp_path / "empty").is_file()
    (tmp_path / "file").write_text("x")
    for existing in ("empty", "file"):
        with pytest.raises(InputError, match="is not empty"):
            write_suite(suite, tmp_path / existing)


def test_failed_writing_leaves_no_files(tmp_path: Path) -> None:
    (tmp_path / "bad.AT2").write_text("NPTS= 3, DT= .01\n0.1 0.2 nan\n")
    write_motion(motion(), tmp_path / "good.txt")
    suite = load_motions(tmp_path / "good.txt", tmp_path / "bad.AT2")
    with pytest.raises(InputError, match="finite"):
        write_suite(suite, tmp_path / "out")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.AT2", "good.txt"]


def test_uncreatable_folder_is_explained(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("x")
    with pytest.raises(InputError, match="Cannot write to the folder: Not a directory"):
        write_suite(MotionSuite.from_motions([motion()]), tmp_path / "file" / "out")
    with pytest.raises(InputError, match="no motions to write"):
        write_suite(MotionSuite([]), tmp_path / "out")


def test_names_of_any_length_or_script_become_files_and_stay_names(tmp_path: Path) -> None:
    names = [
        "n" * 10_000,
        "n" * 10_001,
        "../../etc/passwd",
        "..",
        "\u05d6\u05dc \u0627\u0644",
        "[red] \x1b[31m#$<b>",
    ]
    write_suite(MotionSuite.from_motions([motion(name, set_name=name) for name in names]), tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert list(load_motions(tmp_path / "out").names) == [*names[:-1], r"[red] \x1b[31m#$<b>"]


def test_no_file_has_the_name_of_a_device_of_windows(tmp_path: Path) -> None:
    names = ["CON", "aux.1", "LPT1", "console"]
    write_suite(MotionSuite.from_motions([motion(name, set_name="nul") for name in names]), tmp_path / "out")
    files = {path.relative_to(tmp_path / "out").as_posix() for path in (tmp_path / "out").rglob("*/*.txt")}
    assert files == {"_nul/_CON.txt", "_nul/_aux.1.txt", "_nul/_LPT1.txt", "_nul/console.txt"}
    assert list(load_motions(tmp_path / "out").names) == names


@pytest.mark.parametrize("name", ["=HYPERLINK(A1)", "+cmd|x", "-2+3+cmd", "@SUM(1)", "'=1", "-5"])
def test_names_are_no_formulas_in_a_spreadsheet_and_stay_names(tmp_path: Path, name: str) -> None:
    motion = Motion(name=name, event=name, set_name=name, acceleration=np.arange(1.0, 5.0), time_step=0.01)
    catalogue = write_suite(MotionSuite.from_motions([motion]), tmp_path / "suite")
    cells = catalogue.read_text(encoding="utf-8").splitlines()[1].split(",")
    assert not [cell for cell in cells if cell.startswith(("=", "+", "-", "@")) and cell != "-5"]
    (back,) = load_motions(tmp_path / "suite")
    assert (back.name, back.event, back.set_name) == (name, name, name)
