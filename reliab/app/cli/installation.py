"""`reliab fetch`, `samples` and `info`: what ships, what is fetched, and the facts about an installation."""

from pathlib import Path
from typing import Annotated, Any, TypedDict

from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import write_line
from reliab.app.declaration import argument


class _Source(TypedDict):
    source: Annotated[
        str, argument("FILE|https://…", "The file in the project's sources, or its https address.")
    ]


@takes(_Source)
def fetch(request: Request) -> None:
    """Fetch the data that are too large for the package: results.nc of real_suite."""
    from reliab.app.api.installation import fetch_dataset

    request.answer(
        fetch_dataset,
        lambda fetched: write_line(f"{fetched}: the checksum is as listed"),
        content=lambda fetched: {"file": str(fetched)},
    )


class _Folder(TypedDict):
    folder: Annotated[
        Path, argument("[FOLDER]", "Folder for the samples; `datasets` by default.", default=Path("datasets"))
    ]


@takes(_Folder)
def samples(request: Request) -> None:
    """Write sample files into a folder; files that you changed are kept."""
    from reliab.app.api.installation import copy_samples

    request.answer(
        copy_samples,
        lambda copied: write_line("\n".join(map(str, copied))),
        content=lambda copied: {"samples": [*map(str, copied)]},
    )


@takes()
def info(request: Request) -> None:
    """Print versions, shipped data and where compiled code is kept, for a bug report."""
    from reliab.app.api.installation import describe_installation

    request.answer(describe_installation, _show, content=dict)


def _show(facts: dict[str, Any]) -> None:
    for name, value in facts.items():
        if isinstance(value, dict):
            write_line(f"{name}:")
            for key, text in value.items():
                write_line(f"  {key}: {text}")
        else:
            write_line(f"{name}: {value}")
