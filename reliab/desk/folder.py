"""Files of the desk: what pages may read, and the working folder in which all is kept that they write."""

import os
import secrets
import shutil
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from reliab.core.errors import InputError
from reliab.core.files import LIMITS, decoding, refuse_unwritable, written_whole
from reliab.core.untrusted_files import resolve_within

_LONGEST_NAME: Final = 120
_MOST_FILES: Final = 2000  # of an archive
_PREFIX: Final = ".reliab-desk-"
_MOST_OFFERED: Final = 60  # files in a menu
_DEPTH: Final = 2  # folders below the desk's in which files are looked for


@dataclass(frozen=True, kw_only=True)
class DeskFolder:
    """The folder of the desk's user, and inside it the working folder, which goes when the desk closes."""

    path: Path
    work: Path

    @classmethod
    def open_folder(cls, path: str | Path) -> "DeskFolder":
        """Open a folder that is there, and make the working folder in it."""
        folder = Path(path).resolve()
        if not folder.is_dir():
            raise InputError(
                "The desk works in a folder",
                value="no such folder",
                remedy="Name one that is there",
                where=str(path),
            )
        with refuse_unwritable("Cannot write the desk's folder", where=folder):
            work = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=folder))
        return cls(path=folder, work=work)

    def close(self) -> None:
        """Remove the working folder."""
        shutil.rmtree(self.work, ignore_errors=True)

    def new_place(self) -> Path:
        """Make a new empty folder for files of one page."""
        place = self.work / secrets.token_hex(8)
        place.mkdir()
        return place

    def keep(self, name: str, content: bytes | str, *, place: Path | None = None) -> Path:
        """Keep a dropped file under its own name, without what could lead elsewhere."""
        raw = content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content
        limit = LIMITS["test"]
        if len(raw) > limit.bytes:
            raise InputError(
                f"The file is larger than {limit.bytes / 1e6:,.6g} MB",
                value=f"{len(raw) / 1e6:,.6g} MB",
                remedy=limit.remedy,
                where=name,
            )
        path = (place or self.new_place()) / safe_name(name)
        rule = "Cannot write the desk's folder"
        with refuse_unwritable(rule, where=self.path), written_whole(path) as file:
            file.write_bytes(raw)
        return path

    def keep_last(self, dropped_files: Mapping[str, bytes | str]) -> Path:
        """Keep the last of the files that were dropped."""
        return self.keep(*list(dropped_files.items())[-1])

    def within(self, name: str) -> Path:
        """Return the path of a file or folder that the user names, which must lie in the desk's folder."""
        path = Path(name.strip())
        relative = Path(os.path.relpath(path, self.path)) if path.is_absolute() else path
        try:
            return resolve_within(self.path, str(relative), where="")
        except InputError:
            raise InputError(
                f"The desk reads only in its folder, {self.path}",
                value=name,
                remedy="Start the desk with the folder that holds it: `reliab desk FOLDER`",
            ) from None

    def list_files(self, *endings: str, holding: str = "") -> list[str]:
        """List files by their endings, or folders by what they hold, the latest first."""
        damping_figure = len(Path(holding).parts)  # parts of a match that lie in the folder that is offered
        matches = (
            match
            for depth in range(_DEPTH + 1)
            for match in self.path.glob("/".join(["*"] * depth + [holding or "*"]))
            if self.work not in match.parents and not match.name.startswith(".")
        )
        paths = {
            match.parents[damping_figure - 1] if holding else match
            for match in matches
            if holding or (match.suffix.lower() in endings and match.is_file())
        }
        latest = sorted(paths, key=lambda path: path.stat().st_mtime, reverse=True)
        return [str(path.relative_to(self.path)) for path in latest[:_MOST_OFFERED]]


def safe_name(name: str) -> str:
    r"""Return the last part of a file's name, as this system can write it.

    >>> safe_name("../../etc/passwd"), safe_name("C:\\lab\\test 1.csv"), safe_name("..")
    ('passwd', 'test 1.csv', 'file')
    """
    last = name.encode("utf-8", "replace").decode().replace("\\", "/").split("/")[-1]
    plain = "".join(letter for letter in last if letter.isprintable() and letter not in ':*?"<>|').strip(" .")
    stem, dot, ending = plain.rpartition(".")
    if dot and len(plain) > _LONGEST_NAME:
        plain = f"{stem[: _LONGEST_NAME - 10]}.{ending[:9]}"
    return plain[:_LONGEST_NAME] or "file"


def unpack_archive(archive: Path) -> Path:
    """Unpack the archive of a campaign beside it, and return the folder that holds `campaign.toml`.

    Names that lead elsewhere, links, and content beyond the limits of a test are refused before anything is
    written.
    """
    rule, remedy = "A campaign must be a zip of its folder", "Pack the folder with campaign.toml again"
    folder = archive.parent / "unpacked"
    with decoding(rule, remedy=remedy, where=archive.name), zipfile.ZipFile(archive) as contents:
        entries = [entry for entry in contents.infolist() if not entry.is_dir()]
        size = sum(entry.file_size for entry in entries)
        if len(entries) > _MOST_FILES or size > LIMITS["test"].bytes:
            raise InputError(
                f"An archive may hold {_MOST_FILES:,} files and {LIMITS['test'].bytes / 1e6:,.6g} MB at most",
                value=f"{len(entries):,} files of {size / 1e6:,.6g} MB together",
                remedy="Pack the campaign's folder alone",
                where=archive.name,
            )
        for entry in entries:
            parts = PurePosixPath(entry.filename.replace("\\", "/")).parts
            if entry.filename.startswith(("/", "\\")) or ".." in parts or ":" in entry.filename:
                raise InputError(
                    "A file of an archive must lie in it",
                    value=repr(entry.filename),
                    remedy=remedy,
                    where=archive.name,
                )
        folder.mkdir()
        for entry in entries:
            path = folder / entry.filename
            path.parent.mkdir(parents=True, exist_ok=True)
            with contents.open(entry) as source, written_whole(path) as file, file.open("wb") as target:
                shutil.copyfileobj(source, target)  # a link becomes a plain file
    descriptions = sorted(folder.rglob("campaign.toml"), key=lambda path: len(path.parts))
    return descriptions[0].parent if descriptions else folder
