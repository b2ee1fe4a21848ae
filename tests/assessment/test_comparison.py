"""Tests that differ in their compensators only are ranked rightly, and more surely than each is judged."""

from types import SimpleNamespace

import numpy as np
import pytest
from late_runs import runs_of

import reliab
from reliab.assessment.comparison import _order_files, _probability_larger, rank_tests, subtract_errors
from reliab.assessment.rebuilt_error.spread import Estimate
from reliab.core.errors import InputError
from reliab.core.vocabulary import Metric


@pytest.fixture(scope="module")
def comparison_and_errors():
    frames, errors = runs_of(3)
    return reliab.compare(frames, f=1, xi=0.05), errors


def test_the_smaller_error_comes_first(comparison_and_errors):
    comparison, errors = comparison_and_errors
    assert [test.file for test in comparison.tests] == ["data frame 2", "data frame 1"]
    second = comparison.tests[1]
    assert second.difference.low < errors[0] - errors[1] < second.difference.high
    assert 0.9 < second.probability_larger <= 0.99
    assert comparison.tests[0].difference is None
    assert comparison.notes == ()


def test_common_unknowns_leave_the_difference_as_certain(comparison_and_errors):
    first, second = comparison_and_errors[0].tests
    width = second.difference.high - second.difference.low
    separate = np.hypot(*(test.error.high - test.error.low for test in (first, second)))
    assert width < 0.8 * separate


def test_numbers_are_those_of_the_verdicts(comparison_and_errors):
    comparison, _ = comparison_and_errors
    content = comparison.to_dict()["tests"][0]
    separate = reliab.assess(runs_of(3)[0][1], f=1, xi=0.05).to_dict()
    assert content["rms"] == separate["error"]["rms"]
    assert (content["verdict"], content["A"]) == (separate["verdict"], separate["A"])
    assert list(comparison.to_dataframe()["rank"]) == [1, 2]


def test_common_assumptions_are_said(comparison_and_errors):
    comparison, _ = comparison_and_errors
    assert (
        "what is unknown, such as the skew of the channels, is the same in all of them"
        in comparison.to_dict()["assumed"]
    )
    first, second = comparison.tests
    separate = reliab.assess(runs_of(3)[0][0], f=1, xi=0.05, alpha=0.98)
    alternative = rank_tests({first.file: first.assessment, second.file: separate})
    assert "Other quantities are unknown in data frame 1" in alternative.notes[0]
    difference, paired = alternative.tests[1].difference, second.difference
    assert difference.high - difference.low > paired.high - paired.low


@pytest.mark.slow
def test_runs_of_other_motions_and_of_one_kind_are_told():
    frames = [runs_of(seed, delays=(0.004,))[0][0] for seed in (3, 4)]
    (note, *_) = reliab.compare(frames, f=1, xi=0.05).notes
    assert "different ground motions or scales" in note
    frames = [*runs_of(3, delays=(0.004,))[0], *runs_of(5, delays=(0.004,))[0]]
    frames[1] = frames[0].assign(measured_m=frames[0]["measured_m"] * 1.00001)
    assert "cannot be told apart" in reliab.compare(frames, f=1, xi=0.05).notes[-1]


def test_one_test_is_no_comparison():
    with pytest.raises(InputError, match="needs at least two tests that can be judged; found 1"):
        reliab.compare(runs_of(3, delays=(0.004,))[0], f=1, xi=0.05)


@pytest.mark.slow
def test_intervals_of_differences_hold_the_true_ones_where_the_frequency_is_not_exact():
    coverage = 0
    for seed in range(40):
        f = 1.0 + 0.02 * np.random.default_rng(1000 + seed).normal()
        frames, errors = runs_of(100 + seed, f=f)
        tests = {test.file: test for test in reliab.compare(frames, f="1±0.02", xi=0.05).tests}
        later = next(test for test in tests.values() if test.difference is not None)
        sign = 1.0 if later.file == "data frame 1" else -1.0
        coverage += later.difference.low <= sign * (errors[0] - errors[1]) <= later.difference.high
    assert coverage >= 32  # 90 % of 40, less two standard deviations


def errors_drawn(rows, values):
    """Stand-ins of what was found about tests, of which only the draws of the errors are known."""
    made = {}
    for file, row in rows.items():
        samples = np.array(row, dtype=float)
        draws = SimpleNamespace(
            errors=lambda _metric, samples=samples: samples,
            weights=np.ones_like(samples),
        )
        inferred = SimpleNamespace(posterior=SimpleNamespace(means={}))
        made[file] = SimpleNamespace(
            rebuilt=SimpleNamespace(inferred=inferred, draws=draws),
            estimate=lambda _metric, file=file: Estimate(value=values[file], low=0.0, high=1.0),
        )
    return made


@pytest.mark.parametrize(
    ("rows", "order"),
    [
        ({"a": [1, 1, 1, 9], "b": [2, 2, 2, 2]}, ["a", "b"]),  # a is smaller in three of four draws
        ({"a": [3, 3, 3], "b": [1, 2, 9], "c": [2, 1, 8]}, ["c", "b", "a"]),
    ],
)
def test_tests_are_ranked_by_reported_probabilities(rows, order):
    """Whatever their values are."""
    values = dict(zip(rows, range(len(rows), 0, -1), strict=True))
    errors = errors_drawn(rows, values)
    ranked = _order_files(errors, Metric.RMS)
    assert ranked == order
    for file in ranked[1:]:
        assert _probability_larger(*subtract_errors(errors[file], errors[ranked[0]], Metric.RMS)) > 0.5


def test_equal_tests_are_as_likely_the_better_one():
    assert _probability_larger(np.zeros(8), np.ones(8)) == pytest.approx(0.5)
