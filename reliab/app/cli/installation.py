"""`reliab fetch`, `samples` and `info`: what ships, what is fetched, and the facts about an installation."""

from typing import Any

from reliab.app import questions
from reliab.app.cli.commands import Request, takes
from reliab.app.cli.output import write_line


@takes(questions.ListedData)
def fetch(request: Request) -> None:
    """Fetch the data that are too large for the package: results.nc of real_suite."""
    from reliab.app.api.installation import fetch_dataset

    request.answer(
        fetch_dataset,
        lambda path: write_line(f"{path}: the checksum is as listed"),
        content=lambda path: {"file": str(path)},
    )


@takes(questions.SampleFolder)
def samples(request: Request) -> None:
    """Write sample files into a folder; files that you changed are kept."""
    from reliab.app.api.installation import copy_samples

    request.answer(
        copy_samples,
        lambda paths: write_line("\n".join(map(str, paths))),
        content=lambda paths: {"samples": [*map(str, paths)]},
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
