"""Low-pass filters without delay."""

import numpy as np
import pytest

from reliab.signals.filters import _end_of_line


def test_the_end_of_a_line_is_that_of_least_squares():
    values = np.random.default_rng(3).standard_normal(17)
    line = np.polyfit(np.arange(17), values, 1)
    assert _end_of_line(values) == pytest.approx(np.polyval(line, 16))
