"""Thresholds that an actuator at rest keeps are refused."""

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.derivation import derive_criterion, share_at_rest


def at_rest(ellipses, share):
    """Give a share of the motions an error at rest below 5 % at 2 Hz and ξ = 0.05, and 20 % elsewhere."""
    errors = np.full((60, 3, 2, 1), 0.2)
    errors[: round(60 * share), 2, 1] = 0.04
    return ellipses.assign(error_at_rest=(("motion", "f", "xi", "metric"), errors))


def test_a_threshold_that_nothing_exceeds_is_refused_where_it_means_nothing(ellipses):
    with pytest.raises(InputError, match=r"does not move .* 10 % .* f = 2 Hz and ξ = 0\.05"):
        derive_criterion(at_rest(ellipses, 0.10))
    found = derive_criterion(at_rest(ellipses, 0.10), f=1.0)
    assert found.limits(1.0, 0.02) == derive_criterion(ellipses, f=1.0).limits(1.0, 0.02)


def test_one_motion_in_twenty_is_not_held_against_it(ellipses):
    assert derive_criterion(at_rest(ellipses, 0.05)).threshold == 0.05


def test_motions_without_a_known_error_at_rest_do_not_count():
    assert share_at_rest(np.array([[np.nan], [np.nan]]), 0.05).tolist() == [0.0]
