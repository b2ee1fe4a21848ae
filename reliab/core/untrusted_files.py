"""What a folder or a file from someone else names: it must lie in that folder, or in that file."""

import atexit
import contextlib
import mmap
import os
import subprocess
import sys
import threading
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Final

from reliab.core.errors import InputError
from reliab.core.files import decoding, is_annexed, ordinary

_COLLECTION = b"GCOL\x01"
_HEAD = 16  # bytes before the content of a collection, and of an object in it
_PROBE_SECONDS, _PROBE_BYTES_PER_SECOND = 60.0, 5e6  # that another process has for a file
_DEEPEST = 32  # every path is as long as its depth, so that all of them take its square

if TYPE_CHECKING:
    from collections.abc import Iterator

    import h5py
    import numpy as np
    from numpy.typing import NDArray


def resolve_within(folder: Path, name: str, *, where: str) -> Path:
    """Return the path of a file that a folder names, which must lie in that folder.

    A name that leads out of it, by itself or through a link, would read a file of this machine; a link of
    git-annex leads to an object of the folder's own repository.

    >>> resolve_within(Path("campaign"), "../secret.csv", where="campaign.toml")
    Traceback (most recent call last):
    ...
    reliab.core.errors.InputError: campaign.toml: The file lies outside the folder that names it; found
    '../secret.csv'. Copy it there, without links, and name it by its path from the folder.
    """
    path = folder / name
    with decoding("A file must have a name that the system allows", remedy="Correct it", where=where):
        is_inside = Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))
    if ".." in PurePath(name).parts or not (is_inside or is_annexed(path)):
        raise InputError(
            "The file lies outside the folder that names it",
            value=repr(name),
            remedy="Copy it there, without links, and name it by its path from the folder",
            where=where,
        )
    return path


@contextlib.contextmanager
def open_hdf5(path: str | Path, *, ships: bool = False) -> "Iterator[h5py.File]":
    """Open an HDF5 file that holds its own data.

    Links, raw storage and virtual datasets of HDF5 name other files, which would be read as part of it. The
    library ends the process on some damaged files: another process reads the file before. A file that `ships`
    is known by its checksum, and needs neither.
    """
    import h5py

    if not ships:
        _reject_cyclic_heaps(ordinary(path))
        _PROBE.read(Path(path))
    with h5py.File(ordinary(path), "r") as file:
        for name, item in () if ships else objects_of(file):
            if isinstance(item, h5py.Dataset):
                if item.is_virtual or item.external:
                    raise _elsewhere(name, path)
                lists_of_scales(item)
        yield file


def lists_of_scales(item: "h5py.Dataset") -> "list[NDArray[np.object_]]":
    """Read the references to the scales of each dimension of a dataset, of which it may have none.

    The functions of the library for them end the process where the attribute holds anything else.
    """
    import h5py
    import numpy as np

    name = "DIMENSION_LIST"
    if name not in item.attrs:
        return []
    dtype = h5py.check_vlen_dtype(item.attrs.get_id(name).dtype)
    refers = dtype is not None and h5py.check_ref_dtype(dtype) is h5py.Reference
    lists = np.asarray(item.attrs[name] if refers else 0.0)
    if lists.shape != (item.ndim,):
        raise InputError(
            "The attribute DIMENSION_LIST of an HDF5 dataset must refer to scales of each dimension",
            value=f"another one at {item.name}",
            remedy="Export it again; this file is damaged",
            where=str(item.file.filename),
        )
    return list(lists)


