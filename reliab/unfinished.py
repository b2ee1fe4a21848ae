"""Files and folders that are being written: named alike, held by their writer, removed when it was killed."""

import contextlib
import os
import shutil
import stat
import sys
import uuid
from collections.abc import Iterable
from pathlib import Path

UNFINISHED = ".unfinished-"
"""How the name of a file or folder begins that is being written, or that a killed process left behind."""


def unfinished_name(place: Path) -> Path:
    """Name a new file or folder beside a place, in which what belongs there is written first."""
    return place.with_name(f"{UNFINISHED}{uuid.uuid4().hex}{place.suffix}")


def remove_abandoned(unfinished: Iterable[Path]) -> None:
    """Remove what killed processes were writing."""
    for path in unfinished:
        with contextlib.suppress(OSError):
            if stat.S_IFMT(path.lstat().st_mode) not in (stat.S_IFREG, stat.S_IFDIR):
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
