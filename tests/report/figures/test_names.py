"""Names of earthquakes and motions in figures are short, drawn letter by letter, and never mathematics."""

import warnings

import numpy as np
import pytest
from cli.test_names import NAMES

from reliab.criterion.population import EllipseSample
from reliab.report.kinds.criterion.report import event_forest
from reliab.report.style import plain, svg


@pytest.fixture(scope="module")
def forest():
    """Motions of earthquakes with names of every hostile kind."""
    names = [name.encode("utf-8", "ignore").decode() for name in NAMES.values()]
    random = np.random.default_rng(3)
    a, b = np.exp(random.normal(-8.0, 0.3, 36)), np.exp(random.normal(1.0, 0.3, 36))
    events = np.array((names * 4)[:36])
    sample = EllipseSample(
        a=a,
        b=b,
        events=events,
        motions=events,
        frequency=1.0,
        damping_ratio=0.02,
        threshold=0.05,
        metric="rms",
    )
    return event_forest(sample, limits=(2e-4, 2.0))


@pytest.mark.slow
def test_a_figure_with_any_names_is_drawn_without_a_warning(forest):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert svg(forest) == svg(forest)


@pytest.mark.slow
def test_names_leave_most_of_the_width_to_the_drawing(forest):
    svg(forest)
    first, second = (place.get_position() for place in forest.axes[:2])
    assert first.width > 0.25
    assert second.width > 0.25
    assert all(len(label.get_text().replace("\\$", "$")) <= 24 for label in forest.axes[0].get_yticklabels())


@pytest.mark.parametrize("name", NAMES.values(), ids=NAMES)
def test_a_label_is_one_short_drawable_line(name):
    label = plain(name)
    assert len(label.replace("\\$", "$")) <= 60
    assert not set(label) & set("\n\r\x1b\x07\x08\u202e\u2028")
    assert label.count("$") == label.count("\\$")
