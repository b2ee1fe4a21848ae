import pickle

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.motions.motion import Motion
from reliab.motions.suite import MotionSuite


def motion(name: str, event: str = "", set_name: str = "") -> Motion:
    return Motion(name=name, acceleration=np.ones(3), time_step=0.01, event=event, set_name=set_name)


@pytest.fixture
def suite() -> MotionSuite:
    return MotionSuite.from_motions(
        [motion("a", "one", "near"), motion("b", "one", "far"), motion("c", "two", "far"), motion("d")]
    )


def test_labels_are_known_in_order(suite: MotionSuite) -> None:
    assert len(suite) == 4
    assert suite.names == ("a", "b", "c", "d")
    assert suite.events == ("one", "one", "two", "d")
    assert suite.set_names == ("near", "far", "far", "")
    assert repr(suite) == "<MotionSuite of 4 motions from 3 events>"


def test_a_suite_is_a_sequence_of_motions(suite: MotionSuite) -> None:
    assert [record.name for record in suite] == ["a", "b", "c", "d"]
    assert suite[-1] == motion("d")
    assert motion("b", "one", "far") in suite
    with pytest.raises(IndexError):
        suite[4]


def test_a_slice_is_a_suite(suite: MotionSuite) -> None:
    assert isinstance(suite[1:3], MotionSuite)
    assert suite[1:3].names == ("b", "c")


def test_selection_keeps_the_order_of_the_suite(suite: MotionSuite) -> None:
    assert suite.select(names=["c", "a"]).names == ("a", "c")
    assert suite.select(sets=["far"]).names == ("b", "c")
    assert suite.select(names=["a", "b"], sets=["far"]).names == ("b",)
    assert suite.select(names="b").names == ("b",)
    assert suite.select().names == suite.names


def test_an_unknown_name_is_refused_with_the_nearest(suite: MotionSuite) -> None:
    with pytest.raises(InputError, match=r"No set 'nearby' in the suite. Choose for example near"):
        suite.select(sets=["nearby"])
    with pytest.raises(InputError, match="No motion 'z' in the suite"):
        suite.select(names=["z"])


def test_repeated_names_are_refused() -> None:
    with pytest.raises(InputError, match="same name; found a"):
        MotionSuite.from_motions([motion("a"), motion("a")])


def test_motions_are_read_only_when_asked_for() -> None:
    class Entry:
        name = event = set_name = "x"

        def __init__(self) -> None:
            self.loads = 0

        def load(self) -> Motion:
            self.loads += 1
            return motion("x")

    entry = Entry()
    suite = MotionSuite([entry])
    assert (suite.names, suite.events, len(suite[:1]), entry.loads) == (("x",), ("x",), 1, 0)
    list(suite)
    assert entry.loads == 1


def test_a_suite_survives_pickling(suite: MotionSuite) -> None:
    assert list(pickle.loads(pickle.dumps(suite))) == list(suite)  # noqa: S301 - our own bytes
