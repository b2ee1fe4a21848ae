"""What a folder or a file from someone else names: it must lie in that folder, or in that file."""

import contextlib
import mmap
import os
from pathlib import Path, PurePath
from typing import TYPE_CHECKING

from reliab.errors import InputError
from reliab.files import decoding, is_annexed, ordinary

_COLLECTION = b"GCOL\x01"
_HEAD = 16  # bytes before the content of a collection, and of an object in it
_DEEPEST = 32  # every path is as long as its depth, so that all of them take its square

if TYPE_CHECKING:
    from collections.abc import Iterator

    import h5py


def named_within(folder: Path, name: str, *, where: str) -> Path:
    """Return the path of a file that a folder names, which must lie in that folder.

    A name that leads out of it, by itself or through a link, would read a file of this machine; a link of
    git-annex leads to an object of the folder's own repository.

    >>> named_within(Path("campaign"), "../secret.csv", where="campaign.toml")
    Traceback (most recent call last):
    ...
    reliab.errors.InputError: campaign.toml: A file that a folder names must lie in that folder; found
    '../secret.csv'. Copy it there, without links, and name it by its path from the folder.
    """
    path = folder / name
    with decoding("A file must have a name that the system allows", remedy="Correct it", where=where):
        inside = Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))
    if ".." in PurePath(name).parts or not (inside or is_annexed(path)):
        raise InputError(
            "A file that a folder names must lie in that folder",
            value=repr(name),
            remedy="Copy it there, without links, and name it by its path from the folder",
            where=where,
        )
    return path


@contextlib.contextmanager
def opened_hdf5(path: str | Path, *, ships: bool = False) -> "Iterator[h5py.File]":
    """Open an HDF5 file that holds its own data.

    Links, raw storage and virtual datasets of HDF5 name other files, which would be read as part of it. A
    file that `ships` is known by its checksum, and is not searched for them.
    """
    import h5py

    if not ships:
        _require_heaps_that_end(ordinary(path))
    with h5py.File(ordinary(path), "r") as file:
        for name, item in () if ships else objects_of(file):
            if isinstance(item, h5py.Dataset) and (item.is_virtual or item.external):
                raise _elsewhere(name, path)
        yield file


def _require_heaps_that_end(path: str | Path) -> None:
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
    met = set()
    while waiting:
        path, item = waiting.pop()
        if (place := h5py.h5o.get_info(item.id).addr) in met:
            continue
        met.add(place)
        if path:
            yield path, item
        if not isinstance(item, h5py.Group):
            continue
        if path.count("/") >= _DEEPEST:
            raise InputError(
                f"The groups of an HDF5 file must not be nested more than {_DEEPEST} deep",
                value="more",
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
        "An HDF5 file must hold its own data",
        value=f"{name}, which lies in another file",
        remedy="Export it again, with all data in one file",
        where=str(path),
    )
