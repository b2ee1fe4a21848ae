"""Cross-validation measures what it says, on ellipses of known distribution."""

import numpy as np
import pytest
import xarray as xr
from scipy.stats import binomtest

from reliab.core.errors import InputError
from reliab.core.vocabulary import ELLIPSE_DIMENSIONS, Side
from reliab.criterion.laws.dimensionless import Dimensionless
from reliab.criterion.laws.table import TabulatedLimits
from reliab.criterion.methods.registry import method_of
from reliab.validation.counts import event_bootstrap, tabulate
from reliab.validation.folds import (
    Fold,
    from_another,
    k_fold,
    leave_one_event_out,
    leave_structures_out,
    random_halves,
    transfer,
)
from reliab.validation.judge import DerivedCandidate, PrintedCandidate, cross_validate


def lognormal_ellipses(events: int, motions: int, seed: int, share: float = 0.3) -> xr.Dataset:
    """Ellipses whose logarithms are normal, part of the variance lying between earthquakes."""
    rng = np.random.default_rng(seed)
    covariance = np.array([[1.0, 0.9], [0.9, 1.0]])
    event_variance = rng.multivariate_normal(np.zeros(2), share * covariance, events)
    motion_variance = rng.multivariate_normal(np.zeros(2), (1 - share) * covariance, events * motions)
    deviation = 0.5 * (np.repeat(event_variance, motions, axis=0) + motion_variance)
    shape = (events * motions, *(1,) * (len(ELLIPSE_DIMENSIONS) - 1))
    return xr.Dataset(
        {
            "a": (ELLIPSE_DIMENSIONS, (2e-4 * np.exp(deviation[:, 0])).reshape(shape)),
            "b": (ELLIPSE_DIMENSIONS, (3.0 * np.exp(deviation[:, 1])).reshape(shape)),
        },
        coords={
            "motion": [f"E{k // motions}/{k % motions}" for k in range(events * motions)],
            "event": ("motion", [f"E{k // motions}" for k in range(events * motions)]),
            "f": [1.0],
            "xi": [0.02],
            "threshold": [0.05],
            "metric": ["rms"],
            "curve": ["ellipse"],
            "side": ["lag"],
        },
    )


QUANTILE = DerivedCandidate(name="plug-in, each", method=method_of("quantile"), joint=False)
RECOMMENDED_CANDIDATE = DerivedCandidate(name="recommended", method=method_of("dirichlet"))


def validate(ellipses, folds, candidates=(QUANTILE,), **options):
    return cross_validate(ellipses, folds, candidates, scheme="test", **options)


@pytest.mark.parametrize(
    "folds", [leave_one_event_out, lambda events: k_fold(events, 4), lambda events: random_halves(events, 6)]
)
def test_no_earthquake_is_learned_from_and_judged(folds):
    events = lognormal_ellipses(11, 3, 0)["event"].values
    for fold in folds(events):
        assert not set(events[fold.learned]) & set(events[fold.judged])
        assert fold.learned.any()
        assert fold.judged.any()


@pytest.mark.slow
def test_each_motion_is_judged_once_when_earthquakes_are_left_out():
    ellipses = lognormal_ellipses(30, 2, 1)
    for folds in (leave_one_event_out(ellipses["event"].values), k_fold(ellipses["event"].values, 3)):
        result = validate(ellipses, folds, confidences=(0.8,))
        assert (result.counts["judged"].sel(side="lag").values == 1).all()
        assert not result.judges(Side.LEAD)


@pytest.mark.slow
def test_containment_of_a_large_suite_is_nominal():
    ellipses = lognormal_ellipses(400, 2, 2)
    result = validate(
        ellipses, k_fold(ellipses["event"].values, 5), (RECOMMENDED_CANDIDATE,), confidences=(0.8, 0.9, 0.95)
    ).containment()
    for confidence in (0.8, 0.9, 0.95):
        selection = result.sel(candidate="recommended", confidence=confidence)
        assert float(selection["rate"]) == pytest.approx(confidence, abs=0.02)
        assert float(selection["low"]) < confidence < float(selection["high"])


