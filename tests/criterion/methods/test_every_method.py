"""What must hold for every meaning of confidence."""

from itertools import pairwise

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.methods.bound import BoundMethod
from reliab.criterion.methods.registry import METHODS, method_of

BOUND_METHODS = [name for name, method in METHODS.items() if issubclass(method, BoundMethod)]

EVERY = pytest.mark.parametrize("method", [method_of(name) for name in BOUND_METHODS], ids=BOUND_METHODS)
CONFIDENCES = (0.5, 0.8, 0.9, 0.95)


@pytest.fixture(scope="module")
def motions():
    """Logarithms of 120 motions from 40 earthquakes, skewed and alike within an earthquake."""
    rng = np.random.default_rng(4)
    events = np.repeat(np.arange(40), 3)
    logarithms = 0.4 * rng.normal(size=40)[events] + rng.gamma(4.0, 0.3, 120)
    return logarithms, events.astype(str)


@EVERY
def test_a_higher_confidence_gives_a_lower_bound(method, motions):
    bounds = [method.lower_bound(*motions, confidence) for confidence in CONFIDENCES]
    assert all(high > low for high, low in pairwise(bounds))


@EVERY
def test_the_bound_moves_and_scales_with_the_motions(method, motions):
    """Units are free: a · 7 moves the logarithms, and a² stretches them."""
    logarithms, events = motions
    bound = method.lower_bound(logarithms, events, 0.9)
    tight = {"abs": 5e-4 if method.name == "quantile" else 1e-8}
    assert method.lower_bound(logarithms + 7.0, events, 0.9) == pytest.approx(bound + 7.0, **tight)
    assert method.lower_bound(2.0 * logarithms, events, 0.9) == pytest.approx(2.0 * bound, **tight)


@EVERY
def test_the_order_of_the_motions_does_not_matter(method, motions):
    logarithms, events = motions
    mixed = np.random.default_rng(1).permutation(120)
    relabelled = np.char.add("another ", events)
    bound = method.lower_bound(logarithms[mixed], relabelled[mixed], 0.9)
    assert bound == pytest.approx(method.lower_bound(logarithms, events, 0.9), abs=1e-9)


@EVERY
def test_the_bound_lies_below_the_median(method, motions):
    assert method.lower_bound(*motions, 0.8) < np.median(motions[0])


@EVERY
@pytest.mark.parametrize("wrong", [0.0, 1.0, 95.0, -0.1, np.nan])
def test_a_confidence_outside_of_0_and_1_is_refused(method, motions, wrong):
    with pytest.raises(InputError, match="between 0 and 1"):
        method.lower_bound(*motions, wrong)


@pytest.mark.parametrize("name", ["tolerance", "order_statistic"])
def test_more_assurance_gives_a_lower_bound(name, motions):
    bounds = [method_of(name, assurance=each).lower_bound(*motions, 0.9) for each in (0.5, 0.8, 0.99)]  # type: ignore[attr-defined]
    assert bounds[0] > bounds[1] > bounds[2]
    with pytest.raises(InputError, match="assurance must lie"):
        method_of(name, assurance=95.0)


def test_an_unknown_method_is_refused_with_a_choice():
    with pytest.raises(InputError, match="quantile"):
        method_of("magic")


def test_settings_go_to_the_methods_that_have_them():
    with pytest.raises(InputError, match="predictive has no assurance"):
        method_of("predictive", assurance=0.5)
    assert method_of("predictive", assurance=None) == method_of("predictive")
    assert method_of("tolerance", assurance=0.5) != method_of("tolerance")
