"""The hierarchical posterior as a criterion."""

import numpy as np
import pytest

from reliab.criterion import Criterion, derive_criterion
from reliab.criterion.bayes import Ensembles, sample
from reliab.criterion.bayes.posterior_criterion import hierarchical_model, posterior_criterion
from reliab.criterion.methods import Predictive

pytestmark = pytest.mark.filterwarnings("ignore::reliab.criterion.bayes.ConvergenceWarning")
ERROR = {"threshold": 0.05, "metric": "rms"}


@pytest.fixture(scope="module")
def fitted(ellipses):
    model = hierarchical_model(ellipses, **ERROR, curved=False)
    return model, sample(model, Ensembles(steps=300, walkers=48))


def test_limits_are_near_those_of_each_structure_alone(ellipses, fitted):
    model, posterior = fitted
    found = posterior_criterion(ellipses, posterior, model, **ERROR, joint=False)
    alone = derive_criterion(ellipses, method=Predictive(), **ERROR)
    f, xi = np.array([0.5, 1.0, 2.0])[:, None], np.array([0.02, 0.05])
    for one, other in zip(found.limits(f, xi), alone.limits(f, xi), strict=True):
        np.testing.assert_allclose(np.log(one), np.log(other), atol=0.35)


def test_joint_limits_are_smaller(ellipses, fitted):
    model, posterior = fitted
    each, both = (
        posterior_criterion(ellipses, posterior, model, **ERROR, joint=joint) for joint in (False, True)
    )
    for one, other in zip(both.limits(1.0, 0.02), each.limits(1.0, 0.02), strict=True):
        assert one < other


def test_a_short_run_is_confessed_in_the_provenance(ellipses, fitted):
    model, _ = fitted
    short = sample(model, Ensembles(steps=20, walkers=48))
    found = posterior_criterion(ellipses, short, model, **ERROR)
    assert not found.provenance.settings["converged"]
    assert any("effective draws" in sentence for sentence in found.provenance.warnings)
    assert Criterion.from_json(found.to_json()) == found


def test_motions_without_an_ellipse_are_left_out(ellipses):
    lacking = ellipses.copy(deep=True)
    lacking["a"][3, 0, 0] = np.nan
    assert len(hierarchical_model(lacking, **ERROR).values) == ellipses.sizes["motion"] - 1
