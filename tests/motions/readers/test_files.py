"""What no reader can help: files that are missing, locked, empty, binary or of no known format."""

from collections.abc import Callable
from pathlib import Path

import pytest

from reliab.core.errors import InputError
from reliab.motions.loading import read_motion
from reliab.motions.motion import Motion

Write = Callable[[str, str | bytes], Path]


def test_every_format_is_recognised_without_its_ending(records: dict[str, str], write: Write) -> None:
    for number, text in enumerate(records.values()):
        assert isinstance(read_motion(write(f"record-{number}", text)), Motion)


@pytest.mark.parametrize(
    ("content", "rule"),
    [
        (b"", "is empty"),
        (b"  \n\t\r\n", "is empty"),
        (b"\xef\xbb\xbf", "is empty"),
        (b"\x1a", "is empty"),
        (
            b"PK\x03\x04\x14\x00\x00\x00",
            "Not a record that reliab reads; found binary data. Unpack it",
        ),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "Not a record that reliab reads"),
        (b"%PDF-1.4\nsome words\n", "Unknown format of record"),
    ],
)
@pytest.mark.parametrize("name", ["record", "record.bin"])
def test_binary_content_is_explained(name: str, content: bytes, rule: str, write: Write) -> None:
    path = write(name, content)
    with pytest.raises(InputError, match=rule) as caught:
        read_motion(path)
    assert str(caught.value).startswith(f"{path}, line 1: ")


@pytest.mark.parametrize("name", ["a.AT2", "a.NS", "a.V2", "a.V2c", "a.txt"])
@pytest.mark.parametrize("content", [b"", b"\x00\x01\x02\x03"])
def test_empty_and_binary_records_are_explained_in_every_format(
    name: str, content: bytes, write: Write
) -> None:
    with pytest.raises(InputError, match="is empty" if not content else "Not a record that reliab reads"):
        read_motion(write(name, content))


def test_a_missing_file_is_explained(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none.AT2: No such file"):
        read_motion(tmp_path / "none.AT2")


def test_a_folder_is_no_record(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Not a file; found a folder"):
        read_motion(tmp_path)


def test_an_unreadable_file_is_explained(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    path = write("a.txt", "0.1\n")
    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match="Cannot read the file: Permission denied"):
        read_motion(path)


def test_a_path_below_a_file_is_explained(write: Write) -> None:
    with pytest.raises(InputError, match="Cannot read the file: Not a directory"):
        read_motion(write("a.txt", "0.1\n") / "b.txt")


@pytest.mark.default_cases(5)
@pytest.mark.parametrize(
    ("time_step", "units", "rule"),
    [
        *((step, "g", "time step must be between") for step in (0.0, -0.01, float("nan"), float("inf"))),
        (0.01, "ft/s2", "Unknown unit of acceleration; found 'ft/s2'"),
    ],
)
def test_an_impossible_declaration_is_refused(time_step: float, units: str, rule: str, write: Write) -> None:
    with pytest.raises(InputError, match=rule):
        read_motion(write("a.txt", "0.1\n0.2\n"), time_step=time_step, units=units)


def test_a_run_of_bad_lines_is_one_fault(write: Write) -> None:
    text = "# units: g\n# dt = 1\n0.1\nx\ny\nz\n0.2\nnan\n"
    with pytest.raises(InputError, match=r"line 4: .*found 'x', and so on to line 6"):
        read_motion(write("a.txt", text))
