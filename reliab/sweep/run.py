"""Sweeps over many ground motions, here or on a dask.distributed cluster, stored motion by motion.

A store is first created empty under a temporary name and then renamed, so that it never exists in part. One
process holds the store: threads and workers of a cluster hand it the chunks that they encoded. Every chunk
carries a checksum (CRC-32C) and is written at once or not at all.
Within a quarter of a second after a motion's results its entry is written: data on the record, and the digest
of the results, which shows that they are complete; `--resume` verifies each digest and solves again what does
not match. When all motions are done, the journal is copied into the coordinates. A store that was interrupted
and resumed holds the same bytes as one that was not: nothing in it depends on time or order.
"""

import contextlib
import errno
import hashlib
import json
import os
import tempfile
import time
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import closing
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, islice, zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import zarr
from numpy.typing import NDArray

from reliab.core.errors import IncompleteError, InputError
from reliab.core.files import UNFINISHED, decoding, lock_for_writing, refuse_unwritable, remove_abandoned
from reliab.core.progress import Progress, silent
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite
from reliab.sweep.request import SweepRequest
from reliab.sweep.store_layout import (
    COMPLETE_NOTE,
    JOURNAL,
    RECORD_FIELDS,
    SCHEMA_VERSION,
    VARIABLES,
    MotionResults,
    array_of,
    chunk_path,
    consolidate,
    create_store,
    encode,
    group_names,
    open_group,
    read_attributes,
    shapes,
    solve_motion,
    write_chunk,
)

if TYPE_CHECKING:
    from distributed import Client, Future as RemoteFuture


_RULE = "A store can be resumed only if it is complete except for results of motions"
_JOURNAL_EVERY = 0.25  # s; what a kill costs at most, beside motions that are being solved
_REMEDY = "Simulate again to another store"
_UNWRITABLE = "Cannot write to the folder of a results store"


@dataclass(frozen=True, kw_only=True)
class EncodedMotion:
    """Results of one motion in the bytes that a store holds, made where they were computed."""

    index: int  # Place in the suite
    name: str
    entry: str  # In the journal
    windows: list[dict[str, bytes]]  # Chunk of each variable, for each window

    @classmethod
    def from_results(cls, index: int, motion: Motion, results: Sequence[MotionResults]) -> "EncodedMotion":
        """Encode the results of one motion, one for each window."""
        windows = [{name: getattr(result, name) for name in VARIABLES} for result in results]
        entry = {
            "duration": motion.duration,
            "dt": motion.time_step,
            "pga": motion.peak_acceleration,
            "checksum": motion.checksum,
            "digest": _digest([list(variables.values()) for variables in windows]),
        }
        return cls(
            index=index,
            name=motion.name,
            entry=json.dumps(entry),
            windows=[{name: encode(values) for name, values in variables.items()} for variables in windows],
        )


