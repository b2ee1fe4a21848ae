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

_HEIGHT = 92.0
_WIDTH = 118.0
_FREQUENCY_HEIGHT = 78.0
_PERCENT = 100.0
_SHIFT = 0.006


@styled
def calibration_curve(rates: pd.DataFrame) -> Figure:
    """Draw the observed share of motions that a criterion contains over the stated confidence.

    Parameters
    ----------
    rates : pandas.DataFrame
        Columns candidate, confidence, rate, low, high.

    Returns
    -------
    matplotlib.figure.Figure
        Both shares [%]; a criterion that keeps its word lies on the diagonal.
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    least = _PERCENT * min(rates["confidence"].min(), rates["low"].min())
    ends = (max(0.0, least - 3.0), 101.0)
    place.plot(ends, ends, color=GREY, linewidth=0.9, label="observed as stated")
    for rank, (name, chosen) in enumerate(rates.groupby("candidate", sort=False)):
        _curve(place, _PERCENT * chosen[["confidence", "rate", "low", "high"]], str(name), rank)
    place.set(xlim=ends, ylim=ends, aspect="equal")
    name_axes(place, "Stated confidence [%]", "Observed containment [%]")
    legend_below(figure, place, columns=3)
    return figure


@styled
def coverage_by_frequency(rates: pd.DataFrame, *, confidence: float) -> Figure:
    """Draw the observed containment over the natural frequency at one stated confidence.

    Parameters
    ----------
    rates : pandas.DataFrame
        Columns candidate, f, rate, low, high; one confidence.
    confidence : float
        What is stated [-].

    Returns
    -------
    matplotlib.figure.Figure
        Observed containment [%] with intervals over the frequency [Hz].
    """
    figure, axes = panels(height=_FREQUENCY_HEIGHT)
    place = axes[0, 0]
    stated = _PERCENT * confidence
    place.axhline(stated, color=INK, linewidth=0.9, linestyle=(0, (1, 2)), label=f"stated {stated:g} %")
    groups = list(rates.groupby("candidate", sort=False))
    for rank, (name, chosen) in enumerate(groups):
        ordered = chosen.sort_values("f")
        percent = _PERCENT * ordered[["rate", "low", "high"]]
        shifted = ordered["f"] * np.exp(_SHIFT * 2.0 * (rank - 0.5 * (len(groups) - 1)))
        _curve(place, percent.assign(confidence=shifted), str(name), rank)
    place.set(xscale="log", ylim=(max(0.0, _PERCENT * rates["low"].min() - 3.0), 101.0))
    ticks = np.unique(rates["f"]).tolist()
    place.set_xticks(ticks, [f"{each:g}" for each in ticks], minor=False)
    place.set_xticks([], minor=True)
    name_axes(place, FREQUENCY, "Observed containment [%]")
    legend_below(figure, place, columns=3)
    return figure


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
