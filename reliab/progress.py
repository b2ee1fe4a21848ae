"""How long-running work reports its progress."""

from collections.abc import Callable

Progress = Callable[[int, int], None]
"""Called with the number of pieces done and their total."""


def silent(done: int, total: int) -> None:
    """Report nothing."""
