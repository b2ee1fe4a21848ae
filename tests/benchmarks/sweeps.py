"""Whole sweeps from files to the store: time, memory, threads, workers, cost against motions.

What a second processor adds at most is shown by two processes that share nothing, each of which solves the
whole suite on one thread while the other does; two threads and two workers are stated beside it. Ways are
taken in turns, since clocks of a machine change, and the shortest turn of each is printed: its time, the
processor time of all that took part, and the share of the machine that other programs had meanwhile. Where
that is more than a few per cent only the processor time means something. Ratios of times follow: what two
threads and two workers add, and what share that is of what two processes add. It takes some three minutes.

python tests/benchmarks/sweeps.py [SOURCE ...]
"""

import multiprocessing
import resource
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import psutil

from reliab.motions.loading import load_motions
from reliab.motions.suite import MotionSuite
from reliab.sweep.request import ExplicitGrid, SweepRequest
from reliab.sweep.run import run_sweep

FREQUENCIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
DAMPING_RATIOS = (0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.10)
TURNS = 3


def time_sweep(
    suite: MotionSuite, request: SweepRequest, workers: int | None, scheduler: str | None = None
) -> float:
    """Time of a sweep [s]."""
    folder = Path(tempfile.mkdtemp())
    try:
        start = time.perf_counter()
        run_sweep(suite, request, folder / "results.zarr", workers=workers, scheduler=scheduler)
        return time.perf_counter() - start
    finally:
        shutil.rmtree(folder)


class Machine:
    """Two processes and two local clusters, of one and two workers, which have loaded their kernels."""

    def __init__(self, suite: MotionSuite, request: SweepRequest) -> None:
        import dask
        from distributed import LocalCluster

        dask.config.set({"distributed.nanny.pre-spawn-environ": {"MALLOC_TRIM_THRESHOLD_": 1 << 28}})
        self.processes = ProcessPoolExecutor(2, multiprocessing.get_context("spawn"))
        self.clusters = [
            LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
            for workers in (1, 2)
        ]
        self.sweep_in_two_processes(suite[:4], request)
        for cluster in self.clusters:
            time_sweep(suite[:8], request, None, cluster.scheduler_address)

    def sweep_in_two_processes(self, suite: MotionSuite, request: SweepRequest) -> float:
        """Time in which two processes each solve the whole suite on one thread [s]."""
        start = time.perf_counter()
        both = [self.processes.submit(time_sweep, suite, request, 1) for _ in range(2)]
        for future in both:
            future.result()
        return time.perf_counter() - start

    def ways(self, suite: MotionSuite, request: SweepRequest) -> dict[str, Callable[[], float]]:
        """Ways to solve a sweep by name, each of which returns the time of one sweep [s]."""
        addresses = [cluster.scheduler_address for cluster in self.clusters]
        return {
            "one thread": lambda: time_sweep(suite, request, 1),
            "two threads": lambda: time_sweep(suite, request, 2),
            "two processes, half their time": lambda: self.sweep_in_two_processes(suite, request) / 2.0,
            "dask, one worker": lambda: time_sweep(suite, request, None, addresses[0]),
            "dask, two workers": lambda: time_sweep(suite, request, None, addresses[1]),
        }


class Turn(NamedTuple):
    """What one turn of a way took."""

    seconds: float  # Time of one sweep
    processor: float  # Processor time of this process and of those that it started [s]
    share_of_others: float  # Share of the machine's processor time that other programs had

    def __str__(self) -> str:
        return (
            f"{self.seconds:.2f} s, {self.processor:.2f} s of processors (others {self.share_of_others:.0%})"
        )


def shortest(ways: Mapping[str, Callable[[], float]]) -> dict[str, Turn]:
    """Shortest turn of each way."""
    turns = [{name: one_turn(way) for name, way in ways.items()} for _ in range(TURNS)]
    return {name: min(turn[name] for turn in turns) for name in ways}


def one_turn(way: Callable[[], float]) -> Turn:
    """Take a way once."""
    start, (everybody, own_start) = time.perf_counter(), processor_times()
    seconds = way()
    wall, end = time.perf_counter() - start, processor_times()
    processor = end[1] - own_start
    share_of_others = (end[0] - everybody - processor) / (psutil.cpu_count() * wall)
    return Turn(seconds, processor, max(share_of_others, 0.0))


def processor_times() -> tuple[float, float]:
    """Processor time of everybody, and of this process and those that it started [s]."""
    everybody, this_process = psutil.cpu_times(), psutil.Process()
    times = [process.cpu_times() for process in (this_process, *this_process.children(recursive=True))]
    total = sum(item.user + item.system for item in times)
    return everybody.user + everybody.nice + everybody.system, total


def print_ratios(name: str, turns: Mapping[str, Turn]) -> None:
    """State what two threads and two workers add to one, beside what two processes add."""
    single, threads, processes, worker, workers = (turn.seconds for turn in turns.values())
    ceiling = single / processes
    print(
        f"{name}: two processes {ceiling:.2f} times one thread; two threads {single / threads:.2f} times, "
        f"{processes / threads:.0%} of that; dask, two workers {worker / workers:.2f} times one worker "
        f"(efficiency {worker / workers / 2.0:.2f}, {worker / workers / ceiling:.0%} of what two processes "
        f"add) and {single / workers:.2f} times one thread ({processes / workers:.0%})"
    )


def main() -> None:
    suite = load_motions(*(sys.argv[1:] or ["synthetic"]))
    paper = SweepRequest(frequencies=FREQUENCIES, damping_ratios=(0.02,), grid=ExplicitGrid())
    scaled_grid = SweepRequest(frequencies=FREQUENCIES, damping_ratios=(0.02,))
    factorial = SweepRequest(frequencies=FREQUENCIES, damping_ratios=DAMPING_RATIOS)
    time_sweep(suite[:2], paper, None)  # compiles
    machine = Machine(suite, paper)
    print(f"{len(suite)} motions")
    for name, request in (("paper's grid", paper), ("scaled grid with leads", scaled_grid)):
        turns = shortest(machine.ways(suite, request))
        for way, turn in turns.items():
            print(f"{name} x 8 frequencies, {way}: {turn}")
        print_ratios(f"{name} x 8 frequencies", turns)
    print(f"scaled grid x 72 structures, two threads: {one_turn(lambda: time_sweep(suite, factorial, 2))}")
    for count in (12, 25, 50, len(suite)):
        print(f"paper's grid, {count} motions: {time_sweep(suite[:count], paper, None):.2f} s")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"peak memory {peak:.2f} GB")


if __name__ == "__main__":
    main()
