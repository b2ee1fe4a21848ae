"""The process that works for the desk: it reads what to do, and writes how far it is and what came of it.

Messages are pickles, which only the desk and its own workers write.
"""

import os
import pickle
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import IO, Any, Final

from reliab.core.errors import ReliabError
from reliab.core.progress import Progress, shows_tasks

_SHORTEST_STEP: Final = 0.01  # of the progress between two messages


class Pipe:
    """Messages to and from a process."""

    def __init__(self, reads: IO[bytes], writes: IO[bytes]) -> None:
        self._reads, self._writes = reads, writes

    def receive(self) -> Any:  # noqa: ANN401 - of many kinds
        """Wait for a message; raises EOFError where none will come."""
        return pickle.load(self._reads)  # noqa: S301 - from a process that the desk started

    def close(self) -> None:
        """Close both ends; what could not be sent is given up."""
        with suppress(OSError):
            self._writes.close()
        self._reads.close()

    def send(self, message: object) -> None:
        """Send a message."""
        pickle.dump(message, self._writes, protocol=pickle.HIGHEST_PROTOCOL)
        self._writes.flush()


def answer(channel: Pipe, work: Callable[..., Any], arguments: Mapping[str, Any]) -> tuple[str, Any]:
    """Work, and tell the progress; return "finished" and the outcome, or "refused" and why."""

    @contextmanager
    def show(task: str) -> Iterator[Progress]:
        last = -1.0

        def progress(complete: int, total: int) -> None:
            nonlocal last
            share = complete / max(total, 1)
            if share - last >= _SHORTEST_STEP or share < last:
                last = share
                channel.send(("progress", (task, share)))

        progress(0, 1)
        yield progress

    def tell(news: Any) -> None:  # noqa: ANN401 - what a page takes
        channel.send(("news", news))

    further_fields = {"tell": tell} if "tell" in work.__annotations__ else {}
    try:
        with shows_tasks(show):
            return "finished", work(**arguments, **further_fields)
    except ReliabError as error:
        return "refused", str(error)
    except Exception as error:  # noqa: BLE001 - the desk goes on, and says what happened
        name = type(error).__name__
        return "refused", (
            f"reliab itself has failed ({name}: {error}); this says nothing about the test. Please report it "
            "with the file, and what `reliab info` prints."
        )


def main() -> None:
    """Work through what is asked until the desk closes; what libraries print goes to the error stream."""
    channel = Pipe(sys.stdin.buffer, os.fdopen(os.dup(1), "wb"))
    os.dup2(2, 1)
    _load_kernels()
    with suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            work, arguments = channel.receive()
            channel.send(answer(channel, work, arguments))


def _load_kernels() -> None:
    """Read and judge the test that ships, so that the user's first does not wait for it."""
    from reliab.app.api.assessment import assess
    from reliab.app.api.records import record

    with suppress(ReliabError):
        record("sample_test")
        assess("sample_test", f=1.0, xi=0.02)


if __name__ == "__main__":
    main()
