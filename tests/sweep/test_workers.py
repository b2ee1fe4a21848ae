"""Threads and workers share the motions of a sweep, and write what they solve where they see the store."""

import pytest

from reliab.motions.loading import load_motions
from reliab.sweep.run import SweepJob, _in_tasks, _side_by_side, run_sweep
from reliab.sweep.store import ResultsStore

SUITE = load_motions("synthetic")
MISSING = [index for index in range(len(SUITE)) if index % 7 != 3]


@pytest.mark.parametrize("threads", [1, 2, 8])
def test_every_motion_is_solved_once(threads):
    assert sorted(_side_by_side(MISSING, SUITE.events, threads)) == MISSING
    assert [index for task in _in_tasks(MISSING, SUITE.events, threads) for index in task] == MISSING


def test_threads_do_not_wait_for_a_recording_that_another_simulates():
    ordered = _side_by_side(list(range(100)), SUITE.events, 2)
    pairs = zip(ordered[::2], ordered[1::2], strict=True)
    assert all(SUITE.events[one] != SUITE.events[other] for one, other in pairs)


def test_tasks_of_workers_hold_whole_earthquakes_until_the_last_ones():
    tasks = list(_in_tasks(list(range(100)), SUITE.events, 2))
    sizes = [len(task) for task in tasks]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] == 8
    assert sizes[-1] == 1
    assert all(len({SUITE.events[index] for index in task}) == len(task) / 2 for task in tasks[:-8])


def test_an_earthquake_of_many_motions_is_shared_by_all_workers():
    assert [len(task) for task in _in_tasks(list(range(40)), ["same"] * 40, 2)][:5] == [8, 8, 6, 4, 3]


@pytest.mark.parametrize("shared", [True, False])
def test_a_thread_writes_what_it_solves_or_hands_it_back(
    tmp_path, suite, request_, store, contents, motions_handed_back, shared
):
    handed_back = motions_handed_back(shared=shared)
    assert contents(run_sweep(suite, request_, tmp_path / "results.zarr")) == contents(store)
    assert sorted(handed_back) == ([] if shared else list(range(6)))


@pytest.mark.parametrize("token", [None, b"of another store", b"\xff"])
def test_nothing_is_written_to_a_store_that_is_closed_or_held_by_another(
    tmp_path, suite, request_, contents, token
):
    path = tmp_path / "results.zarr"
    with ResultsStore.opened(path, request_, suite.names, suite.events, resume=False) as results:
        job = SweepJob(motions=suite, request=request_, store=results.access)
        assert not job.solve(0).windows
    if token is not None:
        (path / ".unfinished-token").write_bytes(token)
    before = contents(path)
    assert job.solve(1).windows
    assert contents(path) == before


def test_what_a_killed_worker_was_writing_is_removed_at_the_end(tmp_path, suite, request_, store, contents):
    path = tmp_path / "results.zarr"

    def leave(done: int, _: int) -> None:
        (path / f".unfinished-{done}").write_bytes(b"half")

    run_sweep(suite, request_, path, progress=leave)
    assert contents(path) == contents(store)
