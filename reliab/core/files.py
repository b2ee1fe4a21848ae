"""Reading ordinary files only, refusing damaged ones, and writing files that are never half-written.

What is being written is named alike, held by its writer, and removed when that was killed.
"""

import contextlib
import errno
import json
import os
import shutil
import stat
import sys
import uuid
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Final

from reliab.core.errors import InputError, ReliabError

UNFINISHED = ".unfinished-"
"""How the name of a file or folder begins that is being written, or that a killed process left behind."""

_LONGEST_REASON = 200
_MEGABYTE = 1e6
_KINDS = {
    stat.S_IFIFO: "a pipe",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
    stat.S_IFSOCK: "a socket",
}


def make_unfinished_name(place: Path) -> Path:
    """Name a new file or folder beside a place, in which what belongs there is written first."""
    return place.with_name(f"{UNFINISHED}{uuid.uuid4().hex}{place.suffix}")


def remove_abandoned(paths: Iterable[Path]) -> None:
    """Remove what killed processes were writing."""
    for path in paths:
        with contextlib.suppress(OSError):
            if stat.S_IFMT(path.lstat().st_mode) not in (stat.S_IFREG, stat.S_IFDIR):
                continue
            if sys.platform == "win32":  # which removes no file that is open, and holds no folder
                path.unlink()
                continue
            descriptor = os.open(path, os.O_RDONLY)
            try:
                hold(descriptor, wait=False)
                shutil.rmtree(path) if path.is_dir() else path.unlink()
            finally:
                os.close(descriptor)


def hold(descriptor: int, *, wait: bool = True) -> None:
    """Hold a file or folder until its descriptor is closed, at the latest by the end of the process.

    A lock of `filelock` would empty the file, or need one beside it that stays.
    """
    if sys.platform == "win32":
        return  # where an open file cannot be removed
    import fcntl

    fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))


def ordinary(path: str | Path) -> Path:
    """Return a path unless a pipe, a device or a socket stands there, which might never end.

    >>> ordinary("/dev/zero")
    Traceback (most recent call last):
    ...
    OSError: [Errno 22] a device instead of an ordinary file: '/dev/zero'
    """
    path = Path(path)
    try:
        kind = stat.S_IFMT(path.stat().st_mode)
    except FileNotFoundError:
        return path
    except ValueError as error:  # a zero byte in the name
        raise OSError(errno.EINVAL, str(error), str(path)) from None
    if kind in _KINDS:
        raise OSError(errno.EINVAL, f"{_KINDS[kind]} instead of an ordinary file", str(path))
    return path


def require_small(path: str | Path, largest: int, *, remedy: str) -> None:
    """Refuse a file that would not fit in memory, before it is read.

    `largest` [bytes].

    >>> import tempfile
    >>> with tempfile.NamedTemporaryFile() as file:
    ...     require_small(file.name, 1_000_000, remedy="Cut it")
    """
    size = Path(path).stat().st_size
    if size > largest:
        raise InputError(
            f"The file is larger than {largest / _MEGABYTE:,.6g} MB",
            value=f"{size / _MEGABYTE:,.6g} MB",
            remedy=remedy,
            where=str(path),
        )


def is_annexed(link: str | Path) -> bool:
    """Tell whether a link is one of git-annex or DataLad, to an object of the repository that it lies in.

    Refuses one whose object is not on this machine.
    """
    target = os.path.realpath(link)
    for folder in Path(link).absolute().parents:
        objects = Path(os.path.realpath(folder), ".git", "annex", "objects")
        if (
            objects.is_dir()
            and os.path.realpath(objects) == str(objects)
            and target.startswith(f"{objects}{os.sep}")
        ):
            if not Path(target).is_file():
                raise InputError(
                    f"git-annex has not fetched the content of {link}",
                    remedy="Fetch it with `git annex get` or `datalad get`",
                )
            return True
    return False


def refuse_links(folder: Path, *neighbours: Path, reads: bool = False) -> None:
    """Refuse a folder with links among its files before it is read or written to.

    A folder may come from someone else: what is read or written where a link stands would be the file that
    it names, anywhere on this machine. A folder that one `reads` may lie under git-annex.
    """
    for entry in (*neighbours, *folder.rglob("*")):
        if entry.is_symlink() and not (reads and is_annexed(entry)):
            raise InputError(
                "A folder of results must not contain links",
                value=f"a link at {entry}",
                remedy="Remove the link, or put the file itself in its place",
                where=str(folder),
            )


