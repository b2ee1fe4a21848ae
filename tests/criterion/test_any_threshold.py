"""Ellipses of errors that were not traced, beside ones that were."""

import numpy as np
import pytest

import reliab
from reliab.core.errors import InputError
from reliab.criterion.ellipse_table import EllipseTable
from reliab.criterion.shipped_tables import shipped_ellipses


@pytest.fixture(scope="module")
def traced():
    """Ellipses of synthetic motions at errors of which some are then asked for without them."""
    motions = reliab.load_motions("synthetic")[:3]
    return EllipseTable.from_dataset(
        reliab.ellipses(motions, f=[1.0], xi=[0.05], threshold=[0.005, 0.01, 0.03, 0.04, 0.05])
    )


def without(table, error):
    return table.take(threshold=~np.isclose(table.at["threshold"], error))


def apart(found, known):
    """Largest relative difference of the semi-axes of inscribed ellipses."""
    of_lag = (..., list(known.at["curve"]).index("inscribed"), list(known.at["side"]).index("lag"))
    pairs = (found.a, known.a), (found.b, known.b)
    return max(np.nanmax(np.abs(np.sqrt(one[of_lag] / other[of_lag]) - 1.0)) for one, other in pairs)


@pytest.mark.parametrize(("error", "largest"), [(0.005, 0.05), (0.04, 0.02)])
def test_an_error_that_was_not_traced_has_nearly_its_own_ellipses(traced, error, largest):
    known = traced.at_threshold(error)
    found = without(traced, error).at_threshold(error)
    assert found.at["threshold"].tolist() == [error]
    assert apart(found, known) < largest


def test_a_traced_error_is_taken_as_it_is(traced):
    place = int(np.flatnonzero(traced.at["threshold"] == 0.03)[0])
    assert np.array_equal(traced.at_threshold(0.03).a, traced.a[:, :, :, [place]], equal_nan=True)


@pytest.mark.parametrize("error", [0.0, -0.01, np.nan, np.inf, 0.3])
def test_an_error_beyond_the_traced_ones_is_refused(error):
    with pytest.raises(InputError, match="or trace boundaries"):
        shipped_ellipses("inscribed", "record", "rms").at_threshold(error)


def test_one_large_error_alone_serves_no_smaller_one(traced):
    only = traced.take(threshold=[int(np.argmax(traced.at["threshold"]))])
    with pytest.raises(InputError, match="Choose among"):
        only.at_threshold(0.04)
