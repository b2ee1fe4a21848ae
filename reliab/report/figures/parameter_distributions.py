"""Distributions of the ellipse parameters over ground motions (Figure 12)."""

from collections.abc import Mapping

import numpy as np
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.criterion import EllipseSample
from reliab.criterion.distributions import Distribution
from reliab.report.axes import A_PARAMETER, B_PARAMETER, DENSITY_A, DENSITY_B, legend_below, name_axes
from reliab.report.style import INK, PALE, letters, line, panels, styled

_HEIGHT = 53.0
_POINTS = 400
_BODY = 0.97


@styled
def parameter_distributions(
    sample: EllipseSample,
    fits: Mapping[str, tuple[Distribution, Distribution]],
    *,
    limits: tuple[float, float],
    confidence: float,
) -> Figure:
    """Draw histograms of a and b with fitted densities and the limits of a criterion.

    `confidence` [-].
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, ("amplitude", "delay"))
    names = ((A_PARAMETER, DENSITY_A), (B_PARAMETER, DENSITY_B))
    for k, (values, place) in enumerate(zip((sample.a, sample.b), axes[0], strict=True)):
        _draw(place, values, {name: pair[k] for name, pair in fits.items()})
        place.axvline(
            limits[k],
            color=INK,
            linewidth=1.4,
            linestyle=(0, (4, 1.5)),
            label=f"criterion at {100 * confidence:g} %",
        )
        name_axes(place, *names[k])
    axes[0, 0].ticklabel_format(axis="x", style="sci", scilimits=(0, 0), useMathText=True)
    legend_below(figure, axes[0, 0])
    return figure


def _draw(axes: Axes, values: NDArray[np.float64], fits: Mapping[str, Distribution]) -> None:
    end = 1.15 * float(np.quantile(values, _BODY))
    outside = int((values > end).sum())
    width = 2.0 * np.subtract(*np.quantile(values, [0.75, 0.25])) / values.size ** (1.0 / 3.0)
    bins = np.arange(0.0, end + width, width)
    sns.histplot(
        x=values,
        bins=bins.tolist(),
        weights=np.full(values.size, 1.0 / (values.size * width)),
        color=PALE,
        edgecolor="white",
        alpha=1.0,
        label="motions",
        ax=axes,
    )
    x = np.linspace(0.0, bins[-1], _POINTS)[1:]
    for rank, (name, fit) in enumerate(fits.items()):
        axes.plot(x, np.exp(fit.log_density(x)), label=name, **line(rank))
    axes.set_xlim(0.0, bins[-1])
    if outside:
        axes.text(
            0.98,
            0.96,
            f"{outside} of {values.size} beyond",
            transform=axes.transAxes,
            ha="right",
            va="top",
            fontsize=8.0,
        )
