"""Digests by which a run tells whether files or the code have changed."""

import hashlib
from functools import cache
from pathlib import Path

_CHUNK = 1 << 20


@cache
def code_digest() -> str:
    """SHA-256 of the package's own code: what it computes may change with any of its files."""
    package = Path(__file__).parents[1]
    digests = hashlib.sha256()
    for file in sorted(package.rglob("*.py")):
        digests.update(str(file.relative_to(package)).encode())
        digests.update(file.read_bytes())
    return digests.hexdigest()


def digest(path: Path) -> str:
    """SHA-256 of a file, or of all files in a folder; empty where there is nothing.

    Parameters
    ----------
    path : pathlib.Path
        File or folder.

    Returns
    -------
    str
        The digest in hexadecimal.
    """
    total = hashlib.sha256()
    files = sorted(path.rglob("*")) if path.is_dir() else [path]
    for file in files:
        if file.is_file():
            total.update(str(file.relative_to(path)).encode())
            with file.open("rb") as stream:
                while chunk := stream.read(_CHUNK):
                    total.update(chunk)
    return total.hexdigest() if any(file.is_file() for file in files) else ""
