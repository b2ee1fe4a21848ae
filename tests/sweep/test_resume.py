"""Sweeps that are resumed, on threads, in any order."""

import errno
import itertools
import json
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import reliab
from reliab.core.errors import IncompleteError, InputError
from reliab.motions.loading import load_motions
from reliab.sweep import run
from reliab.sweep.request import ScaledGrid, SweepRequest
from reliab.sweep.results import open_results
from reliab.sweep.run import _divide_into_tasks, _side_by_side, run_sweep

REQUEST = SweepRequest(
    frequencies=(0.5, 1.0), damping_ratios=(0.02,), grid=ScaledGrid(gain_steps=5, delay_steps=6)
)
SCRIPT = textwrap.dedent(
    """
    import sys
    from reliab.motions.loading import load_motions
    from reliab.sweep.request import ScaledGrid
    from reliab.sweep.request import SweepRequest
    from reliab.sweep.run import run_sweep

    request = SweepRequest(
        frequencies=(0.5, 1.0), damping_ratios=(0.02,), grid=ScaledGrid(gain_steps=5, delay_steps=6)
    )
    print("ready", flush=True)
    run_sweep(
        load_motions("synthetic")[:40],
        request,
        sys.argv[1],
        resume="--resume" in sys.argv,
        progress=lambda *_: print("solved", flush=True),
    )
    """
)


def run_script(path: Path, *, resume: bool) -> subprocess.Popen[str]:
    arguments = [sys.executable, "-c", SCRIPT, str(path), *(["--resume"] if resume else [])]
    return subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)  # noqa: S603


def kill_repeatedly(path: Path, times: int, rng: np.random.Generator) -> int:
    """Kill a sweep at random moments and count how often it was really interrupted."""
    partial_run = 0
    for _ in range(times):
        process = run_script(path, resume=path.exists())
        assert process.stdout is not None
        process.stdout.readline()
        time.sleep(float(rng.uniform(0.0, 0.5)))
        partial_run += kill(process)
    finish = run_script(path, resume=path.exists())
    _, error = finish.communicate()
    assert finish.returncode == 0, error
    return partial_run


def kill(process: subprocess.Popen[str]) -> bool:
    """Kill a process; return whether it was still running."""
    process.send_signal(signal.SIGKILL)
    process.communicate()
    return process.returncode == -signal.SIGKILL


@pytest.fixture(scope="module")
def reference(tmp_path_factory, contents):
    path = tmp_path_factory.mktemp("reference") / "results.zarr"
    return contents(run_sweep(load_motions("synthetic")[:40], REQUEST, path))


@pytest.mark.slow
def test_resumed_store_has_the_same_bytes(tmp_path, reference, contents):
    path = tmp_path / "results.zarr"
    process = run_script(path, resume=False)
    assert process.stdout is not None
    assert [process.stdout.readline() for _ in range(6)] == ["ready\n", *["solved\n"] * 5]
    assert kill(process)
    assert contents(path) != reference
    run_sweep(load_motions("synthetic")[:40], REQUEST, path, resume=True)
    assert contents(path) == reference