def test_criterion_without_limits_is_never_contained_and_one_of_zero_always():
    ellipses = lognormal_ellipses(6, 2, 3)
    wide, narrow = (
        PrintedCandidate(name=name, law=TabulatedLimits.fit([1.0], [0.02], [[limit]], [[limit]]))
        for name, limit in (("none", 1e9), ("all", 1e-12))
    )
    result = validate(
        ellipses, leave_one_event_out(ellipses["event"].values), (wide, narrow), confidences=(0.95,)
    )
    assert result.containment()["rate"].sel(candidate="none").item() == 0.0
    assert result.containment()["rate"].sel(candidate="all").item() == 1.0
    assert result.accepted_share()["rate"].sel(candidate="none").item() == 1.0
    assert result.accepted_share()["rate"].sel(candidate="all").item() == 0.0


def test_wider_criterion_accepts_more_and_is_wrong_more_often():
    ellipses = lognormal_ellipses(40, 2, 4)
    result = validate(
        ellipses,
        k_fold(ellipses["event"].values, 5),
        (RECOMMENDED_CANDIDATE,),
        confidences=(0.5, 0.8, 0.95, 0.99),
    )
    assert (np.diff(result.accepted_share()["rate"].values.ravel()) < 0).all()
    assert (np.diff(result.false_safe()["rate"].values.ravel()) <= 0).all()


def test_rates_agree_with_counting_by_hand():
    ellipses = lognormal_ellipses(30, 2, 5)
    fold = Fold(name="one", learned=np.arange(60) < 50, judged=np.arange(60) >= 50)
    result = validate(ellipses, [fold], confidences=(0.9,))
    sample = ellipses.isel(motion=fold.learned).squeeze()
    limits = [
        np.exp(np.mean(np.log(v)) + np.std(np.log(v)) * -1.2815515655446004)
        for v in (sample["a"].values, sample["b"].values)
    ]
    original = ellipses.isel(motion=fold.judged).squeeze()
    reference = ((original["a"] >= limits[0]) & (original["b"] >= limits[1])).mean()
    assert result.containment()["rate"].item() == pytest.approx(float(reference))


def test_bootstrap_interval_is_wider_when_motions_of_an_earthquake_are_alike():
    rng = np.random.default_rng(6)
    is_equal = np.repeat(rng.random(20) < 0.8, 5).astype(float)
    separate = (rng.random(100) < 0.8).astype(float)
    events = np.repeat(np.arange(20), 5).astype(str)
    widths = []
    for values in (is_equal, separate):
        low, high = event_bootstrap(values, np.ones(100), events)
        widths.append(float(high - low))
    assert widths[0] > 1.5 * widths[1]


@pytest.mark.slow
def test_bootstrap_interval_covers_the_rate():
    rng = np.random.default_rng(7)
    coverage = 0
    for seed in range(200):
        rate = rng.beta(8.0, 2.0, 60)
        values = (rng.random((60, 2)) < rate[:, np.newaxis]).ravel().astype(float)
        low, high = event_bootstrap(values, np.ones(120), np.repeat(np.arange(60), 2).astype(str), seed=seed)
        coverage += low <= 0.8 <= high
    assert 0.90 <= coverage / 200 <= 0.99


def test_too_few_earthquakes_are_refused():
    with pytest.raises(InputError, match="Too few earthquakes"):
        list(leave_one_event_out(np.array(["a", "a"])))


def test_learning_from_another_suite_judges_all_of_this_one():
    ellipses, second = lognormal_ellipses(10, 2, 8), lognormal_ellipses(300, 2, 9)
    everything = Fold(name="all", learned=np.ones(600, dtype=bool), judged=np.ones(20, dtype=bool))
    result = validate(ellipses, [everything], learn_from=second, confidences=(0.9,))
    assert 0.6 < result.containment()["rate"].item() <= 1.0


