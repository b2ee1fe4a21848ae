"""Effects that cannot be told apart are named with the further test that would decide."""

import pytest

from reliab.discrepancy.result.missing_effect import _TELLS, remark, telling_test
from reliab.effects.registry import library


@pytest.mark.parametrize("pair", list(_TELLS), ids=sorted)
def test_pairs_are_effects_of_the_library_and_their_order_does_not_matter(pair):
    first, second = sorted(pair)
    assert {first, second} <= {str(name) for name in library()}
    assert telling_test(first, second) == telling_test(second, first) == _TELLS[pair]


def test_a_remark_names_both_effects_with_their_probabilities():
    sentence = remark("coulomb_friction", 0.62, ("viscous_damping", 0.31))
    assert "coulomb friction (62 %) from viscous damping (31 %)" in sentence
    assert "two speeds" in sentence
    unlisted_remark = remark("coulomb_friction", 0.62, ("added_mass", 0.31))
    assert "stronger input of wider band" in unlisted_remark
    assert "suggest gap, but do not settle it" in remark("gap", 0.4, None)


def test_rival_of_no_probability_is_not_named():
    """The rest of the probability then belongs to models without either effect."""
    assert "do not distinguish" not in remark("gap", 0.89, ("coulomb_friction", 0.003))
