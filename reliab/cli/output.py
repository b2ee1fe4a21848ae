"""What every command prints: JSON for programs, tables and progress for people."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer
from rich import box
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

from reliab.errors import InputError

_WIDTH_OF_PIPES = 160


def console() -> Console:
    """Console for results: as wide as the terminal, or wide enough to be searched in a pipe."""
    terminal = Console()
    return terminal if terminal.is_terminal else Console(width=_WIDTH_OF_PIPES)


def table(title: str, headings: Mapping[str, str]) -> Table:
    """Make a table with headings and their justification, "left" or "right".

    Parameters
    ----------
    title : str
        What the table shows.
    headings : mapping of str to str
        Justification by heading.

    Returns
    -------
    rich.table.Table
        The empty table.
    """
    made = Table(title=title, box=box.SIMPLE, padding=(0, 1, 0, 0), title_justify="left")
    for heading, justify in headings.items():
        made.add_column(Text(heading), justify=justify, no_wrap=True)  # type: ignore[arg-type]
    return made


def write_json(content: Mapping[str, Any], target: str | None) -> bool:
    """Write JSON if asked for; tell whether it is all that may stand on standard output.

    Parameters
    ----------
    content : mapping
        What to write.
    target : str or None
        A file, "-" for standard output, or None for neither.

    Returns
    -------
    bool
        Whether standard output is taken.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if target is None:
        return False
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False)
    if target == "-":
        typer.echo(text)
        return True
    try:
        Path(target).write_text(f"{text}\n", encoding="utf-8")
    except OSError as error:
        raise InputError(
            "The JSON file must be writable", value=error.strerror, remedy="Name another file", where=target
        ) from error
    return False


@contextmanager
def progress_bar(what: str) -> Iterator[Callable[[int, int], None]]:
    """Show a bar with the time left on a terminal, and nothing in a pipe.

    Parameters
    ----------
    what : str
        What is being done.

    Yields
    ------
    callable
        To be called with pieces done and their total.
    """
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(compact=True),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=None)

        def report(done: int, total: int) -> None:
            bar.update(task, completed=done, total=total)

        yield report
