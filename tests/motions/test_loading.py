"""Motions from files, folders and suites."""

import tracemalloc
from collections.abc import Callable
from pathlib import Path

import pytest

from reliab.core.errors import InputError
from reliab.motions.checking import inspect
from reliab.motions.loading import UnreadFileWarning, load_motions

Write = Callable[[str, str | bytes], Path]


@pytest.fixture
def folder(records: dict[str, str], write: Write) -> Path:
    """A catalogue of four motions in three sets, one of them held out."""
    for name in "abcd":
        write(f"{name}.AT2", records["record.AT2"])
    rows = "a,near,a.AT2\nb,far,b.AT2\nc,held_out,c.AT2\nd,,d.AT2\n"
    return write("catalog.csv", f"motion,set,file\n{rows}").parent


def test_the_held_out_set_is_used_only_when_it_is_named(folder: Path) -> None:
    assert load_motions(folder).names == ("a", "b", "d")
    assert load_motions(folder, sets=["held_out"]).names == ("c",)
    assert load_motions(folder, sets=["near", "held_out"]).names == ("a", "c")


def test_an_unknown_set_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match=r"No set 'fra' in the suite. Choose for example far"):
        load_motions(folder, sets=["fra"])


def test_a_suite_of_nothing_but_held_out_motions_is_refused(records: dict[str, str], write: Write) -> None:
    write("a.AT2", records["record.AT2"])
    folder = write("catalog.csv", "motion,set,file\na,held_out,a.AT2\n").parent
    with pytest.raises(InputError, match="Name the set held_out to use it"):
        load_motions(folder)


def test_sources_are_joined_in_order(folder: Path, records: dict[str, str], write: Write) -> None:
    second = write("elsewhere/z.csv", records["record.csv"])
    assert load_motions(second, folder).names == ("z", "a", "b", "d")
    assert load_motions(str(second)).names == ("z",)


def test_motions_of_one_name_cannot_be_joined(folder: Path) -> None:
    with pytest.raises(InputError, match="Several motions have the same name; found a"):
        load_motions(folder, folder / "a.AT2")


def test_missing_source_is_explained() -> None:
    with pytest.raises(
        InputError, match=r"nowhere/at_all not found. Name a file, a folder or a built-in suite"
    ):
        load_motions("nowhere/at_all")
    with pytest.raises(InputError, match="a file, a folder or a built-in suite"):
        load_motions("long" * 1000)
    with pytest.raises(InputError, match="No ground motions given"):
        load_motions()


def test_records_are_read_when_asked_for(folder: Path) -> None:
    suite = load_motions(folder)
    (folder / "b.AT2").write_text("damaged later")
    assert suite[0].name == "a"
    with pytest.raises(InputError, match=r"b.AT2"):
        suite[1]


@pytest.mark.slow
def test_ten_thousand_motions_stream_in_the_memory_of_one(write: Write) -> None:
    """Some of them, each of 40 kB: 8 MB if they were kept."""
    path = write("a.txt", "# units: g\n# dt = 0.01\n" + "1\n-1\n" * 2500)
    rows = "".join(f"m{number},{path.name}\n" for number in range(10_000))
    folder = write("catalog.csv", f"motion,file\n{rows}").parent
    suite = load_motions(folder)
    tracemalloc.start()
    for motion in suite[:200]:
        assert motion.acceleration.size == 5000
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(suite) == 10_000
    assert peak < 3e6


def test_the_built_in_suite_is_loaded_by_name() -> None:
    suite = load_motions("synthetic")
    assert len(suite) == 100
    assert len(set(suite.events)) == 50
    assert suite[0].name == suite.names[0]


@pytest.mark.parametrize("time_step", [0.0, -0.01, float("inf"), float("nan")])
def test_non_positive_step_is_refused(folder: Path, time_step: float) -> None:
    with pytest.raises(InputError, match=r"time step must be between .* found"):
        load_motions(folder, time_step=time_step)


@pytest.fixture
def at2(records: dict[str, str]) -> str:
    return records["record.AT2"]


