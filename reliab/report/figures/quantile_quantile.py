"""Quantiles of the ellipse parameters against those of a fitted distribution (Q-Q plots)."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.criterion import EllipseSample, QuantilePlot, quantile_plot
from reliab.criterion.distributions import Distribution, Lognormal
from reliab.report.axes import label_logarithmic, legend_below, name_axes
from reliab.report.style import BLUE, INK, PALE, letters, panels, styled

_HEIGHT = 53.0


@styled
def quantile_quantile(sample: EllipseSample, family: type[Distribution] = Lognormal) -> Figure:
    """Draw a and b of the motions over the quantiles of a distribution that is fitted to them.

    Returns panels a [-] and b [ms²] on logarithmic scales, with bands that hold each point with 95 %.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, ("$a$", "$b$"))
    names = (("$a$", "-"), ("$b$", "ms²"))
    for place, values, (parameter, unit) in zip(axes[0], (sample.a, sample.b), names, strict=True):
        _draw(place, quantile_plot(values, family.fit(values)))
        name_axes(
            place,
            f"{family.name.capitalize()} quantile of {parameter} [{unit}]",
            f"{parameter} of motions [{unit}]",
        )
    legend_below(figure, axes[0, 0])
    return figure


def _draw(axes: Axes, points: QuantilePlot) -> None:
    axes.fill_between(
        points.expected, points.low, points.high, color=PALE, alpha=0.6, linewidth=0.0, label="95 % band"
    )
    axes.plot(points.expected, points.expected, color=INK, linewidth=0.8, label="as the distribution")
    axes.plot(points.expected, points.observed, "o", color=BLUE, fillstyle="none", label="motions")
    axes.set(xscale="log", yscale="log")
    label_logarithmic(axes.xaxis, axes.yaxis)
