"""The suite: names, order, errors of events and random streams that never change."""

import hashlib
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import stats

from reliab.core.errors import InputError
from reliab.core.vocabulary import STANDARD_GRAVITY
from reliab.motions.motion import measure
from reliab.motions.suite import MotionSuite
from reliab.motions.synthetic.dabaghi_der_kiureghian_2018 import NO_PULSE, PULSE, Regression
from reliab.motions.synthetic.recording import RandomStream
from reliab.motions.synthetic.suite import draw_errors, synthetic_entries, synthetic_suite

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


def test_recording_names_parameters_of_the_motion() -> None:
    entry = synthetic_entries(count=2)[1]
    recording = entry.recording()
    assert 6.5 <= recording.scenario.magnitude <= 7.9
    assert np.array_equal(recording.components[1], entry.load().acceleration)


@pytest.mark.parametrize(
    ("arguments", "quantity"),
    [({"count": 0}, "motions"), ({"seed": -1}, "seed")],
)
def test_bad_arguments_are_refused(arguments: dict[str, int], quantity: str) -> None:
    with pytest.raises(InputError, match=quantity):
        synthetic_suite(**arguments)


_BOTH = pytest.mark.parametrize("regression", [NO_PULSE, PULSE], ids=["no pulse", "pulse"])
_EVENTS = 2000


def _keep(error: NDArray[np.float64]) -> NDArray[np.float64]:
    return error


def _standard_errors(regression: Regression) -> NDArray[np.float64]:
    """Errors over their standard deviations, shape (events, p)."""
    samples = [draw_errors(regression, RandomStream(1, event, 1), _keep) for event in range(_EVENTS)]
    return np.array(samples) / regression.deviations


@pytest.mark.default_cases(1)
@_BOTH
def test_errors_have_the_published_distribution(regression: Regression) -> None:
    """Against draws by NumPy, cut in the same way."""
    ours = _standard_errors(regression)
    theirs = np.random.default_rng(7).multivariate_normal(
        np.zeros(len(regression.names)), regression.correlation, size=20000
    )
    theirs = theirs[np.abs(theirs).max(axis=1) <= 2.0]
    assert np.abs(ours).max() <= 2.0
    assert np.corrcoef(ours.T) == pytest.approx(np.corrcoef(theirs.T), abs=0.12)
    levels = [stats.ks_2samp(*pair).pvalue for pair in zip(ours.T, theirs.T, strict=True)]
    assert min(levels) > 0.01 / len(levels)


def test_earthquakes_share_nothing() -> None:
    first = _standard_errors(NO_PULSE)[:, 0]
    assert abs(np.corrcoef(first[:-1], first[1:])[0, 1]) < 0.1


def test_errors_without_a_motion_are_drawn_again() -> None:
    progress_calls = []

    def attempt(error: NDArray[np.float64]) -> str | None:
        progress_calls.append(error)
        return "a motion" if len(progress_calls) == 3 else None

    assert draw_errors(NO_PULSE, RandomStream(1, 1), attempt) == "a motion"
    assert len(progress_calls) == 3


def test_numbers_are_uniform_and_normal() -> None:
    assert stats.kstest(RandomStream(1, 2).uniforms(20_000), "uniform").pvalue > 0.01
    assert stats.kstest(RandomStream(1, 3).normals(20_000), "norm").pvalue > 0.01


def test_streams_of_different_keys_are_independent() -> None:
    first, second, third = (RandomStream(1, *key).normals(20_000) for key in [(1,), (2,), (1, 0)])
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.03
    assert abs(np.corrcoef(first, third)[0, 1]) < 0.03


def test_stream_does_not_depend_on_how_it_is_read() -> None:
    piecewise = RandomStream(5)
    parts = [piecewise.uniforms(3), piecewise.uniforms(1), [piecewise.uniform()]]
    assert np.array_equal(np.concatenate(parts), RandomStream(5).uniforms(5))


def test_bits_are_those_of_the_algorithm() -> None:
    """NumPy makes a uniform number of the same 53 bits, without the half step that keeps ours off zero."""
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(2017, spawn_key=(1,))))
    assert np.array_equal(RandomStream(2017, 1).uniforms(9), generator.random(9) + 2.0**-54)
