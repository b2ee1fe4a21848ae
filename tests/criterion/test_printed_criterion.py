"""The paper's own criterion, derived from its own table."""

import pytest

from reliab.criterion.derivation import derive_criterion
from reliab.criterion.ellipse_sample import sample_of
from reliab.criterion.methods.quantile import Quantile


def test_equation_12_follows_from_table_2(printed_table2):
    criterion = derive_criterion(printed_table2, f=1.0, xi=0.02, method=Quantile(), joint=False)
    a, b = criterion.limits(1.0, 0.02)
    assert float(a) == pytest.approx(5.29e-5, abs=0.005e-5)
    assert float(b) == pytest.approx(1.048, abs=0.0005)


def test_the_correlation_is_the_printed_one(printed_table2):
    sample = sample_of(printed_table2, frequency=1.0, damping_ratio=0.02, threshold=0.05, metric="rms")
    assert sample.correlation == pytest.approx(0.9774, abs=0.00005)
