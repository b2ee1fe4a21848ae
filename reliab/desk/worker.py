"""The process that works for the desk: it reads what to do, and writes how far it is and what came of it."""

import os
import signal
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from multiprocessing.connection import Connection
from typing import Any, Final

from reliab.core.errors import ReliabError
from reliab.core.progress import Progress, shows_tasks
from reliab.core.threads import ONE_THREAD

_SHORTEST_STEP: Final = 0.01  # of the progress between two messages


def answer(channel: Connection, work: Callable[..., Any], arguments: Mapping[str, Any]) -> tuple[str, Any]:
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


def work_through(channel: Connection, folder: str) -> None:
    """Work through what is asked until the desk closes; `folder`: where temporary files go.

    What libraries print goes to the error stream. Ctrl-C reaches the desk, which ends its workers.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.update({**ONE_THREAD, "TMPDIR": folder, "TEMP": folder, "MPLBACKEND": "agg"})
    os.dup2(2, 1)
    with suppress(EOFError, OSError):
        _load_kernels()
        while True:
            work, arguments = channel.recv()
            channel.send(answer(channel, work, arguments))


def _load_kernels() -> None:
    """Read and judge the test that ships, so that the user's first does not wait for it."""
    from reliab.app.api.assessment import assess
    from reliab.app.api.records import record

    with suppress(ReliabError):
        record("sample_test")
        assess("sample_test", f=1.0, xi=0.02)
