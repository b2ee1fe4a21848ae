"""Nothing is read or written outside of the desk's folder."""

import importlib
import zipfile
from pathlib import Path

import pytest

from reliab.core.errors import InputError
from reliab.core.files import LIMITS, FileLimits
from reliab.desk.folder import DeskFolder, safe_name, unpack_archive

FOLDER = importlib.import_module("reliab.desk.folder")


@pytest.mark.parametrize(
    "name",
    [
        "../../x.csv",
        "/etc/passwd",
        "C:\\x\\y.csv",
        "..",
        "",
        ".",
        "a\0b.csv",
        "x" * 400 + ".csv",
        "<b>.csv",
        "\ud800.csv",
    ],
)
def test_dropped_files_lie_in_the_working_folder_whatever_their_names(folder, name):
    path = folder.keep(name, b"1")
    assert path.resolve().is_relative_to(folder.work)
    assert path.read_bytes() == b"1"
    assert len(path.name) <= 120


def test_long_names_keep_their_ending():
    assert safe_name("x" * 400 + ".csv").endswith(".csv")


def test_oversized_files_are_refused_as_on_the_command_line(folder, monkeypatch):
    small = FileLimits(bytes=3, remedy="Cut it")
    monkeypatch.setattr(FOLDER, "LIMITS", {**LIMITS, "test": small})
    with pytest.raises(InputError, match="larger than 3e-06 MB"):
        folder.keep("test.csv", b"1234")


@pytest.mark.parametrize("name", ["../other", "/etc", "a/../../b", "link"])
def test_names_leading_out_of_the_folder_are_refused_with_a_remedy(folder, name, tmp_path_factory):
    (folder.path / "link").symlink_to(tmp_path_factory.mktemp("elsewhere"))
    with pytest.raises(InputError, match="reliab desk FOLDER"):
        folder.within(name)


def test_files_are_offered_by_ending_and_folders_by_content(folder):
    (folder.path / "a" / "rig" / "tests").mkdir(parents=True)
    (folder.path / "a" / "rig" / "tests" / "1.json").write_text("{}")
    (folder.path / "a" / "run.csv").write_text("1")
    (folder.path / "campaign.toml").write_text("")
    folder.keep("dropped.csv", b"1")
    assert folder.list_files(".csv") == [str(Path("a", "run.csv"))]
    assert folder.list_files(holding="tests/*.json") == [str(Path("a", "rig"))]
    assert folder.list_files(holding="campaign.toml") == ["."]


def test_the_working_folder_goes_with_the_desk(tmp_path):
    desk_folder = DeskFolder.open_folder(tmp_path)
    desk_folder.keep("test.csv", b"1")
    desk_folder.close()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("path", ["nothing_here", __file__])
def test_a_missing_folder_is_refused(path, tmp_path):
    with pytest.raises(InputError, match="The desk works in a folder"):
        DeskFolder.open_folder(tmp_path / path)


def zip_entries(folder, entries):
    path = folder.new_place() / "campaign.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for name, content in entries.items():
            archive.writestr(name, content)
    return path


def test_a_campaign_is_found_in_its_archive(folder):
    place = unpack_archive(zip_entries(folder, {"rig/campaign.toml": "x", "rig/test.csv": "1"}))
    assert sorted(path.name for path in place.iterdir()) == ["campaign.toml", "test.csv"]


@pytest.mark.parametrize("name", ["../x.csv", "/x.csv", "a/../../x.csv", "..\\x.csv", "C:x.csv"])
def test_archives_leading_elsewhere_are_refused_before_writing(folder, name):
    archive = zip_entries(folder, {"campaign.toml": "x", name: "1"})
    with pytest.raises(InputError, match="must lie in it"):
        unpack_archive(archive)
    assert [path.name for path in archive.parent.iterdir()] == ["campaign.zip"]


def test_archives_with_too_many_or_too_large_files_are_refused(folder, monkeypatch):
    monkeypatch.setattr(FOLDER, "_MOST_FILES", 2)
    with pytest.raises(InputError, match="found 3 files"):
        unpack_archive(zip_entries(folder, dict.fromkeys("abc", "1")))
    monkeypatch.setattr(FOLDER, "LIMITS", {"test": FileLimits(bytes=1000, remedy="Cut it")})
    with pytest.raises(InputError, match="at most; found"):
        unpack_archive(zip_entries(folder, {"a": "0" * 2000}))


def test_an_invalid_archive_is_refused(folder):
    with pytest.raises(InputError, match="must be a zip"):
        unpack_archive(folder.keep("campaign.zip", b"PK\3\4 nothing"))
