"""What is answered about one test, and how it is shown."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any


def _nothing() -> None:
    """Write no report."""


@dataclass(frozen=True, kw_only=True)
class Judgement:
    """The answer about one test.

    Attributes
    ----------
    content : dict
        Plain numbers, as `--json` writes them.
    show : callable
        Prints them on the terminal.
    write_report : callable
        Writes the report that the options ask for; nothing by default.
    """

    content: dict[str, Any]
    show: Callable[[], None]
    write_report: Callable[[], None] = _nothing


Judge = Callable[[Path], Judgement]
"""Takes the file of a test."""
