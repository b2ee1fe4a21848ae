"""Charts of tests: errors that are tolerable before them, and tests ranked by their errors."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from reliab.assessment.comparison import Comparison
from reliab.assessment.design import TolerableErrors
from reliab.core.significant_digits import percent, share_in_words
from reliab.core.vocabulary import MILLI, PERCENT, Metric
from reliab.report.axes import AMPLITUDE_LIMIT, DELAY_LIMIT, FREQUENCY, legend_below, name_axes, plain
from reliab.report.style import BLUE, VERMILION, apply_style, letters, line, panels

_HEIGHT = 76.0


@apply_style
def tolerable_errors_over_frequency(tolerances: Sequence[TolerableErrors]) -> Figure:
    """Draw how much amplitude error and delay a rig may have.

    Returns [ms].
    Returns two panels: amplitude error and delay [ms], each alone, over the frequency; a line a confidence.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, (r"$\sqrt{a}$, no delay", r"$\sqrt{b}$, no amplitude error"))
    for rank, confidence in enumerate(sorted({tolerance.confidence for tolerance in tolerances})):
        ordered_tolerances = sorted(
            (tolerance for tolerance in tolerances if tolerance.confidence == confidence),
            key=lambda tolerance: tolerance.frequency,
        )
        f = np.array([tolerance.frequency for tolerance in ordered_tolerances])
        has_promise = all(tolerance.promise is not None for tolerance in ordered_tolerances)
        share = share_in_words(confidence if has_promise else None, decimals=0)
        name = f"{share} of comparable ground motions"
        axes[0, 0].plot(
            f,
            [tolerance.amplitude_error for tolerance in ordered_tolerances],
            label=name,
            **line(rank, marker=True),
        )
        axes[0, 1].plot(
            f,
            [MILLI * tolerance.delay for tolerance in ordered_tolerances],
            label=name,
            **line(rank, marker=True),
        )
    axes[0, 0].set_ylim(bottom=0.0)
    axes[0, 1].set_yscale("log")
    axes[0, 1].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0, 1].yaxis.set_major_formatter("{x:g}")
    axes[0, 1].yaxis.set_minor_locator(NullLocator())
    name_axes(axes[0, 0], FREQUENCY, AMPLITUDE_LIMIT)
    name_axes(axes[0, 1], FREQUENCY, DELAY_LIMIT)
    legend_below(figure, axes[0, 0], columns=2)
    return figure


_MARGIN: Final = 26.0
_ROW: Final = 7.0
_TALLEST: Final = 220.0
_LONGEST: Final = 32  # characters of the name of a test
_NAMES: Final = {Metric.RMS: "RMS", Metric.MTE: "MTE"}


@apply_style
def draw_ranked_tests(comparison: Comparison) -> Figure:
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
