"""The bivariate normal distribution function against SciPy's integration."""

import numpy as np
import pytest
import scipy

from reliab.criterion.methods.hierarchical.fit import both_below


@pytest.mark.parametrize("correlation", [-0.999, -0.6, 0.0, 0.3, 0.95, 0.9999])
@pytest.mark.parametrize(
    ("first", "second"), [(0.0, 0.0), (0.0, -1.2), (1.3, 0.0), (-2.0, 1.0), (-3.0, -2.5), (0.7, 0.9)]
)
def test_probability_equals_integration(first, second, correlation):
    integral = scipy.stats.multivariate_normal.cdf(
        [first, second], cov=[[1.0, correlation], [correlation, 1.0]], abseps=1e-12, releps=1e-12
    )
    assert both_below(first, second, correlation) == pytest.approx(integral, abs=1e-9)


def test_limits_far_out():
    assert both_below(40.0, -1.0, 0.5) == pytest.approx(scipy.special.ndtr(-1.0), rel=1e-12)
    assert both_below([-40.0, -38.0], 3.0, 0.9) == pytest.approx(0.0, abs=1e-16)
    assert np.isfinite(both_below(1e-310, -1e-310, 0.2))
