"""Figures of ellipse parameters over the motions: distributions, quantiles, correlation, chains."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill

import numpy as np
import scipy
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.core.significant_digits import significant
from reliab.core.vocabulary import PERCENT
from reliab.criterion.cautions import QuantilePlot, quantile_plot
from reliab.criterion.distributions import Distribution, Lognormal
from reliab.criterion.motion_predictive import MotionPredictive
from reliab.criterion.population import EllipseSample
from reliab.report.style import (
    A_PARAMETER,
    AMPLITUDE,
    B_PARAMETER,
    BLUE,
    DAMPING_RATIO,
    DELAY,
    DENSITY_A,
    DENSITY_B,
    FREQUENCY,
    GREEN,
    GREY,
    INK,
    PALE,
    VERMILION,
    apply_style,
    blank,
    ellipse_line,
    label_logarithmic,
    legend_below,
    letters,
    line,
    mark,
    name_axes,
    panels,
    plain,
    scientific,
)
from reliab.sampling.normal_inverse_chi_squared import NormalInverseChiSquared
from reliab.sampling.posterior_sample import PosteriorSample, walkers_in_turn

_ROW = 26.0
_CELL = 30.0
_LABEL = 18
_RANK_BINS = 20
_DRAWS = 1000
"""Draws of an ensemble that are drawn; all of them would make large files and no other picture."""


@apply_style
def traces(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw the density and the course of the draws of each ensemble.

    Returns one row for each parameter; ensembles that have converged lie over one another and run level.
    """
    names = list(parameters or posterior.names)
    figure, axes = panels(len(names), 2, height=14.0 + _ROW * len(names), ratios=(1.0, 2.0))
    number, chains = _thin_draws(posterior)
    for (density, course), name in zip(axes, names, strict=True):
        for rank, values in enumerate(chains[..., posterior.names.index(name)]):
            colour = line(rank)["color"]
            _density(density, values, colour)
            course.plot(number, values, color=colour, linewidth=0.2, alpha=0.6)
        density.set_yticks([])
        density.set_title(plain(name))
        course.set_title(_convergence(posterior, name))
        name_axes(density, "Value [-]" if name == names[-1] else "", "Density [-]")
        name_axes(course, "Draw of the ensemble [-]" if name == names[-1] else "", "Value [-]")
    return figure


