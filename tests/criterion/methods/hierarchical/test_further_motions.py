"""Quantiles of further motions in closed form, against motions that are drawn."""

import numpy as np
import pytest

from reliab.criterion.methods.hierarchical.fit import FurtherMotions
from reliab.criterion.methods.hierarchical.model import Hierarchical
from reliab.criterion.methods.method import Scatter

MOTIONS = 60_000


def model(*, robust, frequencies=(0.5, 1.0, 2.0), damping_ratios=(0.02, 0.05, 0.1)):
    return Hierarchical(
        values=np.zeros((4, len(frequencies), len(damping_ratios), 2)),
        events=np.array(["K", "K", "L", "L"]),
        frequencies=np.array(frequencies),
        damping_ratios=np.array(damping_ratios),
        robust=robust,
    )


def parameters(model):
    """Two vectors: the prior's means, and one with other spreads, correlations and heavy tails."""
    means = np.array([parameter.mean for parameter in model.parameters])
    second = means + np.linspace(-0.6, 0.6, means.size)
    if model.robust:
        second[-1] = np.log(2.5)
    return np.stack([means, second])


@pytest.mark.slow
@pytest.mark.default_cases(1)
@pytest.mark.parametrize("robust", [False, True])
@pytest.mark.parametrize("joint", [False, True])
def test_the_stated_share_of_drawn_motions_exceeds_the_depth(robust, joint):
    hierarchy = model(robust=robust)
    theta = parameters(hierarchy)
    scatter = Scatter(centre=np.full((3, 3, 2), [-0.8, -1.1]), spread=np.full((3, 3, 2), [0.7, 0.5]))
    depth = FurtherMotions.from_draws(hierarchy, theta).depth(0.95, scatter, joint=joint)
    samples = hierarchy.draw_motions(theta, np.arange(MOTIONS), np.random.default_rng(3))
    upper = scatter.standard(samples) >= depth[:, None]
    share = upper.all(axis=-1) if joint else upper
    np.testing.assert_allclose(share.mean(axis=1), 0.95, atol=4.5 * np.sqrt(0.95 * 0.05 / MOTIONS))


def test_one_structure_without_slopes():
    hierarchy = model(robust=False, frequencies=(1.0,), damping_ratios=(0.02,))
    theta = parameters(hierarchy)[:1]
    scatter = Scatter(centre=np.zeros((1, 1, 2)), spread=np.ones((1, 1, 2)))
    depth = FurtherMotions.from_draws(hierarchy, theta).depth(0.5, scatter, joint=False)
    np.testing.assert_allclose(depth, hierarchy.coefficients(theta)[:, None], atol=1e-9)
