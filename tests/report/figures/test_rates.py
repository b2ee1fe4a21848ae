"""Criteria that hold can be told from each other although one falls far short."""

import numpy as np
import pandas as pd

from reliab.report.sections import coverage_by_frequency


def rates_of(**levels):
    rows = [
        {"candidate": name, "f": f, "rate": level, "low": level - 0.02, "high": level + 0.02}
        for name, level in levels.items()
        for f in (0.5, 1.0, 2.0)
    ]
    return pd.DataFrame(rows)


def test_a_criterion_falling_far_short_has_its_own_axes():
    figure = coverage_by_frequency(rates_of(ours=0.95, theirs=0.97, printed=0.12), confidence=0.95)
    upper, lower = figure.axes
    assert upper.get_ylim()[0] > 90.0
    assert lower.get_ylim()[1] < 20.0
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert sorted(names) == ["ours", "printed", "stated 95 %", "theirs"]


def test_valid_criteria_share_axes():
    (axes,) = coverage_by_frequency(rates_of(ours=0.95, theirs=0.93), confidence=0.95).axes
    low, high = axes.get_ylim()
    assert 85.0 < low < 91.0
    assert 97.0 <= high <= 101.0


def test_seven_criteria_have_seven_colours():
    names = {f"criterion {rank}": 0.95 for rank in range(7)}
    (axes,) = coverage_by_frequency(rates_of(**names), confidence=0.95).axes
    colours = {
        line.get_color() for line in axes.lines if len(line.get_xdata()) == 3 and line.get_marker() != "None"
    }
    assert len(colours) >= 7
    assert np.isfinite(axes.get_ylim()).all()
