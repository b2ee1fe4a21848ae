"""Equal input gives equal bytes: any number of threads, a cluster, another folder, time zone and language."""

import os
import subprocess
import sys

import pytest

from faults.commands import DRAWING, WRITING, results
from faults.crashing import command
from reliab.app.cli import main, run

PLACES = {
    "another zone and language": {"TZ": "Asia/Kathmandu", "LC_ALL": "tr_TR.UTF-8", "LANG": "tr_TR.UTF-8"},
    "ASCII": {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONIOENCODING": "ascii"},
    "two threads": {"OMP_NUM_THREADS": "2", "NUMBA_NUM_THREADS": "2", "PYTHONHASHSEED": "7"},
}


@pytest.fixture(scope="module")
def usual(sources, tmp_path_factory):
    """Function that runs a command in the usual place, each once; its results."""
    answers = {}

    def run(name):
        if name not in answers:
            out = tmp_path_factory.mktemp(name)
            outcome = command(WRITING[name].arguments(sources, out), {})
            assert outcome.code in (0, 1, 3), outcome.errors
            answers[name] = results(out)
        return answers[name]

    return run


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(
    "name", ["simulate", "ellipses", "criterion", "assess", "diagnose", "explore", "run"]
)
def test_bytes_depend_on_no_place(name, place, sources, tmp_path, usual, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, sys.path)))
    monkeypatch.chdir(tmp_path.parent)
    outcome = command(WRITING[name].arguments(sources, tmp_path), PLACES[place])
    assert outcome.code in (0, 1, 3), outcome.errors
    assert len(usual(name)) > 0
    assert results(tmp_path) == usual(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(WRITING) - {"report"}))
def test_bytes_depend_on_no_day_and_no_run(name, sources, tmp_path, usual):
    """Each command once more in a process of its own; "report" sets again what "run" wrote."""
    command(WRITING[name].arguments(sources, tmp_path), {"PYTHONHASHSEED": "11"})
    assert len(usual(name)) > 0
    assert results(tmp_path) == usual(name)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if "svg" in name else pytest.mark.slow) for name in DRAWING],  # no dates
)
def test_a_figure_has_the_same_bytes_twice(name, tmp_path, monkeypatch):
    for place, moment in (("first", "0"), ("second", "1700000000")):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", moment)  # matplotlib's clock
        (tmp_path / place).mkdir()
        assert run(list(map(str, DRAWING[name].arguments(None, tmp_path / place)))) == 0
    assert len(results(tmp_path / "first")) == 2
    assert results(tmp_path / "first") == results(tmp_path / "second")


THREADS = (
    *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"),
    "VECLIB_MAXIMUM_THREADS",
)


def test_the_command_line_counts_on_one_thread(monkeypatch, capsys):
    for name in THREADS:
        monkeypatch.setenv(name, "2")
    for name, value in (("argv", ["reliab", "--version"]), ("stdout", sys.stdout), ("stderr", sys.stderr)):
        monkeypatch.setattr(sys, name, value)  # restored
    with pytest.raises(SystemExit):
        main()
    assert capsys.readouterr().out
    assert {os.environ[name] for name in THREADS} == {"1"}


def test_libraries_of_numerics_are_loaded_after_the_number_of_threads_is_set():
    program = "import sys, reliab.__main__, reliab.app.cli; sys.exit('numpy' in sys.modules)"
    subprocess.run([sys.executable, "-c", program], check=True)  # noqa: S603 - the line above


@pytest.mark.slow
def test_bytes_depend_on_no_number_of_threads(sources, tmp_path, usual):
    arguments = [*WRITING["simulate"].arguments(sources, tmp_path)]
    arguments[arguments.index("--workers") + 1] = 2
    outcome = command(arguments, {})
    assert outcome.code == 0, outcome.errors
    assert results(tmp_path) == usual("simulate")


CLUSTER = """
import sys
from distributed import LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, protocol="tcp", dashboard_address=None) as workers:
        print(workers.scheduler_address, flush=True)
        sys.stdin.read()
"""


@pytest.mark.slow
def test_a_cluster_writes_the_same_bytes(sources, tmp_path, usual):
    (tmp_path / "cluster.py").write_text(CLUSTER)
    out = tmp_path / "out"
    out.mkdir()
    with subprocess.Popen(  # noqa: S603 - the lines above
        [sys.executable, str(tmp_path / "cluster.py")],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as cluster:
        address = cluster.stdout.readline().strip()
        arguments = [*WRITING["simulate"].arguments(sources, out), "--scheduler", address]
        outcome = command(arguments, {})
        cluster.stdin.close()
    assert outcome.code == 0, outcome.errors
    assert results(out) == usual("simulate")
