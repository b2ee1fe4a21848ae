"""Every method of the registry."""

from itertools import pairwise

import numpy as np
import pytest

from reliab.core.errors import InputError
from reliab.criterion.methods.dirichlet import Dirichlet
from reliab.criterion.methods.method import BoundMethod, Scatter
from reliab.criterion.methods.order_statistic import OrderStatistic
from reliab.criterion.methods.quantile import Quantile
from reliab.criterion.methods.registry import METHODS, method_of
from reliab.criterion.motion_predictive import MotionPredictive

BOUND_METHODS = [name for name, method in METHODS.items() if issubclass(method, BoundMethod)]

EACH_METHOD = pytest.mark.parametrize(
    "method", [method_of(name) for name in BOUND_METHODS], ids=BOUND_METHODS
)
CONFIDENCES = (0.5, 0.8, 0.9, 0.95)


@pytest.fixture(scope="module")
def motions():
    """Logarithms of 120 motions from 40 earthquakes, skewed and alike within an earthquake."""
    rng = np.random.default_rng(4)
    events = np.repeat(np.arange(40), 3)
    logarithms = 0.4 * rng.normal(size=40)[events] + rng.gamma(4.0, 0.3, 120)
    return logarithms, events.astype(str)


@EACH_METHOD
def test_a_higher_confidence_gives_a_lower_bound(method, motions):
    bounds = [method.lower_bound(*motions, confidence) for confidence in CONFIDENCES]
    assert all(high > low for high, low in pairwise(bounds))


@EACH_METHOD
def test_the_bound_moves_and_scales_with_the_motions(method, motions):
    """Units are free: a · 7 moves the logarithms, and a² stretches them."""
    logarithms, events = motions
    bound = method.lower_bound(logarithms, events, 0.9)
    tight = {"abs": 5e-4 if method.name == "quantile" else 1e-8}
    assert method.lower_bound(logarithms + 7.0, events, 0.9) == pytest.approx(bound + 7.0, **tight)
    assert method.lower_bound(2.0 * logarithms, events, 0.9) == pytest.approx(2.0 * bound, **tight)


@EACH_METHOD
def test_the_order_of_the_motions_does_not_matter(method, motions):
    logarithms, events = motions
    mixture = np.random.default_rng(1).permutation(120)
    new_labels = np.char.add("another ", events)
    bound = method.lower_bound(logarithms[mixture], new_labels[mixture], 0.9)
    assert bound == pytest.approx(method.lower_bound(logarithms, events, 0.9), abs=1e-9)


@EACH_METHOD
def test_the_bound_lies_below_the_median(method, motions):
    assert method.lower_bound(*motions, 0.8) < np.median(motions[0])


@EACH_METHOD
@pytest.mark.parametrize("wrong", [0.0, 1.0, 95.0, -0.1, np.nan])
def test_a_confidence_outside_of_0_and_1_is_refused(method, motions, wrong):
    with pytest.raises(InputError, match="between 0 and 1"):
        method.lower_bound(*motions, wrong)


@pytest.mark.parametrize("name", ["tolerance", "order_statistic"])
def test_more_assurance_gives_a_lower_bound(name, motions):
    bounds = [method_of(name, assurance=item).lower_bound(*motions, 0.9) for item in (0.5, 0.8, 0.99)]  # type: ignore[attr-defined]
    assert bounds[0] > bounds[1] > bounds[2]
    with pytest.raises(InputError, match="assurance must lie"):
        method_of(name, assurance=95.0)


def test_an_unknown_method_is_refused_with_a_choice():
    with pytest.raises(InputError, match="quantile"):
        method_of("magic")


def test_settings_reach_their_methods():
    with pytest.raises(InputError, match="predictive has no assurance"):
        method_of("predictive", assurance=0.5)
    assert method_of("predictive", assurance=None) == method_of("predictive")
    assert method_of("tolerance", assurance=0.5) != method_of("tolerance")