class _Probe:
    """Another process in which files are read first, as long as this one lives."""

    def __init__(self, script: Path) -> None:
        self._script = script
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0  # the process that started it, of which forks do not share it
        self._lock = threading.Lock()
        self._read: tuple[object, ...] = ()  # the last file that was read

    def read(self, path: Path) -> None:
        """Refuse a file that ends the process that reads it, or does not come to an end."""
        state = path.stat()
        key = (os.path.realpath(path), state.st_ino, state.st_size, state.st_mtime_ns)
        with self._lock:
            if key == self._read or not self._runs():
                return
            seconds = _PROBE_SECONDS + state.st_size / _PROBE_BYTES_PER_SECOND
            if self._ask(os.path.realpath(path), seconds) != b"read":
                raise InputError(
                    "The HDF5 library fails on this file",
                    remedy="Export it again: it is damaged",
                    where=path.name,
                )
            self._read = key

    def end(self) -> None:
        """End the other process, if this one has started it."""
        process, self._process = self._process, None
        if process is not None and self._owner == os.getpid():
            process.kill()
            for pipe in (process.stdin, process.stdout):
                with contextlib.suppress(OSError):
                    pipe.close()  # type: ignore[union-attr]
            process.wait()

    def _runs(self) -> bool:
        """Start the other process unless it runs; a program that only holds Python has none."""
        if self._process is not None and self._owner == os.getpid() and self._process.poll() is None:
            return True
        if getattr(sys, "frozen", False) or not Path(sys.executable or "").name.lower().startswith(
            ("python", "pypy")
        ):
            return False
        self.end()
        self._owner = os.getpid()
        with contextlib.suppress(OSError):
            self._process = subprocess.Popen(  # noqa: S603 - Python itself, without the modules of any folder
                [sys.executable, "-P", str(self._script)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                # it forks, and memory that nobody has set shall hold no zeros
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "MALLOC_PERTURB_": "165"},
            )
            atexit.register(self.end)
            if self._answer(_PROBE_SECONDS) == b"ready":
                return True
            self.end()
        return False

    def _ask(self, path: str, seconds: float) -> bytes:
        process = self._process
        with contextlib.suppress(OSError):
            process.stdin.write(f"{os.fsencode(path).hex()} {seconds:.0f}\n".encode())  # type: ignore[union-attr]
            process.stdin.flush()  # type: ignore[union-attr]
            if answer := self._answer(seconds + _PROBE_SECONDS):
                return answer
        self.end()
        return b""

    def _answer(self, seconds: float) -> bytes:
        """Wait some seconds for a line, then end the other process; nothing where it has ended."""
        process = self._process
        timer = threading.Timer(seconds, process.kill)  # type: ignore[union-attr]
        timer.start()
        try:
            return process.stdout.readline().strip()  # type: ignore[union-attr]
        finally:
            timer.cancel()


_PROBE: Final = _Probe(Path(__file__).with_name("hdf5_probe.py"))


def _reject_cyclic_heaps(path: str | Path) -> None:
    """Refuse a collection of texts in which the HDF5 library would look for the next object for ever.

    A collection is "GCOL", a version, three bytes, its size, and objects of index (2 bytes), uses (2),
    nothing (4) and size (8): a free one, of index 0, counts with its head, so that one of size 0 is its own
    successor.
    """
    if not Path(path).stat().st_size:
        return
    with Path(path).open("rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
        start = content.find(_COLLECTION)
        while start >= 0:
            place, end = start + _HEAD, start + int.from_bytes(content[start + 8 : start + _HEAD], "little")
            while place + _HEAD <= min(end, len(content)):
                index = int.from_bytes(content[place : place + 2], "little")
                size = int.from_bytes(content[place + 8 : place + _HEAD], "little")
                if not index and not size:
                    raise InputError(
                        "The texts in an HDF5 file must follow each other",
                        value=f"one without a size at byte {place}",
                        remedy="Export it again; this file is damaged",
                        where=str(path),
                    )
                place += _HEAD + -(-size // 8) * 8 if index else size
            start = content.find(_COLLECTION, start + 1)


def objects_of(file: "h5py.File") -> "Iterator[tuple[str, h5py.HLObject]]":
    """Go through the groups and datasets of an HDF5 file, each once, a group before what it holds."""
    import h5py

    waiting: list[tuple[str, h5py.HLObject]] = [("", file)]
    addresses = set()
    while waiting:
        path, item = waiting.pop()
        if (place := h5py.h5o.get_info(item.id).addr) in addresses:
            continue
        addresses.add(place)
        if path:
            yield path, item
        if not isinstance(item, h5py.Group):
            continue
        if path.count("/") >= _DEEPEST:
            raise InputError(
                f"The groups are nested more than {_DEEPEST} deep",
                remedy="Export it again, with the data near its root",
                where=str(file.filename),
            )
        for name in sorted(item, reverse=True):
            inner = f"{path}/{name}".lstrip("/")
            link = item.get(name, getlink=True)
            if isinstance(link, h5py.ExternalLink):
                raise _elsewhere(inner, file.filename)
            if isinstance(link, h5py.HardLink):
                waiting.append((inner, item[name]))


def _elsewhere(name: str, path: str | Path) -> InputError:
    return InputError(
        f"The data of {name} are in another file",
        remedy="Export it again, with all data in one file",
        where=str(path),
    )
