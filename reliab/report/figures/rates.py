"""What criteria really contain: the calibration curve, and containment by frequency.

Both draw a table of rates with the columns `candidate`, `confidence` (stated), `f` [Hz] (NaN over all
structures), `rate`, `low` and `high` (ends of a 95 % interval that respects the earthquakes), shares [-].
"""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.report.axes import FREQUENCY, legend_below, name_axes, plain
from reliab.report.style import GREY, INK, line, panels, styled
from reliab.vocabulary import PERCENT

_HEIGHT = 76.0
_WIDTH = 102.0
_FREQUENCY_HEIGHT = 78.0
_SPLIT_HEIGHT = 92.0
_SHIFT = 0.006
_FAR = 0.8  # of what is stated; a criterion that contains less everywhere has axes of its own


@styled
def calibration_curve(rates: pd.DataFrame) -> Figure:
    """Draw the observed share of motions that a criterion contains over the stated confidence.

    Returns [%].
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    least = PERCENT * min(rates["confidence"].min(), rates["low"].min())
    ends = (max(0.0, least - 3.0), 101.0)
    place.plot(ends, ends, color=GREY, linewidth=0.9, label="observed as stated")
    for rank, (name, curve) in enumerate(rates.groupby("candidate", sort=False)):
        _curve(place, PERCENT * curve[["confidence", "rate", "low", "high"]], str(name), rank)
    place.set(xlim=ends, ylim=ends, aspect="equal")
    name_axes(place, "Stated confidence [%]", "Observed containment [%]")
    legend_below(figure, place, columns=3)
    return figure


@styled
def coverage_by_frequency(rates: pd.DataFrame, *, confidence: float) -> Figure:
    """Draw the observed containment over the natural frequency at one stated confidence.

    `confidence` [-].
    Returns observed containment [%] with intervals over the frequency [Hz]; criteria that fall far short of
    what is stated are drawn in separate axes, so that the others can be distinguished.
    """
    promise = PERCENT * confidence
    groups = list(rates.groupby("candidate", sort=False))
    far = {str(name) for name, curve in groups if curve["rate"].max() < _FAR * confidence}
    near = rates[~rates["candidate"].isin(far)]
    split = bool(far) and len(near) > 0
    figure, axes = (
        panels(2, height=_SPLIT_HEIGHT, share_x=True, heights=(2.2, 1.0))
        if split
        else panels(height=_FREQUENCY_HEIGHT)
    )
    for rank, (name, curve) in enumerate(groups):
        ordered = curve.sort_values("f")
        percent = PERCENT * ordered[["rate", "low", "high"]]
        shifted = ordered["f"] * np.exp(_SHIFT * 2.0 * (rank - 0.5 * (len(groups) - 1)))
        row = 1 if split and str(name) in far else 0
        _curve(axes[row, 0], percent.assign(confidence=shifted), str(name), rank)
    groups_of_axes = (near, rates[rates["candidate"].isin(far)]) if split else (rates,)
    for place, drawn in zip(axes[:, 0], groups_of_axes, strict=True):
        _scale(place, drawn, promise)
    axes[0, 0].axhline(
        promise, color=INK, linewidth=0.9, linestyle=(0, (1, 2)), label=f"stated {promise:g} %"
    )
    for place in axes[:, 0]:
        name_axes(place, FREQUENCY if place is axes[-1, 0] else "", "Contained [%]")
    legend_below(figure, axes[0, 0], *axes[1:, 0], columns=3)
    return figure


def _scale(axes: Axes, rates: pd.DataFrame, promise: float) -> None:
    """Spread what is drawn over the whole height; criteria that fall far short have axes of their own."""
    low, high = PERCENT * float(rates["low"].min()), PERCENT * float(rates["high"].max())
    margin = 0.06 * (max(high, promise) - low) if high > _FAR * promise else 0.06 * (high - low) + 1.0
    axes.set(xscale="log", ylim=(max(-margin, low - margin), min(high + margin, PERCENT + margin)))
    ticks = np.unique(rates["f"]).tolist()
    axes.set_xticks(ticks, [f"{frequency:g}" for frequency in ticks], minor=False)
    axes.set_xticks([], minor=True)


def _curve(axes: Axes, percent: pd.DataFrame, name: str, rank: int) -> None:
    x, rate = percent["confidence"].to_numpy(), percent["rate"].to_numpy()
    reach = np.stack([rate - percent["low"].to_numpy(), percent["high"].to_numpy() - rate])
    axes.errorbar(
        x,
        rate,
        yerr=np.maximum(reach, 0.0),
        label=plain(name),
        capsize=2.0,
        elinewidth=0.8,
        **line(rank, marker=True),
    )
