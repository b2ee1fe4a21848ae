"""How long-running work reports its progress."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from contextvars import ContextVar

Progress = Callable[[int, int], None]
"""Called with the number of pieces done and their total."""


def silent(count: int, total: int) -> None:
    """Report nothing."""


Show = Callable[[str], AbstractContextManager[Progress]]
"""Takes the name of a task and shows its progress."""


def quietly(task: str) -> AbstractContextManager[Progress]:
    """Show nothing of a task."""
    del task
    return nullcontext(silent)


_SHOW: ContextVar[Show] = ContextVar("show", default=quietly)


@contextmanager
def shows_tasks(show: Show) -> Iterator[None]:
    """Let a function show the tasks inside, however deep they lie."""
    token = _SHOW.set(show)
    try:
        yield
    finally:
        _SHOW.reset(token)


def show_task(task: str) -> AbstractContextManager[Progress]:
    """Show the progress of a task as whoever called it shows tasks; nothing where nobody does.

    >>> with show_task("Counting") as progress:
    ...     progress(1, 1)
    """
    return _SHOW.get()(task)
