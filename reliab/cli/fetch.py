"""`reliab fetch`: bring a file that is too large for the wheel to the user's data folder."""

import shutil
from contextlib import AbstractContextManager
from pathlib import Path, PurePosixPath
from typing import IO, Annotated
from urllib.parse import urlsplit

import typer

from reliab.cli.output import write_line
from reliab.errors import InputError
from reliab.files import ordinary, written_whole
from reliab.shipped import checksum_of, checksums, fetched

_KIND = "datasets"

Source = Annotated[
    str,
    typer.Argument(metavar="FILE|https://…", help="The file in the project's sources, or its https address."),
]


def fetch(source: Source) -> None:
    """Bring shipped data that the wheel leaves out, results.nc of real_suite, and compare its checksum."""
    name = _name(source)
    target = fetched(_KIND, name)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with written_whole(target) as file:
            with _opened(source) as content, file.open("wb") as copy:
                shutil.copyfileobj(content, copy)
            _check(file, name, source)
    except OSError as error:
        raise InputError(
            "The file must be readable, and the data folder writable",
            value=str(error),
            remedy="Check the path or address, or name another folder in RELIAB_DATA",
            where=source,
        ) from error
    write_line(f"{target}: checksum as listed")


def _name(source: str) -> str:
    """Path below the datasets of the file that a source has the name of."""
    last = PurePosixPath(urlsplit(source).path if _is_address(source) else Path(source).as_posix()).name
    names = [name for name in checksums(_KIND) if PurePosixPath(name).name == last and name.endswith(".nc")]
    if len(names) != 1:
        raise InputError(
            "A file is fetched by the name that it has among the datasets",
            value=last,
            remedy=f"Choose among {', '.join(name for name in checksums(_KIND) if name.endswith('.nc'))}",
        )
    return names[0]


def _is_address(source: str) -> bool:
    return "://" in source


def _opened(source: str) -> AbstractContextManager[IO[bytes]]:
    if not _is_address(source):
        return ordinary(source).open("rb")
    if urlsplit(source).scheme != "https":
        raise InputError(
            "Data are fetched by https only", value=source, remedy="Give an https address or a file"
        )
    from urllib.request import urlopen

    response: AbstractContextManager[IO[bytes]] = urlopen(source, timeout=60)  # noqa: S310 - https, as checked
    return response


def _check(file: Path, name: str, source: str) -> None:
    if (actual := checksum_of(file)) != checksums(_KIND)[name]:
        raise InputError(
            "What is fetched must have the listed checksum",
            value=f"SHA-256 {actual}",
            remedy="Take the file of this version of reliab; nothing was kept",
            where=source,
        )
