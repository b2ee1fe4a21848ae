"""Tests ranked by their errors, each with its interval, against the threshold."""

from typing import Final

import numpy as np
from matplotlib.figure import Figure

from reliab.assessment import Comparison
from reliab.report.axes import legend_below, plain
from reliab.report.style import BLUE, VERMILION, panels, styled
from reliab.significant import percent
from reliab.vocabulary import PERCENT, Metric

_MARGIN: Final = 26.0
_ROW: Final = 7.0
_TALLEST: Final = 220.0
_LONGEST: Final = 32  # characters of the name of a test
_NAMES: Final = {Metric.RMS: "RMS", Metric.MTE: "MTE"}


@styled
def ranked_tests(comparison: Comparison) -> Figure:
    """Draw the error of each test with its 90 % interval, the smallest above, and the threshold."""
    tests = comparison.tests
    figure, axes = panels(1, 1, height=min(_MARGIN + _ROW * len(tests), _TALLEST))
    place = axes[0, 0]
    rows = np.arange(len(tests))
    low, value, high = (
        PERCENT * np.array([getattr(test.error, end) for test in tests]) for end in ("low", "value", "high")
    )
    place.hlines(rows, low, high, color=BLUE, linewidth=1.4, label="90 % interval")
    place.plot(value, rows, "o", color=BLUE, markersize=4.0, label="error of the whole test")
    threshold = percent(comparison.threshold)
    place.axvline(
        PERCENT * comparison.threshold,
        color=VERMILION,
        linewidth=1.2,
        linestyle=(0, (5, 1.6)),
        label=f"threshold, {threshold}",
    )
    place.set_yticks(rows, [plain(test.file, longest=_LONGEST) for test in tests])
    place.set_ylim(len(tests) - 0.4, -0.6)
    place.set_xlim(left=0.0)
    place.set_xlabel(f"{_NAMES[comparison.metric]} error of the whole test [%]")
    legend_below(figure, place, columns=3)
    return figure
