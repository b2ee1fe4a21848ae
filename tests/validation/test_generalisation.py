"""Criteria that are learned in one place and judged in another."""

import numpy as np
import pytest
import xarray as xr

from reliab.criterion.methods import method_of
from reliab.errors import InputError
from reliab.validation.cross_validation import Derived
from reliab.validation.generalisation import law_generalisation, pooled, transfers
from reliab.validation.large_suites import draw_ellipses

QUANTILE = Derived(name="quantile", method=method_of("quantile"))


def test_pooled_suites_keep_what_they_share_and_never_share_an_earthquake():
    real = draw_ellipses(events=4, frequencies=(0.5, 1.0), seed=1)
    synthetic = draw_ellipses(events=3, frequencies=(1.0, 2.0), seed=2)
    together, sets = pooled({"real": real, "synthetic": synthetic})
    assert together["f"].values.tolist() == [1.0]
    assert sets.tolist() == ["real"] * 8 + ["synthetic"] * 6
    assert len(set(together["event"].values.tolist())) == 7
    np.testing.assert_array_equal(together["a"].sel(f=1.0)[:8], real["a"].sel(f=1.0))
    with pytest.raises(InputError, match="must share"):
        pooled({"real": real.sel(f=[0.5]), "synthetic": synthetic})


def test_transfer_between_like_suites_keeps_the_stated_share_and_between_unlike_ones_does_not():
    narrow = draw_ellipses(events=150, seed=3)
    wide = draw_ellipses(events=150, seed=4)
    smaller = wide.assign(a=0.3 * wide["a"], b=0.3 * wide["b"])
    for other, contained in ((wide, True), (smaller, False)):
        together, sets = pooled({"learned": narrow, "judged": other})
        found = transfers(together, sets, [("learned", "judged")], [QUANTILE], confidences=(0.9,))
        (rate,) = found["containment"]
        assert (abs(rate - 0.9) < 0.07) is contained
        assert found["learned"].tolist() == ["learned"]


def test_laws_are_judged_at_structures_that_they_did_not_see():
    one = draw_ellipses(events=20, seed=5)
    f, xi = np.array([0.5, 0.8, 1.3, 2.0]), np.array([0.02, 0.03, 0.05, 0.1])
    grid = [[one.assign_coords(f=[x], xi=[y]) for y in xi] for x in f]
    ellipses = xr.combine_nested(grid, concat_dim=["f", "xi"]).transpose(*one["a"].dims)
    growth = (ellipses["xi"] / 0.02) ** 2
    ellipses = ellipses.assign(a=ellipses["a"] * growth, b=ellipses["b"] * growth / ellipses["f"] ** 2)
    found = law_generalisation(ellipses, laws=("dimensionless",), method="quantile", confidences=(0.9,))
    assert set(found["left_out"]) == {"nothing", "f", "xi"}
    chosen = found.set_index(["left_out", "candidate"])["containment"]
    # The ellipses follow the dimensionless law, so that it holds where it has not been.
    for left_out in ("f", "xi"):
        assert chosen[left_out, "dimensionless"] == pytest.approx(chosen["nothing", "dimensionless"], abs=0.1)
