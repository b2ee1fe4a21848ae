"""Sweeps on a dask.distributed cluster (optional extra `cluster`): one task per motion."""

from collections.abc import Iterator
from itertools import islice
from typing import TYPE_CHECKING

from reliab.errors import IncompleteError, InputError
from reliab.sweep.job import Solved, SweepJob

if TYPE_CHECKING:
    from distributed import Client, Future

_AHEAD = 4  # tasks submitted per worker thread; limits the memory of the cluster
_RETRIES = 3  # of a task whose worker died
_CONNECT_SECONDS = 10


def solved(address: str, job: SweepJob, missing: list[int]) -> Iterator[Solved]:
    """Solve motions on a cluster."""
    with _connected(address) as client:
        from distributed import as_completed

        shared = client.scatter(job, broadcast=True)

        def submit(index: int) -> object:
            return client.submit(SweepJob.solve, shared, index, retries=_RETRIES, pure=False)

        queue = iter(missing)
        ahead = _AHEAD * max(1, sum(client.nthreads().values()))
        running = as_completed([submit(index) for index in islice(queue, ahead)])
        for future in running:
            yield _result(future)
            future.release()
            for index in islice(queue, 1):
                running.add(submit(index))


def _result(future: "Future[Solved]") -> Solved:
    """Take what a worker answered; results that were stored before are safe where none did."""
    from distributed import CancelledError, KilledWorker

    try:
        solution: Solved = future.result()
    except (CancelledError, KilledWorker, OSError) as error:
        reason = str(error).partition("\n")[0].rstrip(".")
        raise IncompleteError(
            f"The cluster failed: {reason}. Results that were stored are safe; start it again and run the "
            "same command with `resume`."
        ) from error
    return solution


def _connected(address: str) -> "Client":
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
