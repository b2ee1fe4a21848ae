"""Only ordinary files are read, and a file is never half-written."""

import os
import resource
import signal
import subprocess
import sys

import pytest

from reliab.core.errors import InputError
from reliab.core.files import (
    UNFINISHED,
    decoding,
    folder_written_whole,
    lock_for_writing,
    ordinary,
    written_whole,
)


def test_a_pipe_and_a_device_are_no_ordinary_files(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("/dev/zero")
    for path, kind in ((tmp_path / "pipe", "a pipe"), (tmp_path / "link", "a device")):
        with pytest.raises(OSError, match=f"{kind} instead of an ordinary file"):
            ordinary(path)


def test_files_and_missing_files_are_left_to_the_reader(tmp_path):
    assert ordinary(tmp_path / "missing") == tmp_path / "missing"
    assert ordinary(str(tmp_path)) == tmp_path


def test_impossible_file_names_are_system_errors():
    with pytest.raises(OSError, match="null"):
        ordinary("a\0b")


def test_errors_of_decoders_become_a_rule_and_ours_pass():
    with pytest.raises(InputError, match=r"^a\.h5: It must be sound; found bad node\. Mend it\.$"):
        fail(RuntimeError("bad node\nand more"))
    with pytest.raises(InputError, match="found more data than fit in memory"):
        fail(MemoryError())
    with pytest.raises(InputError, match="found KeyError"):
        fail(KeyError())
    with pytest.raises(InputError, match=r"^Ours\.$"):
        fail(InputError("Ours"))


def fail(error):
    with decoding("It must be sound", remedy="Mend it", where="a.h5"):
        raise error


def test_a_file_appears_when_it_is_complete(tmp_path):
    place = tmp_path / "a.txt"
    place.write_text("before")
    with written_whole(place) as temporary:
        temporary.write_text("after")
        assert place.read_text() == "before"
    assert place.read_text() == "after"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_a_failed_writer_leaves_the_earlier_file(tmp_path):
    place = tmp_path / "a.txt"
    place.write_text("before")
    with pytest.raises(RuntimeError), written_whole(place) as temporary:
        interrupt(temporary)
    assert place.read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def interrupt(unfinished):
    unfinished.write_text("half")
    raise RuntimeError


def test_a_quota_leaves_the_file_before(tmp_path):
    place = tmp_path / "a.txt"
    place.write_text("before")
    original = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, original[1]))
        with pytest.raises(OSError, match="too large"), written_whole(place) as temporary:
            temporary.write_text("x" * 5000)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, original)
        signal.signal(signal.SIGXFSZ, handler)
    assert place.read_text() == "before"


def test_a_link_stays_a_link_and_its_file_is_replaced(tmp_path):
    (tmp_path / "data.txt").write_text("before")
    (tmp_path / "link.txt").symlink_to("data.txt")
    with written_whole(tmp_path / "link.txt") as temporary:
        temporary.write_text("after")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "data.txt").read_text() == "after"


def test_a_device_is_written_to_as_it_is():
    with written_whole("/dev/null") as temporary:
        assert str(temporary) == "/dev/null"
        temporary.write_text("nothing")


def test_temporary_files_keep_the_ending_of_the_name(tmp_path):
    with written_whole(tmp_path / "a.svg") as temporary:
        assert temporary.suffix == ".svg"
        assert temporary.name.startswith(UNFINISHED)
        temporary.write_text("")


def test_the_next_writer_removes_abandoned_files(tmp_path):
    script = (
        "import os, signal, sys\n"
        "from reliab.core.files import folder_written_whole, written_whole\n"
        "from pathlib import Path\n"
        "with folder_written_whole(Path(sys.argv[1])) as folder, written_whole(sys.argv[2]) as file:\n"
        "    (folder / 'a').write_text('half')\n"
        "    file.write_text('half')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    command = [sys.executable, "-c", script, tmp_path / "suite", tmp_path / "a.txt"]
    process = subprocess.run(command, check=False)  # noqa: S603 - our own interpreter
    assert process.returncode == -signal.SIGKILL
    assert len([path for path in tmp_path.iterdir() if path.name.startswith(UNFINISHED)]) == 2
    with written_whole(tmp_path / "b.txt") as temporary:
        temporary.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["b.txt"]


def test_files_of_a_running_writer_are_kept(tmp_path):
    with written_whole(tmp_path / "a.txt") as first, folder_written_whole(tmp_path / "suite") as folder:
        (folder / "one").write_text("1")
        with written_whole(tmp_path / "b.txt") as second:
            second.write_text("b")
        first.write_text("a")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.txt", "b.txt", "suite"]
    assert (tmp_path / "suite" / "one").read_text() == "1"


def test_links_and_pipes_of_such_a_name_are_not_touched(tmp_path):
    (tmp_path / "precious").write_text("data")
    (tmp_path / f"{UNFINISHED}link").symlink_to("precious")
    os.mkfifo(tmp_path / f"{UNFINISHED}pipe")
    with written_whole(tmp_path / "a.txt") as temporary:
        temporary.write_text("a")
    assert len(list(tmp_path.iterdir())) == 4
    assert (tmp_path / "precious").read_text() == "data"


def test_of_two_writers_of_a_folder_the_second_is_refused_and_the_first_stays(tmp_path):
    place = tmp_path / "suite"
    with pytest.raises(OSError, match="not empty"), folder_written_whole(place) as second:
        overtaken(second, place)
    assert (place / "a").read_text() == "first"
    assert [path.name for path in tmp_path.iterdir()] == ["suite"]


def overtaken(second, place):
    (second / "a").write_text("second")
    with folder_written_whole(place) as first:
        (first / "a").write_text("first")


def test_one_process_writes_to_a_folder(tmp_path):
    with (
        lock_for_writing(tmp_path / "run", "Only one may"),
        pytest.raises(InputError, match=r"Only one may; found .* in use by another process"),
        lock_for_writing(tmp_path / "run", "Only one may"),
    ):
        pass
    with lock_for_writing(tmp_path / "run", "Only one may"):
        pass
