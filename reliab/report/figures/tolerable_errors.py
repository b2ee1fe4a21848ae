"""Tolerable delay and amplitude error over the natural frequency, before a test."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from reliab.assessment import Tolerance
from reliab.report.axes import AMPLITUDE_LIMIT, DELAY_LIMIT, FREQUENCY, legend_below, name_axes
from reliab.report.style import letters, line, panels, styled
from reliab.significant import share_in_words
from reliab.vocabulary import MILLI

_HEIGHT = 76.0


@styled
def tolerable_errors_over_frequency(tolerances: Sequence[Tolerance]) -> Figure:
    """Draw how much amplitude error and delay a rig may have.

    Returns [ms].
    Returns two panels: amplitude error and delay [ms], each alone, over the frequency; a line a confidence.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, (r"$\sqrt{a}$, no delay", r"$\sqrt{b}$, no amplitude error"))
    for rank, confidence in enumerate(sorted({tolerance.confidence for tolerance in tolerances})):
        by_frequency = sorted(
            (tolerance for tolerance in tolerances if tolerance.confidence == confidence),
            key=lambda tolerance: tolerance.frequency,
        )
        f = np.array([tolerance.frequency for tolerance in by_frequency])
        promised = all(tolerance.promise is not None for tolerance in by_frequency)
        share = share_in_words(confidence if promised else None, decimals=0)
        name = f"{share} of the population's ground motions"
        axes[0, 0].plot(
            f,
            [tolerance.amplitude_error for tolerance in by_frequency],
            label=name,
            **line(rank, marker=True),
        )
        axes[0, 1].plot(
            f, [MILLI * tolerance.delay for tolerance in by_frequency], label=name, **line(rank, marker=True)
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
