"""A cluster gives the results of this machine, and outlives its workers."""

import os
import signal

import pytest

from reliab.errors import InputError
from reliab.sweep import open_results, run_sweep

distributed = pytest.importorskip("distributed")


@pytest.fixture
def cluster():
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
    ) as cluster:
        yield cluster


@pytest.mark.filterwarnings("ignore")  # dask's own shutdown is noisy
def test_cluster_gives_the_local_results_even_when_a_worker_dies(tmp_path, suite, request_, cluster):
    local = open_results(run_sweep(suite, request_, tmp_path / "local.zarr"))
    killed = []

    def kill_one(done: int, _: int) -> None:
        if done == 1 and not killed:
            worker = next(iter(cluster.workers.values()))
            killed.append(worker.pid)
            os.kill(worker.pid, signal.SIGKILL)

    path = run_sweep(
        suite, request_, tmp_path / "remote.zarr", scheduler=cluster.scheduler_address, progress=kill_one
    )
    assert killed
    assert open_results(path).identical(local)


def test_scheduler_that_does_not_answer_is_named(tmp_path, suite, request_, monkeypatch):
    monkeypatch.setattr("reliab.sweep.cluster._CONNECT_SECONDS", 0.5)
    with pytest.raises(InputError, match=r"tcp://127\.0\.0\.1:1"):
        run_sweep(suite, request_, tmp_path / "results.zarr", scheduler="tcp://127.0.0.1:1")
