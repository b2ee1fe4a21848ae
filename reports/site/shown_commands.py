"""Answers of commands, printed by the build below the command that a page shows."""

import os
import shlex
import subprocess
import sys
from typing import Final

WIDTH: Final = 92  # characters that a page shows in a line


def show_answer(line: str, *, lines: int | None = None) -> None:
    """Print what a command answers.

    Parameters
    ----------
    line : str
        The command as it is typed.
    lines : int, optional
        How many lines of its answer to print, all by default.
    """
    done = subprocess.run(  # noqa: S603 - a line of our own page
        [sys.executable, "-m", *shlex.split(line)],
        env={**os.environ, "COLUMNS": str(WIDTH), "NO_COLOR": "1"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=True,
    )
    print("\n".join(done.stdout.splitlines()[:lines]))
