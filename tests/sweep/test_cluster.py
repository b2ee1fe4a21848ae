"""A cluster gives the results of this machine, and outlives its workers."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager

import pytest

from reliab.core.errors import IncompleteError, InputError
from reliab.sweep.results import open_results
from reliab.sweep.run import run_sweep

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")


@contextmanager
def cluster(*, processes):
    """Two workers: processes of their own, which start slowly, or threads of this one."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=processes, protocol="tcp", dashboard_address=None
    ) as workers:
        yield workers


@pytest.mark.filterwarnings("ignore")  # dask's own shutdown is noisy
def test_a_cluster_writes_the_bytes_of_this_machine(tmp_path, suite, request_, store, contents):
    with cluster(processes=False) as threads:
        path = run_sweep(suite, request_, tmp_path / "remote.zarr", scheduler=threads.scheduler_address)
    assert contents(path) == contents(store)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_a_cluster_writes_the_same_bytes_even_when_a_worker_dies(tmp_path, suite, request_, store, contents):
    victim = []

    with cluster(processes=True) as workers:

        def kill_one(step: int, _: int) -> None:
            if step == 1 and not victim:
                worker = next(iter(workers.workers.values()))
                victim.append(worker.pid)
                os.kill(worker.pid, signal.SIGKILL)

        path = run_sweep(
            suite, request_, tmp_path / "remote.zarr", scheduler=workers.scheduler_address, progress=kill_one
        )
    assert victim
    assert contents(path) == contents(store)


SCHEDULER = """
import sys, time
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, protocol="tcp", dashboard_address=None) as workers:
        print(workers.scheduler_address, flush=True)
        sys.stdin.read()
"""


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_sweep_resumes_after_scheduler_dies(tmp_path, suite, request_, store):
    (tmp_path / "scheduler.py").write_text(SCHEDULER)
    process = subprocess.Popen(  # noqa: S603 - the lines above
        [sys.executable, str(tmp_path / "scheduler.py")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    address = process.stdout.readline().decode().strip()

    def kill_all(step: int, _: int) -> None:
        if step == 1 and process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()

    with (
        dask.config.set({"distributed.comm.timeouts.connect": "2s"}),
        pytest.raises(IncompleteError, match=r"cluster failed.*`resume`"),
    ):
        run_sweep(suite, request_, tmp_path / "remote.zarr", scheduler=address, progress=kill_all)
    run_sweep(suite, request_, tmp_path / "remote.zarr", resume=True)
    assert open_results(tmp_path / "remote.zarr").identical(open_results(store))


def test_silent_scheduler_is_named(tmp_path, suite, request_, monkeypatch):
    monkeypatch.setattr("reliab.sweep.run._CONNECT_SECONDS", 0.5)
    with pytest.raises(InputError, match=r"tcp://127\.0\.0\.1:1"):
        run_sweep(suite, request_, tmp_path / "results.zarr", scheduler="tcp://127.0.0.1:1")
