"""`reliab samples`: tests, campaigns and frames that ship, as files to look at, to copy and to try with."""

from pathlib import Path
from typing import Annotated

import typer

from reliab.cli.output import write_line
from reliab.errors import InputError
from reliab.files import written_whole
from reliab.shipped import shipped

_SAMPLES = (
    "sample_test",
    "campaigns/README.md",
    "campaigns/rig_a",
    "campaigns/rig_b",
    "campaigns/rig_c",
    "frames",
)


def samples(
    folder: Annotated[
        Path, typer.Argument(metavar="[FOLDER]", help="Where they are written; `datasets` by default.")
    ] = Path("datasets"),
) -> None:
    """Write the sample test, campaigns and frames into a folder; files of another content are not touched."""
    home = shipped("datasets", "")
    copies = {folder / file.relative_to(home): file for sample in _SAMPLES for file in _files(home / sample)}
    try:
        contents = {path: file.read_bytes() for path, file in copies.items()}
        _refuse_others(contents)
        for path, content in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            with written_whole(path) as unfinished:
                unfinished.write_bytes(content)
    except OSError as error:
        raise InputError(
            "The folder for the samples must be writable",
            value=error.strerror,
            remedy="Name another",
            where=str(folder),
        ) from error
    for sample in _SAMPLES:
        write_line(str(folder / sample))


def _files(sample: Path) -> list[Path]:
    return sorted(path for path in sample.iterdir() if path.is_file()) if sample.is_dir() else [sample]


def _refuse_others(contents: dict[Path, bytes]) -> None:
    """Refuse to write over files that are not the samples themselves."""
    for path, content in contents.items():
        if path.exists() and path.read_bytes() != content:
            raise InputError(
                "A sample takes the place of no other file",
                value="a file of another content; nothing was written",
                remedy="Name another folder, or move the file",
                where=str(path),
            )