@pytest.mark.parametrize("tick", [0.0, 0.26])
def test_the_journal_is_written_when_it_is_due(tmp_path, suite, monkeypatch, tick):
    """A process that is killed closes nothing; by this clock every motion is due, or none before the end."""
    clock = (100.0 + tick * reading for reading in itertools.count())
    monkeypatch.setattr(run, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    path, reference = tmp_path / "results.zarr", []

    def look(step: int, _: int) -> None:
        entries = run.array_of(run.open_group(path, "r"), run.JOURNAL)[:]  # type: ignore[attr-defined]
        reference.append(sum(map(bool, entries)) >= step if tick else not any(entries))

    run_sweep(suite, REQUEST, path, progress=look, workers=1)
    assert reference == [True] * 7


@pytest.mark.slow
def test_fifty_kills_leave_the_same_bytes(tmp_path, reference, contents):
    rng = np.random.default_rng(50)
    partial_run = sum(kill_repeatedly(tmp_path / f"{k}" / "results.zarr", 5, rng) for k in range(10))
    assert partial_run >= 40
    for k in range(10):
        assert contents(tmp_path / f"{k}" / "results.zarr") == reference


def test_damaged_chunk_is_detected_and_solved_again(own_store, suite, request_, contents):
    path = own_store
    first = contents(path)
    chunk = next((path / "rms").glob("c.2.*"))
    content = chunk.read_bytes()
    chunk.write_bytes(content[: len(content) // 2])
    corrupt = next((path / "window_arias" / "mte").glob("c.4.*"))
    corrupt.write_bytes(bytes([corrupt.read_bytes()[0] ^ 1]) + corrupt.read_bytes()[1:])
    solution = []
    run_sweep(suite, request_, path, resume=True, progress=lambda step, _: solution.append(step))
    assert solution == [4, 5, 6]
    assert contents(path) == first


@pytest.mark.slow
def test_interrupted_store_is_not_mistaken_for_a_whole_one(tmp_path, suite, request_):
    class StopError(Exception):
        pass

    def stop(step: int, _: int) -> None:
        if step == 2:
            raise StopError

    with pytest.raises(StopError):
        run_sweep(suite, request_, tmp_path / "results.zarr", progress=stop, workers=1)
    with pytest.raises(InputError, match="`resume`"):
        open_results(tmp_path / "results.zarr")
    run_sweep(suite, request_, tmp_path / "results.zarr", resume=True)
    assert open_results(tmp_path / "results.zarr").sizes["motion"] == 6


def test_partial_files_of_a_killed_process_are_removed(own_store, suite, request_, contents):
    first = contents(own_store)
    (own_store / "rms" / ".unfinished-1").write_bytes(b"half")
    (own_store / "duration" / "c.0123.partial").write_bytes(b"half")
    run_sweep(suite, request_, own_store, resume=True)
    assert contents(own_store) == first


def test_full_disk_at_start_is_named(tmp_path, suite, request_, monkeypatch):
    def create_store(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(run, "create_store", create_store)
    with pytest.raises(InputError, match=r"No space left.*Make room"):
        run_sweep(suite, request_, tmp_path / "results.zarr")


def test_second_process_is_refused(tmp_path, suite, request_):
    path = tmp_path / "results.zarr"
    with (
        run.ResultsStore.open(path, request_, suite.names, suite.events, resume=False),
        pytest.raises(InputError, match="Only one process"),
    ):
        run_sweep(suite, request_, path, resume=True)


def test_existing_store_is_not_overwritten(own_store, suite, request_):
    with pytest.raises(InputError, match="exists already"):
        run_sweep(suite, request_, own_store)


@pytest.mark.parametrize(
    "place", ["motion/c.0", "rms/c.0.0.0.0.0", "journal/entries/c.0", "rms/zarr.json", "mte", ".lock"]
)
def test_link_in_a_store_is_not_written_through(own_store, suite, request_, tmp_path, place, contents):
    """A store may come from somewhere else, with a link to any file of whoever resumes it."""
    link = own_store.with_name("results.zarr.lock") if place == ".lock" else own_store / place
    elsewhere = tmp_path / "elsewhere"
    if link.is_dir():
        link.rename(elsewhere)
    else:
        elsewhere.write_bytes(b"a file that is not the store's")
        link.unlink(missing_ok=True)
    link.symlink_to(elsewhere)
    first = contents(elsewhere) if elsewhere.is_dir() else elsewhere.read_bytes()
    with pytest.raises(InputError, match="must not contain links"):
        run_sweep(suite, request_, own_store, resume=True)
    assert (contents(elsewhere) if elsewhere.is_dir() else elsewhere.read_bytes()) == first


def test_another_sweep_is_not_mixed_in(own_store, suite, request_):
    second = SweepRequest(
        frequencies=(0.7,), damping_ratios=(0.02,), grid=ScaledGrid(gain_steps=5, delay_steps=6)
    )
    with pytest.raises(InputError, match="holds a sweep of other"):
        run_sweep(suite, second, own_store, resume=True)
    with pytest.raises(InputError, match="motions, not the"):
        run_sweep(suite[:5], request_, own_store, resume=True)


def test_full_disk_message_says_results_are_safe(tmp_path, suite, request_, monkeypatch):
    original = run.write_chunk  # type: ignore[attr-defined]

    def write_chunk(path, motion_variance, chunk):
        if motion_variance.name.startswith("c.2."):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        original(path, motion_variance, chunk)

    path = tmp_path / "results.zarr"
    monkeypatch.setattr(run, "write_chunk", write_chunk)
    with pytest.raises(IncompleteError, match=r"disk is full.*results of 2 motions are safe.*`resume`"):
        run_sweep(suite, request_, path, workers=1)
    monkeypatch.setattr(run, "write_chunk", original)
    run_sweep(suite, request_, path, resume=True)
    assert open_results(path).sizes["motion"] == 6


@pytest.mark.parametrize("label", ["nothing", "text", "folder"])
def test_invalid_store_is_named(tmp_path, label):
    path = tmp_path / "results.zarr"
    if label == "text":
        path.write_text("no store")
    elif label == "folder":
        path.mkdir()
    with pytest.raises(InputError, match=r"Zarr store|results\.zarr: No such file"):
        open_results(path)


def test_a_store_of_another_version_is_named(own_store):
    metadata = own_store / "zarr.json"
    metadata.write_text(metadata.read_text().replace('"schema_version": 2', '"schema_version": 99'))
    with pytest.raises(InputError, match="schema versions 1 and 2"):
        open_results(own_store)


def test_unwritable_folder_is_named(tmp_path, suite, request_):
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(InputError, match="Cannot write to the folder of a results store"):
        run_sweep(suite, request_, tmp_path / "file" / "results.zarr")


@pytest.mark.slow
def test_number_of_threads_does_not_change_a_bit(tmp_path, suite, request_):
    single_thread, two_threads = (
        open_results(run_sweep(suite, request_, tmp_path / f"{threads}.zarr", workers=threads))
        for threads in (1, 2)
    )
    assert single_thread.identical(two_threads)


SUITE = load_motions("synthetic")
MISSING = [index for index in range(len(SUITE)) if index % 7 != 3]


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_every_motion_is_solved_once(threads):
    assert sorted(_side_by_side(MISSING, SUITE.events, threads)) == MISSING
    assert [index for task in _divide_into_tasks(MISSING, SUITE.events, threads) for index in task] == MISSING


def test_threads_do_not_wait_for_one_another():
    sorted_values = _side_by_side(list(range(100)), SUITE.events, 2)
    pairs = zip(sorted_values[::2], sorted_values[1::2], strict=True)
    assert all(SUITE.events[single] != SUITE.events[second] for single, second in pairs)


def test_tasks_of_workers_hold_whole_earthquakes_until_the_last_ones():
    tasks = list(_divide_into_tasks(list(range(100)), SUITE.events, 2))
    sizes = [len(task) for task in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == 8
    assert sizes[-1] == 1
    assert all(len({SUITE.events[index] for index in task}) == len(task) / 2 for task in tasks[:-8])


def test_an_earthquake_of_many_motions_is_shared_by_all_workers():
    assert [len(task) for task in _divide_into_tasks(list(range(40)), ["same"] * 40, 2)][:5] == [
        8,
        8,
        6,
        4,
        3,
    ]


def test_variables_stand_in_the_same_order_however_the_store_lists_them(tmp_path):
    reliab.simulate(load_motions("synthetic")[:2], out=tmp_path / "one.zarr")
    description = json.loads((tmp_path / "one.zarr/zarr.json").read_text(encoding="utf-8"))
    assert description["node_type"] == "group"
    (tmp_path / "two.zarr").mkdir()
    for place in sorted((tmp_path / "one.zarr").iterdir(), reverse=True):
        duplicate = tmp_path / "two.zarr" / place.name
        shutil.copytree(place, duplicate) if place.is_dir() else shutil.copy(place, duplicate)
    single, two = (open_results(tmp_path / f"{name}.zarr") for name in ("one", "two"))
    assert list(single.variables) == list(two.variables) == sorted(single.variables)
    assert single.load().identical(two.load())
