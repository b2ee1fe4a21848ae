"""What Windows forbids is not done there: it is forbidden here, and commands still write their files."""

import contextlib
import errno
import fcntl
import json
import os
from pathlib import Path
from types import SimpleNamespace

import pytest

from reliab.app.cli import run
from reliab.core import files
from reliab.core.files import UNFINISHED, folder_written_whole, write_json_file, written_whole

TEST = ("sample_test", "--f", "1", "--xi", "0.02")


@pytest.fixture
def windows(monkeypatch, tmp_path):
    """No folder is opened, no file open for reading is synchronised, and no open file moves or goes."""
    really = {name: getattr(os, name) for name in ("open", "fsync", "unlink", "replace", "rename")}

    def open_file(path, flags, *positional, **options):
        if Path(path).is_dir() and Path(path).is_relative_to(tmp_path):
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return really["open"](path, flags, *positional, **options)

    def synchronise(descriptor):
        if fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE == os.O_RDONLY:
            raise OSError(errno.EBADF, "Bad file descriptor")
        really["fsync"](descriptor)

    def refuse_open_files(name):
        def as_on_windows(path, *positional, **options):
            if any(file.is_relative_to(os.path.realpath(path)) for file in open_below(tmp_path)):
                raise PermissionError(errno.EACCES, "used by another process", str(path))
            return really[name](path, *positional, **options)

        return as_on_windows

    monkeypatch.setattr(files, "sys", SimpleNamespace(platform="win32"))
    monkeypatch.setattr(os, "open", open_file)
    monkeypatch.setattr(os, "fsync", synchronise)
    for name in ("unlink", "replace", "rename"):
        monkeypatch.setattr(os, name, refuse_open_files(name))


def open_below(folder):
    for descriptor in Path("/proc/self/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # that of the list itself
            if (file := descriptor.readlink()).is_relative_to(folder):
                yield file


pytestmark = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="asks Linux for open files")


@pytest.mark.usefixtures("windows")
def test_a_file_is_written_and_written_again(tmp_path):
    for number in (1, 2):
        write_json_file({"number": number}, tmp_path / "a.json")
    assert json.loads((tmp_path / "a.json").read_text(encoding="utf-8")) == {"number": 2}
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


@pytest.mark.usefixtures("windows")
def test_a_folder_is_written(tmp_path):
    with folder_written_whole(tmp_path / "suite") as temporary:
        (temporary / "a.csv").write_text("1", encoding="utf-8")
    assert [path.name for path in tmp_path.rglob("*")] == ["suite", "a.csv"]


@pytest.mark.usefixtures("windows")
def test_leftovers_go_and_unfinished_files_stay(tmp_path):
    (tmp_path / f"{UNFINISHED}1.json").write_text("left", encoding="utf-8")
    with written_whole(tmp_path / "a.json") as temporary:
        assert [path.name for path in tmp_path.iterdir()] == [temporary.name]
        write_json_file({}, tmp_path / "b.json")
        temporary.write_text("{}", encoding="utf-8")
    assert {path.name for path in tmp_path.iterdir()} == {"a.json", "b.json"}


@pytest.mark.default_cases(2)
@pytest.mark.usefixtures("windows")
@pytest.mark.parametrize(
    "arguments",
    [
        ("assess", *TEST, "--json", "verdict.json", "--out", "verdicts.csv"),
        ("criterion", "--ellipses", "real_suite", "--f", "1", "--xi", "0.02", "--out", "criterion.json"),
        ("samples",),
        ("record", "sample_test", "--out", "test.nc"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_command_writes_its_files(arguments, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(list(arguments)) == 0
    assert not list(tmp_path.rglob(f"{UNFINISHED}*"))
