"""Sweeps over many ground motions: on threads here, or on a dask.distributed cluster, some motions a task."""

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from reliab.errors import IncompleteError, InputError
from reliab.motions import MotionSuite
from reliab.progress import Progress, silent
from reliab.sweep.request import SweepRequest
from reliab.sweep.solve import solve_motion
from reliab.sweep.store import EncodedMotion, ResultsStore

if TYPE_CHECKING:
    from distributed import Client, Future as RemoteFuture

_TASKS_PER_WORKER = 2  # tasks submitted per worker; limits the memory
_TASKS_PER_THREAD = 4  # tasks submitted per thread of the cluster; limits its memory
# Of the motions of a thread in a task, and the most of them: each task costs the scheduler and this process
# some 5 ms, and the last ones should end together.
_SHARE_OF_TASK, _MOST_OF_TASK = 1 / 16, 8
_RETRIES = 3  # of a task whose worker died
_CONNECT_SECONDS = 10


@dataclass(frozen=True, kw_only=True)
class SweepJob:
    """A suite of motions and the request for it."""

    motions: MotionSuite  # The suite
    request: SweepRequest  # Structures, actuators and windows

    def solve(self, index: int) -> EncodedMotion:
        """Read and simulate one motion, and encode its results for the store."""
        motion = self.motions[index]
        return EncodedMotion.of_results(index, motion, solve_motion(motion, self.request))

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

    Parameters
    ----------
    motions : MotionSuite
        The ground motions, read one at a time.
    request : SweepRequest
        Structures, actuators and windows.
    path : str or pathlib.Path
        The Zarr store to write.
    resume : bool, optional
        Whether to continue an unfinished store.
    workers : int, optional
        Threads; one for each processor by default.
    scheduler : str, optional
        Address of a dask.distributed scheduler that solves the motions instead.
    progress : callable, optional
        Called after each motion.

    Returns
    -------
    pathlib.Path
        The store.

    Raises
    ------
    InputError
        If a record is bad or the store cannot be written to.
    IncompleteError
        If the disk is full; results stored before remain valid.
    """
    path = Path(path)
    with ResultsStore.opened(path, request, motions.names, motions.events, resume=resume) as store:
        complete = store.complete()
        missing = [index for index, done in enumerate(complete) if not done]
        progress(len(complete) - len(missing), len(complete))
        job = SweepJob(motions=motions, request=request)
        steps = (
            _on_cluster(scheduler, job, store, missing)
            if scheduler
            else _on_threads(workers, job, store, missing)
        )
        for finished, _ in enumerate(steps, start=len(complete) - len(missing) + 1):
            progress(finished, len(complete))
        store.finish()
    return path


def _on_threads(
    workers: int | None, job: SweepJob, store: ResultsStore, missing: list[int]
) -> Iterator[None]:
    """Solve and store motions on the processors of this machine."""
    threads = workers or os.cpu_count() or 1
    queue = iter(missing)
    waiting: set[Future[None]] = set()
    with ThreadPoolExecutor(threads) as pool:
        try:
            while True:
                for index in islice(queue, _TASKS_PER_WORKER * threads - len(waiting)):
                    waiting.add(pool.submit(_solve_and_store, job, store, index))
                if not waiting:
                    return
                done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        finally:
            for future in waiting:
                future.cancel()


def _solve_and_store(job: SweepJob, store: ResultsStore, index: int) -> None:
    store.write(job.solve(index))


def _on_cluster(address: str, job: SweepJob, store: ResultsStore, missing: list[int]) -> Iterator[None]:
    """Solve and encode motions on a cluster and write the results on this computer."""
    for solution in _solve_on_cluster(address, job, missing):
        store.write(solution)
        yield


def _solve_on_cluster(address: str, job: SweepJob, missing: list[int]) -> Iterator[EncodedMotion]:
    """Solve motions on a cluster."""
    with _connect(address) as client:
        from distributed import as_completed

        shared = client.scatter(job, broadcast=True)

        def submit(indices: Sequence[int]) -> object:
            return client.submit(SweepJob.solve_several, shared, indices, retries=_RETRIES, pure=False)

        threads = max(1, sum(client.nthreads().values()))
        size = min(max(1, int(_SHARE_OF_TASK * len(missing) / threads)), _MOST_OF_TASK)
        queue = iter([missing[begin : begin + size] for begin in range(0, len(missing), size)])
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
            "A scheduler needs dask.distributed",
            value="not installed",
            remedy="Install it with: pip install 'reliab[cluster]'",
        ) from None
    try:
        return Client(address, timeout=_CONNECT_SECONDS)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            "A dask scheduler must answer at the address",
            value=f"{address} ({error})",
            remedy="Start one with 'dask scheduler' and give its address, tcp://host:8786",
        ) from None