class ResultsStore:
    """A store of results that is held by this process alone, which keeps its journal.

    Use :meth:`open` to create or resume one.
    """

    def __init__(self, path: Path, request: SweepRequest) -> None:
        self.path = path
        self.request = request
        self._group = open_group(path, "r+")
        self._unwritten: dict[int, str] = {}
        self._journal_written = time.monotonic()

    @classmethod
    @contextlib.contextmanager
    def open(
        cls, path: Path, request: SweepRequest, names: Sequence[str], events: Sequence[str], *, resume: bool
    ) -> Iterator["ResultsStore"]:
        """Create a store, or open an unfinished one, and keep every other process from writing to it."""
        with refuse_unwritable(_UNWRITABLE, where=path.parent):
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=path.parent):
                pass
        with lock_for_writing(path, "Only one process may write to a results store"):
            if path.exists():
                _check_resumable(path, request, names, resume=resume)
                remove_abandoned([*path.rglob(f"{UNFINISHED}*"), *path.rglob("*.partial")])  # ours and Zarr's
            else:
                with refuse_unwritable(_UNWRITABLE, where=path, remedy="Make room, or name another folder"):
                    create_store(path, request, names, events)
            with contextlib.closing(cls(path, request)) as store:
                yield store

    def complete(self) -> list[bool]:
        """Tell for each motion whether its results are complete and undamaged."""
        with decoding(_RULE, remedy=_REMEDY, where=self.path):
            return [
                bool(entry) and json.loads(entry)["digest"] == self._digest_on_disk(index)
                for index, entry in enumerate(self._journal())
            ]

    def enter(self, motion: EncodedMotion) -> None:
        """Write the results of a motion, and enter it in the journal."""
        with self._safe(f"at {motion.name}"):
            groups = zip(group_names(self.request), self._arrays, motion.windows, strict=True)
            for group, arrays, chunks in groups:
                for name, chunk in chunks.items():
                    write_chunk(self.path, chunk_path(Path(group, name), arrays[name], motion.index), chunk)
            self._unwritten[motion.index] = motion.entry
            if time.monotonic() - self._journal_written >= _JOURNAL_EVERY:
                self._write_journal()

    def _write_journal(self) -> None:
        """Write the entries of motions whose results are stored."""
        if self._unwritten:
            motions = sorted(self._unwritten)
            entries = [self._unwritten[motion] for motion in motions]
            self._journal_array.oindex[motions] = np.array(entries, dtype=np.dtypes.StringDType())
        self._unwritten, self._journal_written = {}, time.monotonic()

    def close(self) -> None:
        """Write what the journal still lacks, also after an interruption."""
        with contextlib.suppress(OSError):
            self._write_journal()

    def finish(self) -> None:
        """Copy the journal's data on the records into the coordinates, and say that all are done."""
        with self._safe("at its end"):
            self._write_journal()
        entries = [json.loads(entry) for entry in self._journal()]
        with self._safe("at its end"):
            for group in self._windows:
                for name, dtype in RECORD_FIELDS.items():
                    kind: Any = np.dtypes.StringDType() if dtype is str else dtype
                    array_of(group, name)[:] = np.array([entry[name] for entry in entries], dtype=kind)
                group.attrs["status"] = COMPLETE_NOTE
            consolidate(self.path, group_names(self.request))

    @contextlib.contextmanager
    def _safe(self, location: str) -> Iterator[None]:
        """Turn a failure of the disk into an error that states which results are stored."""
        try:
            yield
        except OSError as error:
            self.close()
            reason = "the disk is full" if error.errno == errno.ENOSPC else str(error)
            raise IncompleteError(
                f"Writing {self.path} failed {location}: {reason}. The results of {sum(self.complete())} "
                "motions are safe; make room and run the same command with `resume`."
            ) from error
        except Exception as error:  # of a library that reads edited descriptions of arrays
            raise InputError(_RULE, value=str(error), remedy=_REMEDY, where=str(self.path)) from error

    def _journal(self) -> list[str]:
        return [str(entry) for entry in np.asarray(self._journal_array[:])]

    @cached_property
    def _journal_array(self) -> Any:  # noqa: ANN401 - an array of text
        return array_of(self._group, JOURNAL)

    @cached_property
    def _windows(self) -> list[zarr.Group]:
        return [open_group(self.path / name, "r+") for name in group_names(self.request)]

    @cached_property
    def _arrays(self) -> list[dict[str, Any]]:
        """Arrays of each window by name, opened once."""
        return [{name: array_of(group, name) for name in VARIABLES} for group in self._windows]

    def _digest_on_disk(self, index: int) -> str:
        """Digest of the stored results of one motion; empty where a chunk is damaged."""
        try:
            return _digest([[array[index] for array in arrays.values()] for arrays in self._arrays])
        except (ValueError, RuntimeError, OSError):
            return ""


def _digest(windows: Sequence[Sequence[NDArray[np.generic]]]) -> str:
    """SHA-256 of the results of one motion."""
    digest = hashlib.sha256()
    for variables in windows:
        for values in variables:
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def _check_resumable(path: Path, request: SweepRequest, names: Sequence[str], *, resume: bool) -> None:
    if not resume:
        raise InputError(
            f"{path} exists already",
            remedy="Continue it with `resume`, remove it, or name another",
        )
    attributes = read_attributes(path)
    if attributes["schema_version"] != SCHEMA_VERSION:
        raise InputError(
            f"Only a store of schema version {SCHEMA_VERSION} can be resumed",
            value=f"version {attributes['schema_version']} in {path}, which can be read where it is complete",
            remedy="Simulate again to another store, or finish it with the version of reliab that began it",
        )
    if attributes.get("study_hash") != request.digest():
        raise InputError(
            f"{path} holds a sweep of other structures, actuators, windows or another engine",
            remedy="Give the options of the first run, or name another store",
        )
    with decoding(_RULE, remedy=_REMEDY, where=path):
        group = open_group(path)
        motions = array_of(group, "motion").shape[0]
        if motions == len(names):
            _check_shapes(group, request, motions)
            stored_motions = [str(name) for name in np.asarray(array_of(group, "motion")[:])]
        else:
            stored_motions = []
    if stored_motions != list(names):
        raise InputError(
            f"{path} holds {motions} motions, not the {len(names)} that you gave",
            remedy="Give the motions of the first run, or name another store",
        )


def _check_shapes(group: zarr.Group, request: SweepRequest, motions: int) -> None:
    """Check that arrays have the shapes in which they are written, one motion in a chunk of results."""
    for name, shape in shapes(request, motions).items():
        array = array_of(group, name)
        sound = array.chunks == (1, *shape[1:]) if len(shape) > 1 else array.chunks <= shape
        if array.shape != shape or not sound:
            size = f"{name} of shape {array.shape} in chunks of {array.chunks} instead of {shape}"
            raise InputError(_RULE, value=size, remedy=_REMEDY)


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
