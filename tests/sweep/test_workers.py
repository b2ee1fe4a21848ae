"""Threads and workers share the motions of a sweep."""

import pytest

from reliab.motions.loading import load_motions
from reliab.sweep.run import _in_tasks, _side_by_side

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
