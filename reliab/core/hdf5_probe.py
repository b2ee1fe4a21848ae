"""Read whole HDF5 files for another process, which goes on where a damaged one ends its reader.

It runs as a script of its own, without reliab: each line of standard input is the name of a file in
hexadecimal digits and how many seconds it may take. The line "read" follows on standard output when all of it
has been read, or "failed". What the library does with damaged bytes depends on what it has read before,
so each file has a process of its own where the system can make one at once.
"""

import contextlib
import os
import signal
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    import h5py

_SLAB = 1 << 26  # bytes that are read at once
_MOST_REFERENCES = 100_000
_LARGEST_RATIO = 1100  # of declared to stored bytes; deflate packs zeros to 1/1032


def _read(path: str) -> None:
    """Read every attribute, dataset and reference of a file as its readers do, whatever errors they meet."""
    import h5py

    with contextlib.suppress(Exception), h5py.File(path, "r") as file:
        addresses = set()
        waiting: list[h5py.HLObject] = [file]
        while waiting:
            item = waiting.pop()
            if (place := h5py.h5o.get_info(item.id).addr) in addresses:
                continue
            addresses.add(place)
            for name in item.attrs:
                with contextlib.suppress(Exception):
                    item.attrs[name]
            if isinstance(item, h5py.Group):
                waiting += _members(item)
            elif isinstance(item, h5py.Dataset):
                with contextlib.suppress(Exception):
                    waiting += _contents(file, item)


def _members(group: "h5py.Group") -> "Iterator[h5py.HLObject]":
    import h5py

    for name in group:
        with contextlib.suppress(Exception):
            if isinstance(group.get(name, getlink=True), h5py.HardLink):
                yield group[name]


def _contents(file: "h5py.File", item: "h5py.Dataset") -> "Iterator[h5py.HLObject]":
    """Read a dataset, and follow its references and those to the scales of its dimensions."""
    import h5py

    if item.is_virtual or item.external:
        return
    if item.nbytes > _SLAB + _LARGEST_RATIO * item.id.get_storage_size():
        return  # more than it can hold, which its readers refuse
    rows = max(_SLAB // max(item.nbytes // max(len(item), 1), 1), 1) if item.shape else 1
    refers = h5py.check_ref_dtype(item.dtype) is not None
    for begin in range(0, len(item), rows) if item.shape else ():
        values = item[begin : begin + rows]
        for reference in values.reshape(-1)[:_MOST_REFERENCES] if refers else ():
            with contextlib.suppress(Exception):
                yield file[reference]
    if not item.shape:
        item[()]
    if item.is_scale:
        return
    for dimension in item.dims:
        yield from dimension.values()


def _survives(path: str, seconds: int) -> bool:
    if not hasattr(os, "fork"):
        _read(path)
        return True
    process = os.fork()
    if not process:
        signal.alarm(seconds)
        _read(path)
        os._exit(0)
    return os.waitpid(process, 0)[1] == 0


def main() -> None:
    """Answer until standard input ends."""
    import h5py  # noqa: F401 - before the first answer, which says that it is there

    print("ready", flush=True)  # noqa: T201 - the other process reads it
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # which is meant for the other process
    for line in sys.stdin:
        digits, seconds = line.split()
        answer = "read" if _survives(os.fsdecode(bytes.fromhex(digits)), int(seconds)) else "failed"
        print(answer, flush=True)  # noqa: T201


if __name__ == "__main__":
    main()