@contextlib.contextmanager
def decoding(rule: str, *, remedy: str, where: object) -> Iterator[None]:
    """Turn whatever a library raises while it decodes a file into an error that says what to do.

    >>> with decoding("The file must be sound", remedy="Obtain it again", where="a.mat"):
    ...     raise IndexError("index 7 is out of bounds")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: a.mat: The file must be sound; found index 7 is out of bounds. Obtain it
    again.
    """
    try:
        yield
    except ReliabError:
        raise
    except FileNotFoundError as error:
        missing = Path(error.filename or str(where))
        is_member = missing.name != Path(str(where)).name
        place = f"{where}: {missing.name}" if is_member else str(where)
        raise InputError("No such file", remedy="Check the name", where=place) from error
    except IsADirectoryError as error:
        raise InputError("This is a folder", remedy="Name a file in it", where=str(where)) from error

    except Exception as error:  # damaged bytes lead decoders into every kind of error
        raise InputError(rule, value=_reason(error), remedy=remedy, where=str(where)) from error


def _reason(error: Exception) -> str:
    """Say what went wrong, in a line; a library's own text where the system has none."""
    if isinstance(error, MemoryError):
        return "more data than fit in memory"
    if isinstance(error, UnicodeDecodeError):
        return "bytes that are not text"
    if isinstance(error, KeyError) and error.args:
        return f"no {error}"
    lines = str(getattr(error, "strerror", None) or error).strip().splitlines()
    return lines[0][:_LONGEST_REASON].rstrip(" .:") if lines else type(error).__name__


@contextlib.contextmanager
def written_whole(path: str | Path) -> Iterator[Path]:
    """Write a file beside its place, and put it there when it is complete and on the disk.

    Whoever reads the file sees the one before or the new one, also after a crash or on a full disk. What
    killed processes left in the folder is removed.

    >>> import tempfile
    >>> place = Path(tempfile.mkdtemp()) / "numbers.txt"
    >>> with written_whole(place) as unfinished:
    ...     _ = unfinished.write_text("1 2 3")
    >>> place.read_text()
    '1 2 3'
    """
    place = Path(os.path.realpath(path))
    if place.exists() and not place.is_file():
        yield place  # a pipe or a device, such as /dev/null, is written to as it is
        return
    remove_abandoned(place.parent.glob(f"{UNFINISHED}*"))
    temporary, lock = _lock_unfinished(place)
    try:
        with lock:
            yield temporary
            _sync(temporary)
            if sys.platform != "win32":  # where an open file cannot be renamed
                temporary.replace(place)  # while it is held, so that nobody takes it for abandoned
        if sys.platform == "win32":
            temporary.replace(place)
        _sync(place.parent)
    except BaseException:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
        raise


def _lock_unfinished(place: Path) -> tuple[Path, IO[bytes]]:
    """Make a new file beside a place, and hold it.

    Another process may take it for abandoned before it is held, and remove it; then the next is made.
    """
    while True:
        temporary = make_unfinished_name(place)
        file = temporary.open("xb")
        hold(file.fileno())
        if temporary.exists():
            return temporary, file
        file.close()


@contextlib.contextmanager
def refuse_unwritable(rule: str, *, where: object, remedy: str = "Name another") -> Iterator[None]:
    """Refuse a place to which what is written inside cannot be written.

    >>> with refuse_unwritable("Cannot write the page", where="/dev/null/page"):
    ...     _ = Path("/dev/null/page").write_text("")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: /dev/null/page: Cannot write the page: Not a directory. Name another.
    """
    try:
        yield
    except FileNotFoundError as error:
        place = "Create its folder, or name another place"
        raise InputError(f"{rule}: its folder does not exist", remedy=place, where=str(where)) from error
    except OSError as error:
        raise InputError(f"{rule}: {error.strerror}", remedy=remedy, where=str(where)) from error


def require_ending(path: str | Path, *endings: str) -> None:
    """Refuse a file to write whose name does not end as its kind does; a pipe or a device has no kind.

    >>> require_ending("verdict.doc", ".pdf")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: The name of a file must end in .pdf; found verdict.doc. Write verdict.pdf.
    """
    place = Path(path)
    if place.suffix.lower() not in endings and not (place.exists() and not place.is_file()):
        raise InputError(
            f"The name of a file must end in {' or '.join(endings)}",
            value=place.name,
            remedy=f"Write {place.stem or 'result'}{endings[0]}",
        )


def write_json_file(content: object, path: str | Path) -> None:
    """Write plain values as JSON, whole or not at all."""
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    with refuse_unwritable("Cannot write the JSON file", where=path), written_whole(path) as file:
        file.write_text(f"{text}\n", encoding="utf-8", errors="backslashreplace")


