"""Ellipse parameter b against a, motion by motion, with their correlation (Figure 11)."""

import numpy as np
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.criterion import EllipseSample
from reliab.report.axes import A_PARAMETER, B_PARAMETER, label_logarithmic, mark, name_axes, scientific
from reliab.report.style import BLUE, VERMILION, letters, panels, styled

_HEIGHT = 58.0
_RESAMPLINGS = 1000


@styled
def parameter_correlation(sample: EllipseSample) -> Figure:
    """Draw b against a, on linear scales with the fitted line and on logarithmic ones.

    Returns two panels; each names the correlation of what it shows. The band holds 95 % of the lines of
    resampled earthquakes.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, ("linear", "logarithmic"))
    for place in axes[0]:
        place.plot(sample.a, sample.b, "o", color=BLUE, markersize=3.4, fillstyle="none", label="one motion")
        name_axes(place, A_PARAMETER, B_PARAMETER)
    _line(axes[0, 0], sample)
    mark(axes[0, 0], f"correlation {sample.correlation:.3f}", (0.97, 0.10), ha="right")
    axes[0, 0].ticklabel_format(axis="x", style="sci", scilimits=(0, 0), useMathText=True)
    axes[0, 1].set(xscale="log", yscale="log")
    label_logarithmic(axes[0, 1].xaxis, axes[0, 1].yaxis)
    correlation = float(np.corrcoef(sample.log_a, sample.log_b)[0, 1])
    mark(axes[0, 1], f"correlation of the logarithms {correlation:.3f}", (0.97, 0.10), ha="right")
    return figure


def _line(axes: Axes, sample: EllipseSample) -> None:
    slope, intercept = np.polyfit(sample.a, sample.b, 1)
    axes.set(xlim=(0.0, 1.05 * sample.a.max()), ylim=(0.0, 1.05 * sample.b.max()))
    sns.regplot(
        x=sample.a,
        y=sample.b,
        units=sample.events,
        n_boot=_RESAMPLINGS,
        seed=0,
        scatter=False,
        truncate=False,
        color=VERMILION,
        label=f"$b$ = {scientific(slope)}$\\,a$ {intercept:+.2f} ms²".replace("-", "−"),
        line_kws={"linewidth": 1.2},
        ax=axes,
    )
    name_axes(axes, A_PARAMETER, B_PARAMETER)
    axes.legend(loc="upper left")