@apply_style
def ranks(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw how the draws of each ensemble rank among all draws.

    Returns one panel for each parameter; ensembles that have converged are uniform, near the level line.
    """
    names = list(parameters or posterior.names)
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    figure, axes = panels(rows, columns, height=14.0 + 34.0 * rows, share_y=True)
    places = axes.ravel()
    for place in places[len(names) :]:
        place.remove()
    for place, name in zip(places, names, strict=False):
        values = walkers_in_turn(posterior.draws)[..., posterior.names.index(name)]
        for rank, ratio in enumerate(_rank_histograms(values)):
            place.stairs(ratio, np.linspace(0.0, values.size, _RANK_BINS + 1), baseline=None, **line(rank))
        place.axhline(1.0, color=INK, linewidth=0.6)
        place.set_title(plain(name))
        name_axes(place, "Rank among all draws [-]", "Draws over expected [-]" if place in axes[:, 0] else "")
    return figure


@apply_style
def pairs(posterior: PosteriorSample, parameters: Sequence[str]) -> Figure:
    """Draw the joint distributions of a few parameters."""
    count = len(parameters)
    figure = blank(height=min(160.0, 10.0 + _CELL * count))
    axes = figure.subplots(count, count, squeeze=False)
    draws = _thin_draws(posterior)[1].reshape(-1, len(posterior.names))
    values = [draws[:, posterior.names.index(name)] for name in parameters]
    for (row, column), place in np.ndenumerate(axes):
        if column > row:
            place.remove()
            continue
        if row == column:
            _density(place, values[row], BLUE)
            place.set_yticks([])
        else:
            place.plot(values[column], values[row], ".", markersize=1.0, mew=0.0, alpha=0.6, color=BLUE)
        place.tick_params(labelbottom=row == count - 1, labelleft=column == 0)
        x_label = _label(parameters[column]) if row == count - 1 else ""
        up = _label(parameters[row]) if column == 0 and row > 0 else ""
        name_axes(place, x_label, up)
    return figure


def _density(place: Axes, values: NDArray[np.float64], colour: str) -> None:
    sns.kdeplot(x=values, ax=place, color=colour, linewidth=0.9, cut=0, warn_singular=False)


def _rank_histograms(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Draws of each ensemble among equal parts of all ranks, over what is expected where all are alike.

    Shape (ensembles, parts).
    """
    ranks = scipy.stats.rankdata(values, axis=None).reshape(values.shape)
    expected_count = values.shape[1] / _RANK_BINS
    ends = (0.5, values.size + 0.5)
    return np.array([np.histogram(chain, _RANK_BINS, range=ends)[0] / expected_count for chain in ranks])


def _thin_draws(posterior: PosteriorSample) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Take a thousand draws of each ensemble: their numbers, and shape (ensembles, draws, parameters)."""
    chains = walkers_in_turn(posterior.draws)
    number = np.unique(np.linspace(0, chains.shape[1] - 1, _DRAWS).astype(int))
    return number, chains[:, number]


def _label(name: str) -> str:
    return fill(f"{plain(name)} [-]", _LABEL)


def _convergence(posterior: PosteriorSample, name: str) -> str:
    diagnostics, k = posterior.diagnostics, posterior.names.index(name)
    size = min(diagnostics.bulk_size[k], diagnostics.tail_size[k])
    return rf"$\hat{{R}}$ = {diagnostics.r_hat[k]:.3f}, {size:.0f} effective draws"


_DISTRIBUTION_HEIGHT = 53.0
_ELLIPSE_HEIGHT = 84.0
_SERIES_HEIGHT = 58.0
_POINTS = 400
_BODY = 0.97
_QUANTILE_HEIGHT = 53.0
_CORRELATION_HEIGHT = 58.0
_RESAMPLINGS = 1000
_PREDICTIVE_HEIGHT = 88.0
_PREDICTIVE_POINTS = 241
_TAIL = 1e-3


@apply_style
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
    figure, axes = panels(1, 2, height=_DISTRIBUTION_HEIGHT)
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
    beyond_count = int((values > end).sum())
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
    if beyond_count:
        axes.text(
            0.98,
            0.96,
            f"{beyond_count} of {values.size} beyond",
            transform=axes.transAxes,
            ha="right",
            va="top",
            fontsize=8.0,
        )


@apply_style
def quantile_quantile(sample: EllipseSample) -> Figure:
    """Draw a and b of the motions over the quantiles of a distribution that is fitted to them.

    Returns panels a [-] and b [ms²] on logarithmic scales, with bands that hold each point with 95 %.
    """
    figure, axes = panels(1, 2, height=_QUANTILE_HEIGHT)
    letters(axes, ("$a$", "$b$"))
    names = (("$a$", "-"), ("$b$", "ms²"))
    for place, values, (parameter, unit) in zip(axes[0], (sample.a, sample.b), names, strict=True):
        _draw_quantiles(place, quantile_plot(values, Lognormal.fit(values)))
        name_axes(
            place,
            f"{Lognormal.name.capitalize()} quantile of {parameter} [{unit}]",
            f"{parameter} of motions [{unit}]",
        )
    legend_below(figure, axes[0, 0])
    return figure


def _draw_quantiles(axes: Axes, points: QuantilePlot) -> None:
    axes.fill_between(
        points.expected, points.low, points.high, color=PALE, alpha=0.6, linewidth=0.0, label="95 % band"
    )
    axes.plot(points.expected, points.expected, color=INK, linewidth=0.8, label="as the distribution")
    axes.plot(points.expected, points.observed, "o", color=BLUE, fillstyle="none", label="motions")
    axes.set(xscale="log", yscale="log")
    label_logarithmic(axes.xaxis, axes.yaxis)


@apply_style
def parameter_correlation(sample: EllipseSample) -> Figure:
    """Draw b against a, on linear scales with the fitted line and on logarithmic ones.

    Returns two panels; each names the correlation of what it shows. The band holds 95 % of the lines of
    resampled earthquakes.
    """
    figure, axes = panels(1, 2, height=_CORRELATION_HEIGHT)
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


@apply_style
def posterior_and_predictive(
    sample: EllipseSample, *, limits: tuple[float, float], confidence: float
) -> Figure:
    """Draw how well a quantile of the motions is known, and how a further motion is distributed.

    `confidence` [-].
    Returns above, posterior densities of the lognormal quantile; below, predictive distributions of a motion
    of a further earthquake with the motions as steps.
    """
    figure, axes = panels(2, 2, height=_PREDICTIVE_HEIGHT)
    share = PERCENT * (1.0 - confidence)
    quantile, next_motion = f"{significant(share)} % quantile", "a further motion"
    letters(axes, (f"{quantile} of $a$", f"{quantile} of $b$", f"{next_motion}: $a$", f"{next_motion}: $b$"))
    for k, (values, name) in enumerate(((sample.a, A_PARAMETER), (sample.b, B_PARAMETER))):
        _posterior(axes[0, k], values, limits[k], 1.0 - confidence)
        _predictive(axes[1, k], values, sample.events, limits[k], 1.0 - confidence)
        name_axes(axes[0, k], name, "Density [-]" if k == 0 else "")
        name_axes(axes[1, k], name, "Share below [-]" if k == 0 else "")
    legend_below(figure, axes[1, 0], columns=5)
    return figure


def _posterior(axes: Axes, values: NDArray[np.float64], limit: float, share: float) -> None:
    posterior = NormalInverseChiSquared.posterior(np.log(values))
    probability = np.linspace(_TAIL, 1.0 - _TAIL, _PREDICTIVE_POINTS)
    position = posterior.quantile_of_quantile(share, probability)
    density = np.gradient(probability, position)
    axes.fill_between(np.exp(position), density, color=PALE, linewidth=0.0)
    axes.plot(np.exp(position), density, color=BLUE)
    low, high = np.exp(posterior.quantile_of_quantile(share, [0.025, 0.975]))
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
    x = np.linspace(least - room, logarithms.max() + room, _PREDICTIVE_POINTS)
    columns = np.repeat(logarithms[:, None], x.size, axis=1)
    probabilities = MotionPredictive.fit(columns, events).cumulative(x)
    axes.ecdf(values, color=GREY, linewidth=1.0, label="motions")
    axes.plot(np.exp(x), probabilities, color=BLUE, label="predictive")
    normal = NormalInverseChiSquared.posterior(logarithms)
    shares = np.linspace(_TAIL, 1.0 - _TAIL, _PREDICTIVE_POINTS)
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


_WIDEST = 0.98


@apply_style
def ellipses_and_criterion(sample: EllipseSample, criteria: Mapping[str, tuple[float, float]]) -> Figure:
    """Draw the boundary of every motion and the criteria that should lie inside of nearly all.

    Returns delay [ms] over amplitude [-]; early and late actuators mirror each other, so that one half is
    drawn.
    """
    figure, axes = panels(height=_ELLIPSE_HEIGHT)
    place = axes[0, 0]
    amplitude, delay = ellipse_line(sample.a, sample.b)
    thin = place.plot(amplitude, delay, color=GREY, linewidth=0.5, alpha=0.6)
    thin[0].set_label(f"{sample.n_motions} motions of {sample.n_events} earthquakes")
    for rank, (name, limits) in enumerate(criteria.items()):
        place.plot(*ellipse_line(*limits), label=name, **{**line(rank), "linewidth": 2.0})
    a, b = (float(np.quantile(values, _WIDEST)) for values in (sample.a, sample.b))
    place.set_xlim(1.0 - np.sqrt(a), 1.0 + np.sqrt(a))
    place.set_ylim(0.0, 1.05 * np.sqrt(b))
    name_axes(place, AMPLITUDE, DELAY)
    legend_below(figure, place)
    return figure


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterSeries:
    """Ellipse parameters of one source over one property of the structure."""

    name: str  # Source
    x: NDArray[np.float64]  # Natural frequencies [Hz] or damping ratios [-], shape (n,)
    a: NDArray[np.float64]  # a, b: Parameters [-] and [ms²], shape (n,)
    b: NDArray[np.float64]
    law: bool = False  # Whether it is a law, drawn as a line, rather than values, drawn as points


@apply_style
def parameters_over_frequency(series: Sequence[ParameterSeries]) -> Figure:
    """Draw a and b over the natural frequency, b on a logarithmic scale."""
    return _draw_series(series, FREQUENCY, logarithmic=False)


@apply_style
def parameters_over_damping_ratio(series: Sequence[ParameterSeries]) -> Figure:
    """Draw a and b over the damping ratio on logarithmic scales, on which a power law is straight."""
    return _draw_series(series, DAMPING_RATIO, logarithmic=True)


def _draw_series(series: Sequence[ParameterSeries], name: str, *, logarithmic: bool) -> Figure:
    figure, axes = panels(1, 2, height=_SERIES_HEIGHT)
    letters(axes, ("$a$", "$b$"))
    for rank, member in enumerate(series):
        look = line(rank, marker=not member.law)
        if not member.law:
            look |= {"linestyle": "none", "fillstyle": "none"}
        for place, values in zip(axes[0], (member.a, member.b), strict=True):
            place.plot(member.x, values, label=plain(member.name), **look)
    for place, parameter in zip(axes[0], (A_PARAMETER, B_PARAMETER), strict=True):
        name_axes(place, name, parameter)
        place.set_yscale("log")
        if logarithmic:
            place.set_xscale("log")
            label_logarithmic(place.xaxis)
        label_logarithmic(place.yaxis)
    legend_below(figure, axes[0, 0], columns=4)
    return figure
