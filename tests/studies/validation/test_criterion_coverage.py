"""Every method keeps its own promise, measured on synthetic suites."""

import numpy as np
import pytest
from reliab_studies.validation.criterion_coverage import Truth, coverage_table, simulate_coverage
from scipy import stats

from reliab.criterion.methods.method import BoundMethod
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import METHODS, method_of

BOUND_METHODS = [name for name, method in METHODS.items() if issubclass(method, BoundMethod)]

INDEPENDENT = Truth(n_events=60, motions_per_event=1, event_share=0.0)
GROUPED_TRUTH = Truth(n_events=19, motions_per_event=5, event_share=0.15)
SKEWED_TRUTH = Truth(n_events=60, motions_per_event=2, event_share=0.15, skewness=0.25)
AVERAGE_METHODS = ("predictive", "dirichlet")
ASSURANCE_METHODS = ("tolerance", "order_statistic")


SIZES = pytest.mark.parametrize("count", [40, pytest.param(1000, marks=pytest.mark.slow)])


@pytest.mark.default_cases(2)
@SIZES
@pytest.mark.parametrize("confidence", [0.8, 0.95])
@pytest.mark.parametrize(
    ("name", "truth", "joint"),
    [
        *((name, INDEPENDENT, False) for name in AVERAGE_METHODS),
        *(("dirichlet", truth, True) for truth in (GROUPED_TRUTH, SKEWED_TRUTH)),
    ],
)
def test_methods_keep_their_average_coverage(name, truth, joint, confidence, count):
    """The recommended method also for a and b together, grouped by earthquakes or skewed."""
    coverage = simulate_coverage(method_of(name), truth, confidence, joint=joint, suites=count)
    slack = 4.0 * coverage.contents.std() / np.sqrt(count) + (0.007 if joint else 0.005)
    assert coverage.mean == pytest.approx(confidence, abs=slack)


@pytest.mark.default_cases(1)
@SIZES
@pytest.mark.parametrize("name", ASSURANCE_METHODS)
@pytest.mark.parametrize("confidence", [0.8, 0.95])
def test_methods_keep_their_assurance(name, confidence, count):
    coverage = simulate_coverage(method_of(name), INDEPENDENT, confidence, suites=count)
    slack = 4.0 * np.sqrt(0.05 * 0.95 / count)
    assert coverage.kept_share >= 0.95 - slack
    if name != "order_statistic":  # whose ranks are whole numbers
        assert coverage.kept_share <= 0.95 + slack


@pytest.mark.slow
def test_the_plug_in_quantile_falls_short_with_few_motions():
    small_truth = Truth(n_events=10, motions_per_event=1, event_share=0.0)
    content = simulate_coverage(Quantile(), small_truth, 0.95, suites=200).mean
    # The mean content of mean + z s over normal samples of ten, by integration over s and the mean.
    rng = np.random.default_rng(1)
    mean, spread = rng.normal(size=10**6) / np.sqrt(10), np.sqrt(rng.chisquare(9, 10**6) / 10)
    assert content == pytest.approx(stats.norm.sf(mean + stats.norm.ppf(0.05) * spread).mean(), abs=0.012)
    assert content < 0.935


@pytest.mark.default_cases(1)
@pytest.mark.parametrize("count", [60, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", ASSURANCE_METHODS)
@pytest.mark.parametrize("confidence", [0.8, 0.9])
def test_an_assurance_is_kept_where_half_of_the_variance_lies_between_19_earthquakes(name, confidence, count):
    correlated_truth = Truth(n_events=19, motions_per_event=5, event_share=0.5)
    assurance = simulate_coverage(method_of(name), correlated_truth, confidence, suites=count).kept_share
    assert assurance >= 0.95 - 3.0 * np.sqrt(0.05 * 0.95 / count)


def test_skewness_spoils_the_lognormal_quantile_and_not_the_recommended_one():
    large = Truth(n_events=400, motions_per_event=2, skewness=0.25)
    lognormal = simulate_coverage(Quantile(), large, 0.95, suites=20).mean
    coverage_of_dirichlet = simulate_coverage(method_of("dirichlet"), large, 0.95, suites=20).mean
    assert abs(lognormal - 0.95) > 0.02
    assert coverage_of_dirichlet == pytest.approx(0.95, abs=0.005)


@pytest.mark.slow
def test_the_table_has_one_row_for_each_combination():
    table = coverage_table(
        [(method_of(name), joint) for name in BOUND_METHODS for joint in (False, True)],
        [Truth(n_events=25, motions_per_event=2)],
        (0.8, 0.9),
        suites=3,
    )
    assert len(table) == 2 * 2 * len(BOUND_METHODS)
    assert table["content"].between(0.5, 1.0).all()


def test_a_table_reports_each_of_its_rows():
    truth, reports = Truth(n_events=8, motions_per_event=1, event_share=0.0), []
    methods, confidences = [(method_of("quantile"), False)], (0.5, 0.8, 0.9)
    coverage_table(methods, [truth], confidences, suites=1, progress=lambda *numbers: reports.append(numbers))
    assert reports == [(1, 3), (2, 3), (3, 3)]
