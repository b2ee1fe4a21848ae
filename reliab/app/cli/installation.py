"""`reliab fetch`, `samples` and `info`: what ships, what is fetched, and the facts about an installation."""

from pathlib import Path
from typing import Annotated, TypedDict

from reliab.app.cli.commands import Asked, takes
from reliab.app.cli.output import write_json, write_line
from reliab.app.declaration import argument


class _Source(TypedDict):
    source: Annotated[
        str, argument("FILE|https://…", "The file in the project's sources, or its https address.")
    ]


@takes(_Source)
def fetch(asked: Asked) -> None:
    """Fetch the data that are too large for the package: results.nc of real_suite."""
    from reliab.app.api.installation import fetch_dataset

    fetched = asked.ask(fetch_dataset, "json_target")
    if not write_json({"file": str(fetched)}, asked.json_target):
        write_line(f"{fetched}: the checksum is as listed")


class _Folder(TypedDict):
    folder: Annotated[
        Path, argument("[FOLDER]", "Folder for the samples; `datasets` by default.", default=Path("datasets"))
    ]


@takes(_Folder)
def samples(asked: Asked) -> None:
    """Write sample files into a folder; files that you changed are kept."""
    from reliab.app.api.installation import copy_samples

    copied = [str(sample) for sample in asked.ask(copy_samples, "json_target")]
    if not write_json({"samples": copied}, asked.json_target):
        for sample in copied:
            write_line(sample)


@takes()
def info(asked: Asked) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    from reliab.app.api.installation import describe_installation

    content = asked.ask(describe_installation, "json_target")
    if write_json(content, asked.json_target):
        return
    for name, value in content.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")
