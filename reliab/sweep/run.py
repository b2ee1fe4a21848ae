"""Sweeps over many ground motions: with threads here, or on a cluster with one task per motion."""

import os
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from pathlib import Path

from reliab.motions import MotionSuite
from reliab.progress import Progress, silent
from reliab.sweep.job import SweepJob
from reliab.sweep.request import SweepRequest
from reliab.sweep.store import ResultsStore

_AHEAD = 2  # tasks submitted per worker; limits the memory


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
                for index in islice(queue, _AHEAD * threads - len(waiting)):
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
    store.write(*job.solve(index))


def _on_cluster(address: str, job: SweepJob, store: ResultsStore, missing: list[int]) -> Iterator[None]:
    """Solve motions on a cluster and store the results on this computer."""
    from reliab.sweep.cluster import solved

    for solution in solved(address, job, missing):
        store.write(*solution)
        yield