SHAPES = {
    "normal": lambda rng, size: rng.normal(size=size),
    "long above": lambda rng, size: (rng.gamma(2.0, size=size) - 2.0) / np.sqrt(2.0),
    "long below": lambda rng, size: (4.0 - rng.gamma(4.0, size=size)) / 2.0,
    "heavy": lambda rng, size: rng.standard_t(5, size=size) / np.sqrt(5.0 / 3.0),
}
EVENT_SHARE = 0.3  # share of the variance between earthquakes
MIX = np.array([[1.0, 0.8], [0.0, 0.6]])  # of independent values to ln a and ln b


def exceedance(shape, earthquakes, motions, confidence, suites):
    """Share of further motions that do not contain joint limits, over the stated one, on average."""
    rng = np.random.default_rng(earthquakes)

    def drawn(*size):
        return SHAPES[shape](rng, (*size, 2))

    suite = np.sqrt(EVENT_SHARE) * drawn(earthquakes, 1, suites) + np.sqrt(1.0 - EVENT_SHARE) * drawn(
        earthquakes, motions, suites
    )
    additional = (np.sqrt(EVENT_SHARE) * drawn(20_000) + np.sqrt(1.0 - EVENT_SHARE) * drawn(20_000)) @ MIX
    logarithms = (suite @ MIX).reshape(earthquakes * motions, suites, 2)
    scatter = Scatter.from_logarithms(logarithms)
    events = np.repeat(np.arange(earthquakes), motions).astype(np.str_)
    fit = MotionPredictive.fit(scatter.worse(logarithms), events)
    limits = scatter.limits_at_depth(fit.quantile(1.0 - confidence))
    coverage = np.mean([(additional >= limit).all(axis=1).mean() for limit in limits])
    return (1.0 - coverage) / (1.0 - confidence)


@pytest.mark.parametrize("earthquakes", [4, 10, 19])
def test_bound_carried_by_earthquakes_holds_to_a_fifth(earthquakes):
    confidence = earthquakes / (earthquakes + 1.0)
    assert exceedance("normal", earthquakes, 3, confidence, suites=200) < 1.25


@pytest.mark.slow
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("motions", [1, 3])
@pytest.mark.parametrize("earthquakes", [4, 6, 10, 19])
def test_where_the_fitted_shape_carries_it_is_within_a_factor(earthquakes, motions, shape):
    """Beyond it the ratio grows without bound; that is where limits become zero."""
    carried = Dirichlet().achievable_confidence(earthquakes * motions, earthquakes)
    assert exceedance(shape, earthquakes, motions, carried, suites=400) < 2.6
    event_coverage = exceedance(shape, earthquakes, motions, earthquakes / (earthquakes + 1.0), suites=400)
    assert event_coverage < (1.3 if motions > 1 else 1.6)


def test_few_earthquakes_carry_little_and_one_nothing():
    carried = [Dirichlet().achievable_confidence(5 * count, count) for count in (1, 2, 3, 8, 19, 50)]
    assert carried[0] == 0.0
    assert np.all(np.diff(carried) > 0.0)
    assert carried[3] > 0.95 > carried[2]
    # 59 motions are the fewest for 95 % with an assurance of 95 % (Wilks 1941).
    assert (
        OrderStatistic().achievable_confidence(58, 58) < 0.95 < OrderStatistic().achievable_confidence(59, 59)
    )


def test_plug_in_quantile_states_its_coverage():
    """m − z·s of n lognormal motions, against 400,000 simulated suites."""
    rng = np.random.default_rng(1)
    values = rng.normal(size=(400_000, 8))
    bound = values.mean(axis=1) - 1.6448536 * values.std(axis=1)
    coverage = (rng.normal(size=400_000) >= bound).mean()
    assert Quantile().mean_share(0.95, 8) == pytest.approx(coverage, abs=0.002)
    assert coverage < 0.92