def test_every_record_below_a_folder_is_named_after_its_path(
    at2: str, records: dict[str, str], write: Write, tmp_path: Path
) -> None:
    write("KOBE/NIS000.AT2", at2)
    write("KOBE/NIS090.at2", at2)
    write("top.csv", records["record.csv"])
    write("XYZ.NS", records["record.NS"])
    write("XYZ.EW", records["record.NS"])
    suite = load_motions(tmp_path)
    assert suite.names == ("KOBE/NIS000", "KOBE/NIS090", "XYZ.EW", "XYZ.NS", "top")
    assert [motion.name for motion in suite] == list(suite.names)
    assert [motion.event for motion in suite] == list(suite.events)


def test_records_differing_in_suffix_keep_it(
    at2: str, records: dict[str, str], write: Write, tmp_path: Path
) -> None:
    write("a.AT2", at2)
    write("a.csv", records["record.csv"])
    write("b.AT2", at2)
    assert load_motions(tmp_path).names == ("a.AT2", "a.csv", "b")


def test_files_without_records_are_skipped(at2: str, write: Write, tmp_path: Path) -> None:
    write("a.AT2", at2)
    write("sub/.hidden.AT2", b"")
    write(".git/b.AT2", b"")
    write("README.md", "1 2 3")
    write("README.txt", "Obtained from PEER")
    write("_readme.txt", "Obtained from PEER")
    write("LICENSE", "none")
    write("figure.png", b"\x89PNG\x00")
    write("notes.pdf", b"%PDF")
    write("sub/catalog.csv", "nothing")
    assert load_motions(tmp_path).names == ("a",)
    assert inspect(tmp_path).faults == []


def test_a_record_is_found_whatever_its_ending(at2: str, write: Write, tmp_path: Path) -> None:
    write("record.data", at2)
    write("RECORD", at2)
    assert load_motions(tmp_path).names == ("RECORD", "record.data")


def test_components_share_an_event_only_if_their_headers_say_so(
    at2: str, records: dict[str, str], write: Write, tmp_path: Path
) -> None:
    write("a.AT2", at2)
    write("b.AT2", at2.replace("Testing Station, 90", "Another Station, 180"))
    write("c.AT2", at2.replace("10/18/1989", "10/19/1989"))
    write("d.AT2", at2.replace("Nowhere-01, 10/18/1989", "Nowhere"))
    write("e.csv", records["record.csv"])
    write("f.csv", "# event: NOWHERE-01 1989-10-18\n" + records["record.csv"])
    single, second = "NOWHERE-01 1989-10-18", "NOWHERE-01 1989-10-19"
    assert load_motions(tmp_path).events == (single, single, second, "d", "e", single)


def test_broken_record_is_not_skipped_silently(at2: str, write: Write, tmp_path: Path) -> None:
    write("a.AT2", at2)
    path = write("b.AT2", b"")
    with pytest.raises(InputError, match=rf"{path}, line 1: The file is empty"):
        load_motions(tmp_path)


def test_folder_reports_skipped_files_with_reasons(at2: str, write: Write, tmp_path: Path) -> None:
    write("a.AT2", at2)
    write("sub/b.mat", b"MATLAB 5.0 MAT-file")
    write("c.v9", "some words\nand more\n")
    write("d.bin", b"\x00\x01\x02")
    write("e.xyz", "0.1\n0.2\n")
    write("f.old", "")
    write("figure.png", b"\x89PNG\x00")
    reasons = {
        "c.v9": "an unknown format",
        "d.bin": "an unknown format",
        "e.xyz": "numbers without a known header or the ending of a text record",
        "f.old": "an empty file",
        "b.mat": "a MATLAB file",
    }
    inspection = inspect(tmp_path)
    assert inspection.faults == []
    assert {Path(note.file).name: note.value for note in inspection.notes} == reasons
    with pytest.warns(UnreadFileWarning, match=r"skipped c\.v9 \(an unknown format\), .* and 2 more"):
        assert load_motions(tmp_path).names == ("a",)


def test_a_folder_without_records_is_explained(write: Write, tmp_path: Path) -> None:
    write("README.md", "none")
    with pytest.raises(InputError, match="No records in this folder"):
        load_motions(tmp_path)
    assert [fault.rule for fault in inspect(tmp_path).faults] == ["No records found"]
