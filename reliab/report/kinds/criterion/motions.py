"""The motions behind a criterion: figures, and their ellipses as a table."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from reliab.core.significant_digits import percent
from reliab.core.vocabulary import Metric
from reliab.criterion.distributions import Lognormal, LogSkewNormal
from reliab.criterion.ellipse_sample import EllipseSample
from reliab.criterion.event_components import event_components
from reliab.report.axes import A_PARAMETER, B_PARAMETER, label_logarithmic, legend_below, plain
from reliab.report.document import Column, Figure, Paragraph, Section, Table
from reliab.report.figures.parameter_distributions import (
    parameter_correlation,
    parameter_distributions,
    posterior_and_predictive,
    quantile_quantile,
)
from reliab.report.kinds.criterion.reported import ReportedCriteria
from reliab.report.numbers import Fixed, Scientific, Significant
from reliab.report.prose import Piece, prose
from reliab.report.style import BLUE, GREY, INK, VERMILION, letters, panels, styled
from reliab.report.wording import (
    ERRORS,
)

_MOST_EVENTS = 40

_LONG_TABLE = 160


def motions_section(reported: ReportedCriteria) -> Section:
    """Show the motions behind the criterion and the uncertainty that remains."""
    sample, (f, xi) = reported.sample, reported.structure
    opening = Paragraph(
        text=prose(
            "{n} motions of {events} earthquakes have an ellipse at {f:g} Hz and $xi = {xi:g}$; their "
            "parameters are listed in @tab:motions.",
            n=sample.n_motions,
            events=sample.n_events,
            f=f,
            xi=xi,
        )
    )
    figures = (_correlation(reported), *_distributions(reported), _predictive(reported), *_forest(reported))
    return Section(title="The motions behind it", blocks=(opening, *figures), label="sec:motions")


def _correlation(reported: ReportedCriteria) -> Figure:
    return Figure(
        drawing=parameter_correlation(reported.sample),
        caption=prose(
            "Every motion has its own ellipse. $a$ and $b$ rise together: a motion that tolerates "
            "amplitude errors also tolerates delays, since near resonance both are one complex error. "
            "Band: 95 % of the lines of resampled earthquakes."
        ),
        label="fig:correlation",
    )


def _distributions(reported: ReportedCriteria) -> tuple[Figure, Figure]:
    sample = reported.sample
    fitted = {
        "lognormal": (Lognormal.fit(sample.a), Lognormal.fit(sample.b)),
        "log-skew-normal": (LogSkewNormal.fit(sample.a), LogSkewNormal.fit(sample.b)),
    }
    confidence = reported.criterion.confidence
    return (
        Figure(
            drawing=parameter_distributions(sample, fitted, limits=reported.limits, confidence=confidence),
            caption=(
                "Distribution of the ellipse parameters over the motions; the criterion lies in the "
                "lower tail."
            ),
            label="fig:distributions",
        ),
        Figure(
            drawing=quantile_quantile(sample),
            caption=(
                "Where points leave the band, the lognormal distribution of the paper does not describe the "
                "motions."
            ),
            label="fig:quantiles",
        ),
    )


def _predictive(reported: ReportedCriteria) -> Figure:
    confidence = reported.criterion.confidence
    return Figure(
        drawing=posterior_and_predictive(reported.sample, limits=reported.limits, confidence=confidence),
        caption=prose(
            "Uncertainty that remains with these motions. Above: how well the quantile is known, if "
            "motions were independent and lognormal (bar: 95 %). Below: the chance that a further motion "
            "lies below a value; the criterion stands where the predictive curve meets {share}, or lower "
            "where $a$ and $b$ must hold together.",
            share=percent(1.0 - confidence, 2),
        ),
        label="fig:predictive",
    )


def _forest(reported: ReportedCriteria) -> tuple[Figure, ...]:
    """Draw the motions by earthquake, where some earthquakes have several and there are not too many."""
    sample = reported.sample
    if not 1 < sample.n_events < min(sample.n_motions, _MOST_EVENTS):
        return ()
    figure = Figure(
        drawing=event_forest(sample, limits=reported.limits),
        caption=prose(
            "Motions of one earthquake are alike @searle1992; this many motions are therefore worth "
            "fewer independent ones, and whole earthquakes are held out when the criterion is put to"
            " the test."
        ),
        label="fig:forest",
    )
    return (figure,)


def appendix_section(reported: ReportedCriteria) -> Section:
    """List the ellipses of the motions."""
    sample, (f, xi) = reported.sample, reported.structure
    frame = pd.DataFrame({"motion": sample.motions, "event": sample.events, "a": sample.a, "b": sample.b})
    for name in ("duration", "pga"):
        if name in reported.ellipses.coords:
            frame[name] = reported.ellipses[name].sel(motion=sample.motions).values
    listed_motions = frame.sort_values("a").head(_LONG_TABLE) if len(frame) > _LONG_TABLE else frame
    optional = {
        "duration": Column(key="duration", heading="Duration", unit="s", number=Fixed(decimals=1)),
        "pga": Column(key="pga", heading="Peak", unit="m/s²", number=Fixed()),
    }
    which = (
        ""
        if len(listed_motions) == len(frame)
        else f" The {_LONG_TABLE} least tolerant of {len(frame)} motions."
    )
    caption: tuple[Piece, ...] = (
        *prose("Ellipses of the motions at {f:g} Hz and $xi = {xi:g}$ for ", f=f, xi=xi),
        ERRORS[Metric(sample.metric)],
        f" of {percent(sample.threshold)}.{which}",
    )
    table = Table(
        frame=listed_motions,
        columns=(
            Column(key="motion", heading="Motion"),
            *([] if _named_after_events(listed_motions) else [Column(key="event", heading="Earthquake")]),
            *(column for name, column in optional.items() if name in listed_motions),
            Column(key="a", heading=prose("$a$"), unit="-", number=Scientific()),
            Column(key="b", heading=prose("$b$"), unit="ms²", number=Significant()),
        ),
        caption=caption,
        label="tab:motions",
    )
    return Section(title="Ellipses of the motions", blocks=(table,), appendix=True)


def _named_after_events(motions: pd.DataFrame) -> bool:
    """Tell whether every name begins with its earthquake, "KOBE/KJM000", which then needs no column."""
    return all(
        str(name).startswith(f"{event}/")
        for name, event in zip(motions["motion"], motions["event"], strict=True)
    )


_MARGIN, _ROW = 28.0, 3.7
_TALLEST = 205.0
_NORMAL_95 = 1.96
_LONGEST = 24  # characters of the name of an earthquake


@styled
def event_forest(sample: EllipseSample, *, limits: tuple[float, float]) -> Drawing:
    """Draw every motion in the row of its earthquake, with the mean of the earthquake.

    The mean has a 95 % interval from the scatter of motions within earthquakes.
    """
    events = np.unique(sample.events)
    means = [sample.log_a[sample.events == event].mean() for event in events]
    order = events[np.argsort(means)[::-1]]
    figure, axes = panels(1, 2, height=min(_MARGIN + _ROW * order.size, _TALLEST), share_y=True)
    shares = event_components(np.stack([sample.log_a, sample.log_b], axis=1), sample.events)
    titles = tuple(
        f"{name}, {percent(share, decimals=0)} between earthquakes"
        for name, share in zip(("$a$", "$b$"), shares.event_share, strict=True)
    )
    letters(axes, titles)
    spreads = np.sqrt(shares.within)
    for k, (place, values) in enumerate(zip(axes[0], (sample.a, sample.b), strict=True)):
        _draw(place, values, sample.events, order, float(spreads[k]), limits[k])
    axes[0, 0].set_yticks(np.arange(order.size), [plain(str(event), longest=_LONGEST) for event in order])
    axes[0, 0].set_ylim(-0.7, order.size - 0.3)
    axes[0, 0].set_xlabel(A_PARAMETER)
    axes[0, 1].set_xlabel(B_PARAMETER)
    if order.size * _ROW + _MARGIN > _TALLEST:
        axes[0, 0].tick_params(axis="y", labelsize=5.0)
    legend_below(figure, axes[0, 0])
    return figure


def _draw(
    axes: Axes,
    values: NDArray[np.float64],
    events: NDArray[np.str_],
    order: NDArray[np.str_],
    spread: float,
    limit: float,
) -> None:
    rows = np.argmax(events[:, None] == order[None, :], axis=1)
    counts = np.bincount(rows)
    mean = np.bincount(rows, weights=np.log(values)) / counts
    reach = _NORMAL_95 * spread / np.sqrt(counts)
    axes.plot(values, rows, "o", color=GREY, markersize=3.0, fillstyle="none", label="motion")
    low, high = np.exp(mean - reach), np.exp(mean + reach)
    axes.hlines(
        np.arange(order.size), low, high, color=BLUE, linewidth=1.1, label="mean of the earthquake, 95 %"
    )
    axes.plot(np.exp(mean), np.arange(order.size), "s", color=BLUE, markersize=3.4)
    axes.axvline(
        float(np.exp(np.log(values).mean())),
        color=INK,
        linewidth=0.8,
        linestyle=(0, (1, 2)),
        label="all motions",
    )
    if limit > 0.0:
        axes.axvline(limit, color=VERMILION, linewidth=1.2, linestyle=(0, (5, 1.6)), label="criterion")
    axes.set_xscale("log")
    label_logarithmic(axes.xaxis)