@contextlib.contextmanager
def folder_written_whole(place: Path) -> Iterator[Path]:
    """Write a folder, new or empty, beside its place and put it there when it is complete.

    It is as :func:`written_whole` with a file. Of two processes that write one folder the second has an
    OSError.
    """
    place = Path(os.path.realpath(place))
    temporary = make_unfinished_name(place)
    temporary.mkdir(parents=True)
    try:
        with _lock_folder(temporary):
            remove_abandoned(place.parent.glob(f"{UNFINISHED}*"))
            yield temporary
            if place.exists():
                place.rmdir()
            temporary.rename(place)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


@contextlib.contextmanager
def _lock_folder(folder: Path) -> Iterator[None]:
    if sys.platform == "win32":  # where folders cannot be opened
        yield
        return
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        hold(descriptor)
        yield
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def lock_for_writing(path: Path, rule: str) -> Iterator[None]:
    """Keep every other process from writing to a folder, with a lock that stands beside it."""
    import filelock

    lock = filelock.FileLock(path.with_name(path.name + ".lock"), timeout=0)
    refuse_links(path, Path(lock.lock_file))
    with refuse_unwritable("The place of a folder must be writable", where=path.parent):
        try:
            lock.acquire()
        except filelock.Timeout:
            raise InputError(
                rule,
                value=f"{path} in use by another process",
                remedy="Wait until it is done, or name another",
            ) from None
    try:
        yield
    finally:
        lock.release()


def _sync(path: Path) -> None:
    """Wait until a file, or the names in a folder, are on the disk."""
    if sys.platform == "win32" and path.is_dir():
        return  # folders cannot be opened there, and what is to reach the disk must be open for writing
    descriptor = os.open(path, os.O_RDWR if sys.platform == "win32" else os.O_RDONLY)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # some shared file systems cannot
            raise
    finally:
        os.close(descriptor)


_LOOKED_AT = 4_000_000  # bytes of a text whose lines are looked at: tables begin near its top
_DELIMITERS = (b",", b";", b"\t")


@dataclass(frozen=True, kw_only=True)
class FileLimits:
    """Largest sizes of a file of one kind."""

    remedy: str
    bytes: int
    columns: int = 1000
    numbers: int = 2_000_000_000  # Bytes of all its numbers together, in memory

    def require_small(self, path: str | Path) -> None:
        """Refuse a file that would not fit in memory, before it is read."""
        require_small(path, self.bytes, remedy=self.remedy)

    def require_narrow(self, path: str | Path) -> None:
        """Refuse a text with more columns than any table, before its lines are cut into cells."""
        with Path(path).open("rb") as file:
            lines = file.read(_LOOKED_AT).splitlines()
        widest = max((max(*map(line.count, _DELIMITERS), len(line.split())) + 1 for line in lines), default=0)
        if widest > self.columns:
            raise InputError(
                f"The table has more than {self.columns:,} columns",
                value=f"{widest:,} or more",
                remedy=self.remedy,
                where=str(path),
            )

    def require_few_numbers(self, size: int, where: str | Path) -> None:
        """Refuse numbers that would not fit in memory; `size` [bytes] is what the file declares."""
        if size > self.numbers:
            raise InputError(
                f"The file holds more than {self.numbers / _MEGABYTE:,.6g} MB of numbers",
                value=f"{size / _MEGABYTE:,.6g} MB",
                remedy=self.remedy,
                where=str(where),
            )


_SHORTER_TEST = "Leave columns out, resample the test, or cut it where everything stands still"

LIMITS: Final[Mapping[str, FileLimits]] = {
    "description": FileLimits(  # whose TOML takes two to six seconds
        bytes=5_000_000, remedy="Write the description as its examples are written"
    ),
    "criterion": FileLimits(  # of some ten thousand motions, in JSON
        bytes=200_000_000, remedy="Derive it for fewer structures or errors"
    ),
    "matrix": FileLimits(bytes=20_000_000, remedy="Condense the structure to fewer degrees of freedom"),
    "table of ellipses": FileLimits(  # which takes about eight times its size in memory
        bytes=200_000_000,
        remedy="Keep the columns, structures and errors that you ask for, or write NetCDF",
    ),
    "dataset": FileLimits(  # of ellipses or results, in NetCDF
        bytes=1_000_000_000, remedy="Write fewer structures, errors or motions into one file"
    ),
    "figure": FileLimits(bytes=50_000_000, remedy="Run the study again with `reliab run`"),
    "test": FileLimits(bytes=2_000_000_000, remedy=_SHORTER_TEST),
    "text of a test": FileLimits(  # which takes about seven times its size in memory
        bytes=400_000_000, remedy=f"{_SHORTER_TEST}, or export it as HDF5 or TDMS"
    ),
}
"""Limits by the kind of file."""