def test_shared_earthquake_is_not_learned_from():
    folds = list(from_another(["K", None, "K", None], np.array(["K", "", "K", "M"])))
    assert [fold.name for fold in folds] == ["other earthquakes", "K"]
    np.testing.assert_array_equal(folds[0].learned, [True, True, True, True])
    np.testing.assert_array_equal(folds[0].judged, [False, True, False, True])
    np.testing.assert_array_equal(folds[1].learned, [False, True, False, True])
    np.testing.assert_array_equal(folds[1].judged, [True, False, True, False])


def test_unsupported_confidence_is_not_judged():
    ellipses = lognormal_ellipses(30, 2, 12)
    silent = PrintedCandidate(
        name="no promise", law=TabulatedLimits.fit([1.0], [0.02], [[0.0]], [[0.0]]), confidence=0.8
    )
    result = validate(
        ellipses, leave_one_event_out(ellipses["event"].values), (silent, QUANTILE), confidences=(0.8,)
    )
    assert result.counts["judged"].sel(candidate="no promise").sum() == 0
    assert set(tabulate(result)["candidate"]) == {"plug-in, each"}


def test_law_is_judged_at_the_unseen_structure():
    single = lognormal_ellipses(20, 2, 10)
    ellipses = xr.concat([single.assign_coords(f=[f]) for f in (0.5, 1.0, 2.0)], dim="f")
    ellipses = ellipses.assign(b=ellipses["b"] / ellipses["f"] ** 2)
    law = DerivedCandidate(name="law", method=method_of("quantile"), law=Dimensionless)
    folds = leave_structures_out(k_fold(ellipses["event"].values, 2), "f", [0.5, 1.0, 2.0])
    result = validate(ellipses.transpose(*ELLIPSE_DIMENSIONS), folds, (law,), confidences=(0.9,))
    judged_at = result.counts["judged"].sel(side="lag").sum("motion").squeeze().values
    np.testing.assert_array_equal(judged_at, [0, 40, 0])  # a law refuses to extrapolate
    assert result.containment()["rate"].item() == pytest.approx(0.9, abs=0.12)


def test_confusion_matrix_adds_up_to_the_trials():
    ellipses = lognormal_ellipses(30, 2, 11)
    result = validate(ellipses, leave_one_event_out(ellipses["event"].values), confidences=(0.9,), trials=128)
    matrix = result.confusion().squeeze()
    assert sum(int(matrix[name]) for name in matrix) == 60 * 128
    is_accepted = int(matrix["good_accepted"]) + int(matrix["bad_accepted"])
    assert int(matrix["bad_accepted"]) / is_accepted == pytest.approx(result.false_safe()["rate"].item())
    good = int(matrix["good_accepted"]) + int(matrix["good_rejected"])
    assert int(matrix["good_accepted"]) / good == pytest.approx(result.accepted_share()["rate"].item())


def test_transfer_never_learns_from_judged_earthquakes():
    sets = np.array(["far", "near", "far", "near", "far", "far"])
    events = np.array(["K", "K", "L", "M", "N", "N"])
    folds = list(transfer(sets, events, learned=["far"], judged=["near"]))
    assert [fold.name for fold in folds] == ["other earthquakes", "K"]
    np.testing.assert_array_equal(folds[0].judged, [False, False, False, True, False, False])
    np.testing.assert_array_equal(folds[1].learned, [False, False, True, False, True, True])
    np.testing.assert_array_equal(folds[1].judged, [False, True, False, False, False, False])
    with pytest.raises(InputError, match="among far, near"):
        list(transfer(sets, events, learned=["far"], judged=["nearby"]))


def test_bootstrap_interval_of_none_or_all_counts_earthquakes():
    """Ten of ten earthquakes leave a true share of 70 %, or a failure in 30 %, possible."""
    events = np.repeat(np.arange(10), 4).astype(str)
    good = np.stack([np.ones(40), np.zeros(40), np.arange(40) % 2], axis=1)
    low, high = event_bootstrap(good, np.ones_like(good), events)
    least = binomtest(10, 10).proportion_ci().low
    assert low.tolist() == pytest.approx([least, 0.0, 0.5])
    assert high.tolist() == pytest.approx([1.0, 1.0 - least, 0.5])
