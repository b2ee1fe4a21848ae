"""An actuator that leads is judged by limits of its own."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.criterion import Criterion
from reliab.criterion.derivation import derive_criterion
from reliab.criterion.published import published_criterion
from reliab.criterion.summary import summarise

STRUCTURE = (1.0, 0.02)


@pytest.fixture(scope="module")
def derived(two_sided):
    return derive_criterion(two_sided)


def test_each_side_has_its_own_limits(two_sided, derived):
    for side in ("lag", "lead"):
        alone = derive_criterion(two_sided.sel(side=side, drop=True))
        assert derived.limits(*STRUCTURE, side) == alone.limits(*STRUCTURE)
    assert derived.limits(*STRUCTURE, "lead")[1] > derived.limits(*STRUCTURE)[1]


def test_the_sign_of_the_delay_chooses_the_side(derived):
    (a, b), (a_lead, b_lead) = derived.limits(*STRUCTURE), derived.limits(*STRUCTURE, "lead")
    delay = np.array([1e-3, -1e-3, 0.0])
    expected = [1e-6 / a + 1.0 / b, 1e-6 / a_lead + 1.0 / b_lead, 1e-6 / a]
    np.testing.assert_allclose(derived.index(1.001, delay, *STRUCTURE), expected, rtol=1e-9)
    lag, lead, _ = derived.probability(1.001, delay, *STRUCTURE)
    assert lead > lag


def test_leads_come_back_from_json(derived):
    again = Criterion.from_json(derived.to_json())
    assert again == derived
    at = (1.002, -0.8e-3, *STRUCTURE)
    assert float(again.index(*at)) == float(derived.index(*at))
    assert float(again.probability(*at)) == pytest.approx(float(derived.probability(*at)), abs=1e-4)


def test_the_summary_names_the_lead(derived):
    found = summarise(derived, *STRUCTURE)
    assert (found["a_lead"], found["b_lead"]) == derived.limits(*STRUCTURE, "lead")
    assert found["lead_limit_ms"] ** 2 == pytest.approx(found["b_lead"])


def test_a_lead_is_not_judged_by_lags_alone(ellipses):
    lags_only = derive_criterion(ellipses)
    assert any("lags alone" in sentence for sentence in lags_only.provenance.warnings)
    assert summarise(lags_only, *STRUCTURE)["lead_limit_ms"] is None
    for judge in (lags_only.index, lags_only.probability):
        with pytest.raises(InputError, match="has no limits for leads"):
            judge(1.0, [1e-4, -1e-4], *STRUCTURE)


def test_the_papers_law_counts_a_lead_as_a_lag():
    law = published_criterion("guo_2017_18")
    assert float(law.index(1.0, -1e-4, *STRUCTURE)) == float(law.index(1.0, 1e-4, *STRUCTURE))


def test_too_few_leads_are_said_and_leave_the_lags(two_sided):
    few = two_sided.copy(deep=True)
    few["a"].loc[{"side": "lead", "f": 2.0}] = np.nan
    found = derive_criterion(few)
    assert found.lead_law is None
    assert any("Too few motions have a boundary for leads" in each for each in found.provenance.warnings)


@pytest.mark.parametrize("wrong", [(np.nan, 0.0), (1.0, np.inf)])
def test_indices_that_are_not_finite_are_refused(derived, wrong):
    with pytest.raises(InputError, match="must be finite"):
        derived.index(*wrong, *STRUCTURE)


def test_the_paper_rests_on_fitted_ellipses_and_every_other_method_on_inscribed_ones(two_sided, ellipses):
    paper = derive_criterion(two_sided, method="quantile")
    assert (paper.provenance.curve, paper.joint) == ("ellipse", False)
    assert paper.limits(*STRUCTURE) == derive_criterion(ellipses, method="quantile").limits(*STRUCTURE)
    default = derive_criterion(two_sided)
    assert (default.method, default.provenance.curve, default.joint) == ("dirichlet", "inscribed", True)
    fitted = derive_criterion(ellipses)
    assert float(default.limits(*STRUCTURE)[0]) == pytest.approx(
        0.9 * float(fitted.limits(*STRUCTURE)[0]), rel=1e-6
    )
    assert any("not inscribed" in each for each in derive_criterion(ellipses).provenance.warnings)
