"""Frequencies and damping ratios of a law are positive, finite, at most 1e.30, and increasing."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.laws.law import checked_grid


@pytest.mark.parametrize(
    "wrong", [[0.0, 1.0], [-1.0, 1.0], [1.0, 1.0], [2.0, 1.0], [1.0, np.inf], [np.nan], [], [[1.0, 2.0]]]
)
def test_other_grids_are_refused(wrong):
    with pytest.raises(InputError, match=r"positive, finite, at most 1e\+30, and increasing"):
        checked_grid("frequencies", wrong)


@pytest.mark.parametrize("grid", [[0.25], [0.25, 0.5, 2.0]])
def test_a_grid_is_kept(grid):
    assert checked_grid("frequencies", grid).tolist() == grid
