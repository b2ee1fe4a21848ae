"""Variance between and within earthquakes."""

import numpy as np
import pytest

from reliab.criterion.event_components import event_components


def drawn(rng, sizes, between, within):
    events = np.repeat(np.arange(len(sizes)), sizes)
    values = np.sqrt(between) * rng.normal(size=len(sizes))[events]
    return values + np.sqrt(within) * rng.normal(size=events.size), events.astype(str)


def test_components_are_unbiased_for_unequal_earthquakes():
    rng = np.random.default_rng(3)
    sizes = [2, 2, 4, 6, 12, 2, 8, 2, 2, 4]
    found = [event_components(*drawn(rng, sizes, 0.5, 1.0)) for _ in range(3000)]
    assert np.mean([each.within for each in found]) == pytest.approx(1.0, rel=0.03)
    assert np.mean([each.between for each in found]) == pytest.approx(0.5, rel=0.08)


def test_the_effective_number_is_that_of_the_mean():
    """Equal earthquakes: n_eff = n / (1 + (m − 1) ρ), the design effect of cluster sampling."""
    values, events = drawn(np.random.default_rng(5), [5] * 40, 1.0, 1.0)
    found = event_components(values, events)
    expected = 200 / (1.0 + 4.0 * float(found.event_share))
    assert float(found.effective_number) == pytest.approx(expected)


def test_observed_event_means_scatter_even_where_earthquakes_do_not():
    """The naive share of variance between event means is large without any effect of the earthquake."""
    values, events = drawn(np.random.default_rng(6), [5] * 20, 0.0, 1.0)
    means = np.array([values[events == event].mean() for event in np.unique(events)])
    assert means.var() / values.var() > 0.12
    assert float(event_components(values, events).event_share) < 0.05


@pytest.mark.parametrize("events", [np.zeros(10), np.arange(10)])
def test_motions_count_as_independent_where_nothing_tells(events):
    found = event_components(np.arange(10.0), events.astype(int).astype(str))
    assert (float(found.between), float(found.effective_number)) == (0.0, 10.0)


def test_several_quantities_are_done_at_once():
    values, events = drawn(np.random.default_rng(7), [3] * 10, 1.0, 1.0)
    both = event_components(np.stack([values, values**2], axis=1), events)
    for column, each in enumerate((values, values**2)):
        alone = event_components(each, events)
        assert both.between[column] == pytest.approx(float(alone.between))
        assert both.effective_number[column] == pytest.approx(float(alone.effective_number))
