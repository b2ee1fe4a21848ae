"""How long-running work reports its progress."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext

Progress = Callable[[int, int], None]
"""Called with the number of pieces done and their total."""


def silent(done: int, total: int) -> None:
    """Report nothing."""


Show = Callable[[str], AbstractContextManager[Progress]]
"""Takes the name of a task and shows its progress."""


def quietly(what: str) -> AbstractContextManager[Progress]:
    """Show nothing of a task."""
    del what
    return nullcontext(silent)
