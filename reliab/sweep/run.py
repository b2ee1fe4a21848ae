"""Sweeps over many ground motions: on threads here, or on a dask.distributed cluster, some motions a task."""

import os
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import dataclass
from itertools import groupby, islice, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.core.errors import IncompleteError, InputError
from reliab.core.progress import Progress, silent
from reliab.motions.suite import MotionSuite
from reliab.sweep.request import SweepRequest
from reliab.sweep.solve import solve_motion
from reliab.sweep.store import EncodedMotion, ResultsStore

if TYPE_CHECKING:
    from distributed import Client, Future as RemoteFuture

_TASKS_PER_WORKER = 2  # tasks submitted per worker; limits the memory
_TASKS_PER_THREAD = 4  # tasks submitted per thread of the cluster; limits its memory
# Of a thread's part of the motions that are in no task yet, and the most motions of a task: each costs the
# scheduler and this process some 5 ms, and the last ones should end together.
_SHARE_OF_TASK, _MOST_OF_TASK = 1 / 2, 8
_RETRIES = 3  # of a task whose worker died
_CONNECT_SECONDS = 10


@dataclass(frozen=True, kw_only=True)
class SweepJob:
    """A suite of motions, and the request for it."""

    motions: MotionSuite  # The suite
    request: SweepRequest  # Structures, actuators and windows

    def solve(self, index: int) -> EncodedMotion:
        """Read and simulate one motion, and encode its results."""
        motion = self.motions[index]
        return EncodedMotion.from_results(index, motion, solve_motion(motion, self.request))

    def solve_several(self, indices: Sequence[int]) -> list[EncodedMotion]:
        """Solve the motions of one task."""
        return [self.solve(index) for index in indices]


def run_sweep(
    motions: MotionSuite,
    request: SweepRequest,
    path: str | Path,
    *,
    resume: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> Path:
    """Simulate a suite and store the results.

    `motions`: the ground motions, read one at a time; `workers`: threads; one for each processor by default;
    `scheduler`: address of a dask.distributed scheduler that solves the motions instead.
    """
    path = Path(path)
    with ResultsStore.open(path, request, motions.names, motions.events, resume=resume) as store:
        complete = store.complete()
        missing = [index for index, is_complete in enumerate(complete) if not is_complete]
        progress(len(complete) - len(missing), len(complete))
        job = SweepJob(motions=motions, request=request)
        with closing(
            _solve_on_cluster(scheduler, job, missing)
            if scheduler
            else _solve_on_threads(workers, job, missing)
        ) as solutions:
            for finished_count, motion in enumerate(solutions, start=len(complete) - len(missing) + 1):
                store.enter(motion)
                progress(finished_count, len(complete))
        store.finish()
    return path


def _solve_on_threads(workers: int | None, job: SweepJob, missing: list[int]) -> Generator[EncodedMotion]:
    """Solve motions on the processors of this machine."""
    threads = workers or os.cpu_count() or 1
    queue = iter(_side_by_side(missing, job.motions.events, threads))
    waiting: list[Future[EncodedMotion]] = []
    with ThreadPoolExecutor(threads) as pool:
        try:
            while True:
                next_tasks = islice(queue, _TASKS_PER_WORKER * threads - len(waiting))
                waiting += [pool.submit(job.solve, index) for index in next_tasks]
                if not waiting:
                    return
                finished_tasks, _ = wait(waiting, return_when=FIRST_COMPLETED)
                yield from (future.result() for future in waiting if future in finished_tasks)
                waiting = [future for future in waiting if future not in finished_tasks]
        finally:
            for future in waiting:
                future.cancel()


def _side_by_side(missing: list[int], events: Sequence[str], threads: int) -> list[int]:
    """Put motions of different earthquakes side by side, one for each thread.

    Motions of one earthquake are simulated together, or read from one file, for which a thread would wait.
    """
    earthquakes = [list(motions) for _, motions in groupby(missing, lambda index: events[index])]
    return [
        index
        for begin in range(0, len(earthquakes), threads)
        for motions in zip_longest(*earthquakes[begin : begin + threads])
        for index in motions
        if index is not None
    ]


def _divide_into_tasks(missing: list[int], events: Sequence[str], threads: int) -> Iterator[list[int]]:
    """Divide motions into tasks, shorter towards the end, which end between earthquakes if they can."""
    begin = 0
    while begin < len(missing):
        size = int(_SHARE_OF_TASK * (len(missing) - begin) / threads)
        end = longest = begin + min(max(1, size), _MOST_OF_TASK)
        while begin < end < len(missing) and events[missing[end - 1]] == events[missing[end]]:
            end -= 1
        end = end if end > begin else longest
        yield missing[begin:end]
        begin = end


def _solve_on_cluster(address: str, job: SweepJob, missing: list[int]) -> Generator[EncodedMotion]:
    """Solve motions on a cluster."""
    with _connect(address) as client:
        from distributed import as_completed

        shared = client.scatter(job, broadcast=True)

        def submit(indices: Sequence[int]) -> object:
            return client.submit(SweepJob.solve_several, shared, indices, retries=_RETRIES, pure=False)

        threads = max(1, sum(client.nthreads().values()))
        queue = _divide_into_tasks(missing, job.motions.events, threads)
        running = as_completed([submit(indices) for indices in islice(queue, _TASKS_PER_THREAD * threads)])
        for future in running:
            yield from _take_results(future)
            future.release()
            for indices in islice(queue, 1):
                running.add(submit(indices))


def _take_results(future: "RemoteFuture[list[EncodedMotion]]") -> list[EncodedMotion]:
    """Take what a worker answered; results that were stored before are safe where none did."""
    from distributed import CancelledError, KilledWorker

    try:
        solutions: list[EncodedMotion] = future.result()
    except (CancelledError, KilledWorker, OSError) as error:
        reason = str(error).partition("\n")[0].rstrip(".")
        raise IncompleteError(
            f"The cluster failed: {reason}. Results that were stored are safe; start it again and run the "
            "same command with `resume`."
        ) from error
    return solutions


def _connect(address: str) -> "Client":
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "A scheduler needs dask.distributed, which is not installed",
            remedy="Install it with: pip install 'reliab[cluster]'",
        ) from None
    try:
        return Client(address, timeout=_CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"No dask scheduler answers at {address}: {error}",
            remedy="Start one with 'dask scheduler' and give its address, tcp://host:8786",
        ) from None
