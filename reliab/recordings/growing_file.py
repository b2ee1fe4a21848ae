"""Bytes of a text that is still being written: a growing file, or standard input.

A file that was rotated (replaced by another one of the same name, or shortened) is read to its end, and then
from the beginning of the new one.
"""

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

from reliab.errors import InputError
from reliab.files import ordinary

_POLL = 0.05  # s between two looks at a file that does not grow
_BYTES = 1 << 16


def chunks_of_text(
    source: str, wait: float, start_within: float, say: Callable[[str], None] = lambda _sentence: None
) -> Iterator[bytes]:
    """Bytes of a growing file, or of standard input, as they come; `say` tells that a file is awaited."""
    if source == "-":
        while piece := os.read(sys.stdin.fileno(), _BYTES):
            yield piece
        return
    path = Path(source)
    stream = _awaited(path, start_within, say)
    idle, lines = 0.0, 0
    try:
        while idle <= (wait if lines > 1 else start_within):
            if piece := stream.read(_BYTES):
                idle, lines = 0.0, lines + piece.count(b"\n")
                yield piece
            elif _rotated(path, stream):
                stream.close()
                stream = _opened(path)
                yield b""
            else:
                time.sleep(_POLL)
                idle += _POLL
    finally:
        stream.close()


def _awaited(path: Path, limit: float, say: Callable[[str], None]) -> BinaryIO:
    """Open a file that a logger may still have to create in its folder."""
    if not path.exists() and path.absolute().parent.is_dir():
        say(f"Waiting up to {limit:g} s for {path.name}, which is not there yet; Ctrl-C ends it.")
        until = time.monotonic() + limit
        while not path.exists() and time.monotonic() < until:
            time.sleep(_POLL)
    return _opened(path)


def _opened(path: Path) -> BinaryIO:
    try:
        return ordinary(path).open("rb")
    except OSError as error:
        raise InputError(
            "The file must be readable",
            value=error.strerror,
            remedy="Name the file that the test is or will be written to, or - for standard input; "
            "`start_within` gives its logger more time",
            where=str(path),
        ) from error


def _rotated(path: Path, stream: BinaryIO) -> bool:
    """Return whether the file was replaced by another one, or shortened."""
    try:
        now = path.stat()
    except OSError:
        return False  # between two names; it will come
    here = os.fstat(stream.fileno())
    return now.st_ino != here.st_ino or now.st_size < stream.tell()
