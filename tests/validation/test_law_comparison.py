"""Laws are judged on earthquakes that they have not seen."""

import numpy as np
import pytest

from reliab.criterion.laws import FITTED, OF_MANY_MOTIONS, Dimensionless, Exponential, Power, Table
from reliab.errors import InputError
from reliab.shipped import shipped
from reliab.sweep import open_ellipses
from reliab.validation.law_comparison import compare_laws


def test_the_new_law_beats_the_printed_and_the_exponential_form_at_every_frequency(grouped_ellipses):
    table = compare_laws(grouped_ellipses)
    for column in ("log_score", "region_at_f"):
        found = table.pivot_table(index="f", columns="law", values=column)
        for other in ("exponential", "guo_2017_18"):
            assert (found["dimensionless"] > found[other]).all()


@pytest.mark.default_cases(1)
@pytest.mark.parametrize(
    ("damping_ratios", "others"),
    [(slice(None), ("exponential", "guo_2017_18")), ([0.02], ("guo_2017_15", "guo_2017_18"))],
    ids=["2 % to 10 %", "2 %"],
)
def test_on_real_records_the_new_law_beats_the_printed_ones_at_every_frequency(damping_ratios, others):
    real = open_ellipses(shipped("datasets", "real_suite/ellipses.nc")).sel(xi=damping_ratios)
    laws = {name: {**FITTED, **OF_MANY_MOTIONS}[name] for name in ("dimensionless", *others)}
    table = compare_laws(real, laws=laws)
    for column in ("log_score", "region_at_f"):
        found = table.pivot_table(index="f", columns="law", values=column)
        for other in others:
            assert (found["dimensionless"] > found[other]).all()


def test_coverage_is_equal_over_all_structures(grouped_ellipses):
    table = compare_laws(grouped_ellipses, confidence=0.9)
    np.testing.assert_allclose(table.groupby("law")["coverage"].mean(), 0.9, atol=0.01)


def test_a_law_that_is_true_is_not_beaten_by_more_than_noise(grouped_ellipses):
    table = compare_laws(grouped_ellipses, laws={"power": Power, "table": Table})
    scores = table.groupby("law")["log_score"].mean()
    assert scores["power"] > scores["table"] - 0.02


def test_scores_do_not_depend_on_the_order_of_motions(grouped_ellipses):
    order = np.random.default_rng(1).permutation(grouped_ellipses.sizes["motion"])
    laws = {"new": Dimensionless}
    np.testing.assert_allclose(
        compare_laws(grouped_ellipses.isel(motion=order), laws=laws).drop(columns="law"),
        compare_laws(grouped_ellipses, laws=laws).drop(columns="law"),
    )


def test_laws_that_do_not_hold_at_all_structures_are_left_out(grouped_ellipses):
    assert "guo_2017_15" not in set(compare_laws(grouped_ellipses)["law"])
    assert "guo_2017_15" in set(compare_laws(grouped_ellipses.sel(xi=[0.02]))["law"])


def test_missing_ellipses_are_refused(grouped_ellipses):
    lacking = grouped_ellipses.copy(deep=True)
    lacking["a"][0, 0, 0] = np.nan
    with pytest.raises(InputError, match="1 motions without"):
        compare_laws(lacking, laws={"old": Exponential})
