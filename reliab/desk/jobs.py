"""Long work in processes of its own, with progress and a way to end it; what pages remember of it.

A worker imports the package once, judges the shipped test to load its kernels, and then waits for work. To
cancel is to end the process: nothing of the work remains, and a new worker takes its place.
"""

import multiprocessing
import os
import re
import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from pickle import UnpicklingError
from typing import Any, Final

from reliab.desk.worker import work_through

Tell = Callable[[Any], None]
"""Sends an intermediate result from a worker to the page."""

MOST_WORKERS: Final = max(2, min(4, os.cpu_count() or 2))
"""Processes that work at once."""

_SPAWN: Final = multiprocessing.get_context("spawn")  # a fork would share the threads of the desk

_ENDED: Final = (
    "The calculation ended without an answer: its process was stopped, or ran out of memory. Try it again, "
    "with a shorter test."
)


@dataclass(kw_only=True, eq=False)
class Job:
    """One piece of work, from its start to its outcome."""

    state: str = "waiting"  # Then "running"; at the end "finished", "refused" or "cancelled"
    task: str = ""  # Which part is under way
    progress: float = 0.0  # Share of the part that is complete
    outcome: Any = None
    refusal: str = ""  # Why there is no outcome, a sentence for the user
    news: list[Any] = field(default_factory=list)  # Intermediate results, the latest last
    worker: "_Worker | None" = None

    @property
    def is_over(self) -> bool:
        """Whether nothing more will come."""
        return self.state not in ("waiting", "running")


class _Worker:
    """A process that waits for work."""

    def __init__(self, folder: str) -> None:
        self.channel, far_end = _SPAWN.Pipe()
        self.process = _SPAWN.Process(target=work_through, args=(far_end, folder), daemon=True)
        self.process.start()
        far_end.close()  # so that the end of the process is the end of the messages

    def stop(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.join()


class Jobs:
    """Workers and what they do; work beyond their number waits."""

    def __init__(self, folder: str) -> None:
        self._folder = folder
        self._idle: list[_Worker] = []
        self._all: set[_Worker] = set()
        self._room = threading.Semaphore(MOST_WORKERS)
        self._lock = threading.Lock()
        self._closed = False
        self._idle.append(self._new_worker())

    def start(self, work: Callable[..., Any], /, **arguments: Any) -> Job:  # noqa: ANN401 - of the work
        """Start a function of a module in a worker; it may take `tell` to send intermediate results."""
        job = Job()
        threading.Thread(target=self._perform, args=(job, work, arguments), daemon=True).start()
        return job

    def cancel(self, job: Job) -> None:
        """End a piece of work at once."""
        with self._lock:
            if job.is_over:
                return
            job.state = "cancelled"
            worker = job.worker
        if worker is not None:
            worker.stop()

    def close(self) -> None:
        """End all work."""
        with self._lock:
            self._closed = True
            workers = tuple(self._all)
        for worker in workers:
            worker.stop()
        for worker in self._idle:
            worker.channel.close()

    def _new_worker(self) -> _Worker:
        worker = _Worker(self._folder)
        self._all.add(worker)
        return worker

    def _take_worker(self, job: Job) -> _Worker | None:
        with self._lock:
            if job.is_over or self._closed:
                return None
            job.worker = worker = self._idle.pop() if self._idle else self._new_worker()
            job.state = "running"
            return worker

    def _give_back(self, worker: _Worker, *, is_idle: bool) -> None:
        with self._lock:
            if is_idle:
                self._idle.append(worker)
                return
            self._all.discard(worker)
            worker.channel.close()
            if not self._idle and not self._closed:  # so that the next work finds one that is ready
                self._idle.append(self._new_worker())

    def _perform(self, job: Job, work: Callable[..., Any], arguments: Mapping[str, Any]) -> None:
        with self._room:
            worker = self._take_worker(job)
            if worker is None:
                return
            is_idle = False
            try:
                worker.channel.send((work, arguments))
                while not job.is_over:
                    _take_message(job, *worker.channel.recv())
                is_idle = job.state != "cancelled"
            except (EOFError, OSError, ValueError, UnpicklingError):
                with self._lock:
                    if not job.is_over:
                        job.refusal, job.state = _ENDED, "refused"
                worker.stop()
            finally:
                self._give_back(worker, is_idle=is_idle)


def _take_message(job: Job, kind: str, content: Any) -> None:  # noqa: ANN401 - of many kinds
    if kind == "progress":
        job.task, job.progress = content
    elif kind == "news":
        job.news.append(content)
    elif not job.is_over:
        setattr(job, "outcome" if kind == "finished" else "refusal", content)
        job.state = kind


_KEY: Final = re.compile(r"[A-Za-z0-9_-]{16,64}")
_MOST_TABS: Final = 50


@dataclass(kw_only=True, eq=False)
class PageMemory:
    """What one page of one tab remembers."""

    values: dict[str, Any] = field(default_factory=dict)  # Of its fields
    files: list[Path] = field(default_factory=list)  # That were dropped on it
    jobs: dict[str, Job] = field(default_factory=dict)  # By what they are for
    place: Path | None = None  # Folder of its results


class Memories:
    """Pages by tab; the tabs that were not used for longest are forgotten first."""

    def __init__(self) -> None:
        self._tabs: OrderedDict[str, dict[str, PageMemory]] = OrderedDict()
        self._lock = threading.Lock()

    def find_tab(self, key: str) -> tuple[str, dict[str, PageMemory]]:
        """Return the pages of a tab by its key, which is made where it is none that the desk gave."""
        with self._lock:
            if not _KEY.fullmatch(key) or key not in self._tabs:
                key = secrets.token_urlsafe(16)
                self._tabs[key] = {}
            self._tabs.move_to_end(key)
            while len(self._tabs) > _MOST_TABS:
                self._tabs.popitem(last=False)
            return key, self._tabs[key]
