"""Three verdicts, each with its reasons."""

import pytest

from reliab.assessment.assess import assess
from reliab.assessment.verdict import Word, probability_text, verdict_by_index
from reliab.core.stated_value import StatedValue
from reliab.criterion.derivation import published_criterion
from reliab.recordings.recording import Recording
from reliab.structures.structure import Structure

ONE_HERTZ = Structure(frequency=1.0, damping_ratio=0.02)


@pytest.fixture(scope="module")
def near(ground_motions, simulate_rig):
    """A test whose error lies close below 5 %."""
    motion = ground_motions[3]
    test = simulate_rig(motion.acceleration, motion.time_step, seconds=30.0, delay=0.0018, db=45.0)
    assert 0.043 < test.rms < 0.0499
    return Recording(command=test.command, measured=test.measured, time_step=1.0 / 256.0)


def test_a_tolerance_of_the_frequency_leaves_a_close_test_undecided_and_says_so(near):
    sure = assess(near, ONE_HERTZ, threshold=0.048)
    assert sure.verdict is Word.NOT_RELIABLE
    stated_values = {"f": StatedValue(1.0, 0.05), "xi": StatedValue(0.02)}
    unsure = assess(near, ONE_HERTZ, threshold=0.048, stated=stated_values)
    assert unsure.verdict is Word.UNDECIDED
    assert "natural frequency" in unsure.would_decide[0]
    assert unsure.error.rebuilt.rms.low < 0.048 < unsure.error.rebuilt.rms.high


def test_the_threshold_turns_the_verdict(near):
    strict = assess(near, ONE_HERTZ, threshold=0.03)
    assert strict.verdict is Word.NOT_RELIABLE
    assert strict.probability < 0.05
    assert not strict.reliable


def test_a_disagreement_of_error_and_index_is_explained(near):
    result = assess(near, ONE_HERTZ, criterion=published_criterion("guo_2017_15"))
    assert (result.verdict, result.verdict_by_index.word) == (Word.RELIABLE, Word.NOT_RELIABLE)
    assert any("disagree" in warning for warning in result.warnings)


@pytest.mark.parametrize(
    ("index", "interval", "probability", "own_value", "word"),
    [
        (0.5, (0.4, 0.6), 0.99, False, Word.RELIABLE),
        (0.9, (0.7, 1.1), 0.95, False, Word.UNDECIDED),
        (1.6, (1.4, 1.8), 0.78, False, Word.UNDECIDED),
        (1.6, (1.4, 1.8), 0.0, True, Word.NOT_RELIABLE),
        (9.0, (8.0, 9.9), 0.02, False, Word.NOT_RELIABLE),
        (9.0, (8.0, 9.9), None, False, Word.NOT_RELIABLE),
        (None, None, None, False, Word.UNDECIDED),
    ],
)
def test_an_index_has_three_verdicts(index, interval, probability, own_value, word):
    result = verdict_by_index(
        index=index, interval=interval, probability=probability, confidence=0.95, own_motion=own_value
    )
    assert result.word is word
    assert result.reasons
    assert bool(result.would_decide) is (word is Word.UNDECIDED)


def test_no_probability_is_written_as_certain():
    assert [probability_text(value) for value in (1.0, 0.9999, 0.0, 0.5)] == [
        "> 0.99",
        "> 0.99",
        "< 0.01",
        "0.50",
    ]


def test_a_headline_is_the_word_in_capitals_with_blanks():
    assert [word.shout for word in Word] == ["RELIABLE", "UNDECIDED", "NOT RELIABLE"]
