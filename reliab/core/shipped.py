"""Where the studies and datasets that ship with the project are found.

In an installed wheel they lie in the folder `shipped/` of the package, which holds no Python and
therefore does not stand in its way; in a checkout they are the folders `studies/` and `datasets/` beside
the package. What is too large for the wheel is taken from the user's data folder, to which `reliab fetch`
brings it.

Files that `datasets/SHA256SUMS` lists are compared with their checksum when they are read, once in a process.
"""

import os
from functools import cache
from pathlib import Path

from reliab.core.errors import InputError

KINDS = ("datasets", "studies")
"""What ships with the project."""

DATA_VARIABLE = "RELIAB_DATA"
"""Environment variable that names the folder of fetched data."""

CHECKSUMS = "SHA256SUMS"
"""File that lists checksums below the folder of its kind, as `sha256sum` writes them."""

_PACKAGE_FOLDER = Path(__file__).parents[1] / "shipped"
_CHECKOUT = Path(__file__).parents[2]


def shipped(kind: str, name: str) -> Path:
    """Find a file or folder that ships with the project.

    >>> shipped("datasets", "paper/table2.csv").name
    'table2.csv'
    """
    if kind not in KINDS:
        raise InputError(
            "Only datasets and studies ship with reliab", value=kind, remedy=f"Use {' or '.join(KINDS)}"
        )
    folder, digests = find_shipped_folder(kind), checksums(kind)
    path = folder / name
    if not path.exists() and name in digests:
        path = find_fetched(kind, name)
        if not path.exists():
            raise InputError(
                "This file is too large to ship with the installed package",
                value=f"no {kind}/{name}",
                remedy=f"Run `reliab fetch {kind}/{name}` in a checkout, or give its https address",
            )
    if not path.exists():
        present = sorted(
            entry.name for entry in folder.glob("*") if entry.name not in ("README.md", CHECKSUMS)
        )
        raise InputError(
            f"reliab ships no {kind} of this name",
            value=name,
            remedy=f"Choose among {', '.join(present)}",
        )
    if name in digests:
        _verify(path, path.stat().st_mtime_ns, digests[name])
    return path


def find_fetched(kind: str, name: str) -> Path:
    """Return where a file lies that is too large for the wheel, once it is fetched.

    Returns below the folder that the environment variable RELIAB_DATA names, or the user's own data folder.
    """
    home = os.environ.get("LOCALAPPDATA") or os.environ.get("XDG_DATA_HOME") or Path.home() / ".local/share"
    return Path(os.environ.get(DATA_VARIABLE) or Path(home) / "reliab") / kind / name


@cache
def checksums(kind: str) -> dict[str, str]:
    """Read the SHA-256 of the files of a kind.

    Returns checksums in hexadecimal by path below the folder; empty where none are listed.
    """
    file = find_shipped_folder(kind) / CHECKSUMS
    if not file.exists():
        return {}
    pairs = (line.split(maxsplit=1) for line in file.read_text(encoding="utf-8").splitlines())
    return {name: checksum for checksum, name in pairs}


def checksum_of(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal."""
    from hashlib import file_digest

    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


@cache
def _verify(path: Path, modified: int, checksum: str) -> None:
    """Compare a file, as it was at a time, with its checksum."""
    del modified  # a file that changes is compared again
    if (actual := checksum_of(path)) != checksum:
        raise InputError(
            "A file that came with reliab has changed",
            value=f"SHA-256 {actual}",
            remedy="Install reliab again, or restore the file; SHA256SUMS lists what is right",
            where=str(path),
        )


def find_shipped_folder(kind: str) -> Path:
    """Return the folder of what ships of a kind; it need not exist: the product runs without the studies."""
    folder = _PACKAGE_FOLDER / kind
    return folder if folder.is_dir() else _CHECKOUT / kind


def is_own_data(path: Path, *files: str) -> bool:
    """Whether a path is data of the user: a file, or a folder that holds one of the files.

    Any other folder, such as that of a run, does not hide what ships under its name.
    """
    return any((path / file).exists() for file in files) if path.is_dir() else path.exists()


def or_shipped(path: Path, kind: str, file: str) -> Path:
    """Take the user's file or store of results, or what ships under this name where there is none."""
    if path.suffix or len(path.parts) != 1 or is_own_data(path, "zarr.json"):
        return path
    present = {entry.name for entry in find_shipped_folder(kind).glob("*") if (entry / file).exists()}
    names = {name.removesuffix(f"/{file}") for name in checksums(kind) if name.endswith(f"/{file}")}
    if path.name not in present | names:
        if path.exists():
            return path
        raise InputError(
            f"{path} not found",
            remedy=f"Check the path, or name {' or '.join(sorted(present | names))}",
        )
    return shipped(kind, f"{path}/{file}")
