"""Whole sweeps from files to the store: time, memory, threads, workers, cost against motions.

python tests/benchmarks/sweeps.py [SOURCE ...]
"""

import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path

from reliab.motions import MotionSuite, load_motions
from reliab.sweep import ExplicitGrid, SweepRequest, run_sweep

FREQUENCIES = (0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0)
DAMPING_RATIOS = (0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.10)


def timed(
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


def on_cluster(suite: MotionSuite, request: SweepRequest, workers: int) -> float:
    """Time of a sweep on a local dask cluster whose workers have loaded their kernels [s]."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as cluster:
        timed(suite[: 2 * workers], request, None, cluster.scheduler_address)
        return timed(suite, request, None, cluster.scheduler_address)


def main() -> None:
    suite = load_motions(*(sys.argv[1:] or ["synthetic"]))
    paper = SweepRequest(frequencies=FREQUENCIES, damping_ratios=(0.02,), grid=ExplicitGrid())
    full = SweepRequest(frequencies=FREQUENCIES, damping_ratios=DAMPING_RATIOS)
    timed(suite[:2], paper, None)  # compiles
    print(f"{len(suite)} motions")
    for name, request in (("paper's grid x 8 frequencies", paper), ("scaled grid x 8 x 9", full)):
        print(f"{name}: {timed(suite, request, None):.2f} s, on one thread {timed(suite, request, 1):.2f} s")
    for count in (12, 25, 50, len(suite)):
        print(f"paper's grid, {count} motions: {timed(suite[:count], paper, None):.2f} s")
    for workers in (1, 2, 4):
        print(f"paper's grid, dask, {workers} workers: {on_cluster(suite, paper, workers):.2f} s")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"peak memory {peak:.2f} GB")


if __name__ == "__main__":
    main()
