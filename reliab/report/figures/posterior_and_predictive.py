"""Uncertainty that remains: the posterior of a quantile, and the distribution of a further motion."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.criterion import EllipseSample, MotionPredictive
from reliab.report.axes import A_PARAMETER, B_PARAMETER, label_logarithmic, legend_below, name_axes
from reliab.report.style import BLUE, GREEN, GREY, INK, PALE, VERMILION, letters, panels, styled
from reliab.sampling import NormalInverseChiSquared
from reliab.significant import significant
from reliab.vocabulary import PERCENT

_HEIGHT = 88.0
_POINTS = 241
_TAIL = 1e-3


@styled
def posterior_and_predictive(
    sample: EllipseSample, *, limits: tuple[float, float], confidence: float
) -> Figure:
    """Draw how well a quantile of the motions is known, and how a further motion is distributed.

    `confidence` [-].
    Returns above, posterior densities of the lognormal quantile; below, predictive distributions of a motion
    of a further earthquake with the motions as steps.
    """
    figure, axes = panels(2, 2, height=_HEIGHT)
    share = PERCENT * (1.0 - confidence)
    quantile, further = f"{significant(share)} % quantile", "a further motion"
    letters(axes, (f"{quantile} of $a$", f"{quantile} of $b$", f"{further}: $a$", f"{further}: $b$"))
    for k, (values, name) in enumerate(((sample.a, A_PARAMETER), (sample.b, B_PARAMETER))):
        _posterior(axes[0, k], values, limits[k], 1.0 - confidence)
        _predictive(axes[1, k], values, sample.events, limits[k], 1.0 - confidence)
        name_axes(axes[0, k], name, "Density [-]" if k == 0 else "")
        name_axes(axes[1, k], name, "Share below [-]" if k == 0 else "")
    legend_below(figure, axes[1, 0], columns=5)
    return figure


def _posterior(axes: Axes, values: NDArray[np.float64], limit: float, share: float) -> None:
    known = NormalInverseChiSquared.posterior(np.log(values))
    probability = np.linspace(_TAIL, 1.0 - _TAIL, _POINTS)
    at = known.quantile_of_quantile(share, probability)
    density = np.gradient(probability, at)
    axes.fill_between(np.exp(at), density, color=PALE, linewidth=0.0)
    axes.plot(np.exp(at), density, color=BLUE)
    low, high = np.exp(known.quantile_of_quantile(share, [0.025, 0.975]))
    axes.hlines(0.0, low, high, color=BLUE, linewidth=3.0)
    axes.axvline(limit, color=VERMILION, linestyle=(0, (5, 1.6)))
    axes.set_ylim(bottom=0.0)
    axes.set_yticks([])
    axes.ticklabel_format(axis="x", scilimits=(-2, 3), useMathText=True)


def _predictive(
    axes: Axes, values: NDArray[np.float64], events: NDArray[np.str_], limit: float, share: float
) -> None:
    logarithms = np.log(values)
    room = 0.15 * np.ptp(logarithms)
    least = min(logarithms.min(), np.log(limit)) if limit > 0.0 else logarithms.min()
    x = np.linspace(least - room, logarithms.max() + room, _POINTS)
    repeated = np.repeat(logarithms[:, None], x.size, axis=1)
    learned = MotionPredictive.fit(repeated, events).cumulative(x)
    axes.ecdf(values, color=GREY, linewidth=1.0, label="motions")
    axes.plot(np.exp(x), learned, color=BLUE, label="predictive")
    normal = NormalInverseChiSquared.posterior(logarithms)
    shares = np.linspace(_TAIL, 1.0 - _TAIL, _POINTS)
    axes.plot(
        np.exp(normal.predictive_quantile(shares)),
        shares,
        color=GREEN,
        linestyle=(0, (1.2, 1.2)),
        label="lognormal",
    )
    axes.axhline(share, color=INK, linewidth=0.7, linestyle=(0, (1, 2)), label=significant(share, 2))
    if limit > 0.0:
        axes.axvline(limit, color=VERMILION, linestyle=(0, (5, 1.6)), label="criterion")
    axes.set(xscale="log", xlim=tuple(np.exp([x[0], x[-1]])))
    label_logarithmic(axes.xaxis)
