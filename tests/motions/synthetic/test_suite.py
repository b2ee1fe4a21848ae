"""The suite: names, order, reproducibility, and independence of what else is asked for."""

import hashlib
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.intensity import measure
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.suite import synthetic_entries, synthetic_suite

CHECKSUM = "5d541ae9b2ac9b59"
"""Beginning of the SHA-256 of the checksums of all motions; it belongs to the product's definition."""


@pytest.fixture(scope="module")
def suite() -> MotionSuite:
    return synthetic_suite()


def test_default_suite_is_the_same_for_ever(suite: MotionSuite) -> None:
    digest = hashlib.sha256("".join(motion.checksum for motion in suite).encode())
    assert digest.hexdigest()[: len(CHECKSUM)] == CHECKSUM


def test_default_suite_holds_two_components_of_fifty_events(suite: MotionSuite) -> None:
    assert len(suite) == 100
    assert len(set(suite.events)) == 50
    assert suite.names[:3] == ("SYN001/H1", "SYN001/H2", "SYN002/H1")
    assert suite.names[-1] == "SYN050/H2"


def test_motions_are_physical(suite: MotionSuite) -> None:
    for motion in suite:
        measures = measure(motion)
        assert 0.05 * STANDARD_GRAVITY < measures.peak_acceleration < 3.0 * STANDARD_GRAVITY
        assert 1.0 < measures.significant_duration < motion.duration
        assert 0.05 < measures.mean_period < 3.0


def test_motion_does_not_depend_on_the_number_of_motions(suite: MotionSuite) -> None:
    assert synthetic_suite(count=7)[6] == suite[6]
    assert synthetic_suite(count=10_000)[6] == suite[6]


def test_thousands_of_motions_are_named_at_once() -> None:
    suite = synthetic_suite(count=10_000)
    assert suite.names[-1] == "SYN5000/H2"
    assert len(set(suite.names)) == 10_000


def test_motion_does_not_depend_on_the_number_of_stations() -> None:
    one, three = synthetic_suite(count=4), synthetic_suite(count=12, stations_per_event=3)
    assert three.names[:4] == ("SYN001/H1", "SYN001/H2", "SYN001/S2H1", "SYN001/S2H2")
    assert three.names[6:8] == one.names[2:]
    for name in one.names:
        assert three[three.names.index(name)] == one[one.names.index(name)]


def test_components_and_events_and_seeds_differ(suite: MotionSuite) -> None:
    motions = [suite[0], suite[1], suite[2], synthetic_suite(seed=1)[0]]
    assert len({motion.checksum for motion in motions}) == 4


def test_components_of_an_event_are_of_equal_length(suite: MotionSuite) -> None:
    for first, second in zip(suite[::2], suite[1::2], strict=True):
        assert first.event == second.event
        assert first.acceleration.size == second.acceleration.size


def test_entries_travel_between_processes() -> None:
    entry = synthetic_entries(count=1)[0]
    assert pickle.loads(pickle.dumps(entry)).load() == entry.load()  # noqa: S301 - our own object


def test_threads_get_the_same_motions(suite: MotionSuite) -> None:
    entries = synthetic_entries(count=24)
    with ThreadPoolExecutor(max_workers=4) as threads:
        motions = list(threads.map(lambda entry: entry.load(), reversed(entries)))
    assert motions == list(suite[:24])[::-1]


def test_recording_tells_what_the_motion_was_made_of() -> None:
    entry = synthetic_entries(count=2)[1]
    recording = entry.recording()
    assert 6.5 <= recording.scenario.magnitude <= 7.9
    assert np.array_equal(recording.components[1], entry.load().acceleration)


@pytest.mark.parametrize(
    ("arguments", "quantity"),
    [({"count": 0}, "motions"), ({"seed": -1}, "seed"), ({"stations_per_event": 0}, "stations")],
)
def test_bad_arguments_are_refused(arguments: dict[str, int], quantity: str) -> None:
    with pytest.raises(InputError, match=quantity):
        synthetic_suite(**arguments)
