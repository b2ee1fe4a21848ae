"""Progress of long work in a pipe or a file: a line now and then that states how long it will take."""

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from threading import Condition, Thread

from reliab.core.progress import Progress

FIRST_LINE = 10.0
"""Time [s] after which work is long enough for a line."""

_RAREST = 300.0  # s, between lines
_UNITS = ((3600.0, "hour"), (60.0, "minute"), (1.0, "second"))


@contextmanager
def progress_lines(task: str) -> Iterator[Progress]:
    """Write lines to the stream of errors while work goes on; none of short work.

    Lines become rarer; one comes as soon as the time that is left is known.
    """
    lines = _Lines(task)
    writer = Thread(target=lines.write, daemon=True)
    writer.start()
    try:
        yield lines.report
    finally:
        lines.end()
        writer.join()


class _Lines:
    """What is known of the work, and when the next line is due."""

    def __init__(self, task: str) -> None:
        self._what, self._pause = task, FIRST_LINE
        self._begin = self._clock = time.monotonic()
        self._done, self._before, self._total = 0, 0, 0
        self._changed, self._ended = Condition(), False

    def report(self, count: int, total: int) -> None:
        """Take the number of pieces that are done; what a first call states was done before."""
        with self._changed:
            if not self._total:
                self._before = count if count > 1 else 0
                self._clock = time.monotonic() if count > 1 else self._begin
            is_first = self._done == self._before < count
            self._done, self._total = count, total
            if is_first:
                self._changed.notify()

    def end(self) -> None:
        """Write no further line."""
        with self._changed:
            self._ended = True
            self._changed.notify()

    def write(self) -> None:
        """Write lines until the work ends."""
        due, is_estimated = self._begin + self._pause, True
        with self._changed:
            while not self._ended:
                now = time.monotonic()
                if now < due and (is_estimated or self._time_left is None):
                    self._changed.wait(due - now)
                    continue
                is_estimated = self._time_left is not None
                with suppress(OSError, ValueError):  # nobody reads on
                    sys.stderr.write(f"{self._line(now)}\n")
                    sys.stderr.flush()
                self._pause = min(2.0 * self._pause, _RAREST)
                due = now + self._pause

    @property
    def _time_left(self) -> float | None:
        """Time that is left [s], once a piece has shown how long one takes."""
        new = self._done - self._before
        if new <= 0:
            return None
        return (time.monotonic() - self._clock) / new * (self._total - self._done)

    def _line(self, now: float) -> str:
        remaining_time, elapsed_time = self._time_left, duration(now - self._begin)
        if remaining_time is None:
            return f"{self._what}: still at work after {elapsed_time}"
        duration_left = duration(remaining_time)
        return f"{self._what}: {self._done} of {self._total} after {elapsed_time}, about {duration_left} left"


def duration(seconds: float) -> str:
    """Write a duration in words.

    >>> duration(3.2), duration(95.0), duration(8000.0)
    ('3 seconds', '2 minutes', '2 hours')
    """
    size, unit = next((row for row in _UNITS if seconds >= 1.5 * row[0]), _UNITS[-1])
    count = max(round(seconds / size), 1)
    return f"{count} {unit}{'s' if count > 1 else ''}"
