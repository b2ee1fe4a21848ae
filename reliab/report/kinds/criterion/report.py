"""Report of a criterion: verdict, result, motions and method; or, of too few motions, what they do show."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from numpy.typing import NDArray

from reliab.core.significant_digits import percent, percent_and_interval, share_in_words
from reliab.core.vocabulary import PERCENT, Metric
from reliab.criterion.criterion import Criterion
from reliab.criterion.distributions import Lognormal, LogSkewNormal
from reliab.criterion.motion_predictive import event_components
from reliab.criterion.population import EllipseSample
from reliab.report.document import Block, Column, Document, Figure, Points, Section, Table, provenance_of
from reliab.report.figures.parameter_distributions import (
    parameter_correlation,
    parameter_distributions,
    posterior_and_predictive,
    quantile_quantile,
)
from reliab.report.kinds.criterion.result import ReportedCriteria, result_section
from reliab.report.numbers import Fixed, Number, Scientific, Significant
from reliab.report.prose import (
    ERRORS,
    MEANINGS_OF_ERRORS,
    Piece,
    Prose,
    ellipse,
    error_below,
    meaning_of_confidence,
    prose,
    values,
    window_in_words,
)
from reliab.report.sections import limits_section, method_section, rates_section
from reliab.report.style import (
    A_PARAMETER,
    B_PARAMETER,
    BLUE,
    GREY,
    INK,
    VERMILION,
    apply_style,
    label_logarithmic,
    legend_below,
    letters,
    panels,
    plain,
)
from reliab.sweep.labels import share_of

_MOST_EVENTS = 40

_LONG_TABLE = 160


def motions_section(result: ReportedCriteria) -> Section:
    """Show the motions behind the criterion and the uncertainty that remains."""
    sample, (f, xi) = result.sample, result.structure
    opening = prose(
        "{n} motions of {events} earthquakes have an ellipse at {f:g} Hz and $xi = {xi:g}$; their "
        "parameters are listed in @tab:motions.",
        n=sample.n_motions,
        events=sample.n_events,
        f=f,
        xi=xi,
    )
    figures = (_correlation(result), *_distributions(result), _predictive(result), *_forest(result))
    return Section(title="The motions behind it", blocks=(opening, *figures), label="sec:motions")


def _correlation(result: ReportedCriteria) -> Figure:
    return Figure(
        drawing=parameter_correlation(result.sample),
        caption=prose(
            "Every motion has its own ellipse. $a$ and $b$ rise together: a motion that tolerates "
            "amplitude errors also tolerates delays, since near resonance both are one complex error. "
            "Band: 95 % of the lines of resampled earthquakes."
        ),
        label="fig:correlation",
    )


def _distributions(result: ReportedCriteria) -> tuple[Figure, Figure]:
    sample = result.sample
    fitted_distributions = {
        "lognormal": (Lognormal.fit(sample.a), Lognormal.fit(sample.b)),
        "log-skew-normal": (LogSkewNormal.fit(sample.a), LogSkewNormal.fit(sample.b)),
    }
    confidence = result.criterion.confidence
    return (
        Figure(
            drawing=parameter_distributions(
                sample, fitted_distributions, limits=result.limits, confidence=confidence
            ),
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


def _predictive(result: ReportedCriteria) -> Figure:
    confidence = result.criterion.confidence
    return Figure(
        drawing=posterior_and_predictive(result.sample, limits=result.limits, confidence=confidence),
        caption=prose(
            "Uncertainty that remains with these motions. Above: how well the quantile is known, if "
            "motions were independent and lognormal (bar: 95 %). Below: the chance that a further motion "
            "lies below a value; the criterion stands where the predictive curve meets {share}, or lower "
            "where $a$ and $b$ must hold together.",
            share=percent(1.0 - confidence, 2),
        ),
        label="fig:predictive",
    )


def _forest(result: ReportedCriteria) -> tuple[Figure, ...]:
    """Draw the motions by earthquake, where some earthquakes have several and there are not too many."""
    sample = result.sample
    if not 1 < sample.n_events < min(sample.n_motions, _MOST_EVENTS):
        return ()
    figure = Figure(
        drawing=event_forest(sample, limits=result.limits),
        caption=prose(
            "Motions of one earthquake are alike @searle1992; this many motions are therefore worth "
            "fewer independent ones, and whole earthquakes are held out when the criterion is put to"
            " the test."
        ),
        label="fig:forest",
    )
    return (figure,)


def appendix_section(result: ReportedCriteria) -> Section:
    """List the ellipses of the motions."""
    sample, (f, xi) = result.sample, result.structure
    frame = pd.DataFrame({"motion": sample.motions, "event": sample.events, "a": sample.a, "b": sample.b})
    for name in ("duration", "pga"):
        if name in result.ellipses.coords:
            frame[name] = result.ellipses[name].sel(motion=sample.motions).values
    listed_motions = frame.sort_values("a").head(_LONG_TABLE) if len(frame) > _LONG_TABLE else frame
    optional = {
        "duration": Column(key="duration", heading="Duration", unit="s", number=Fixed(decimals=1)),
        "pga": Column(key="pga", heading="Peak", unit="m/s²", number=Fixed()),
    }
    curve_phrase = (
        ""
        if len(listed_motions) == len(frame)
        else f" The {_LONG_TABLE} least tolerant of {len(frame)} motions."
    )
    caption: tuple[Piece, ...] = (
        *prose("Ellipses of the motions at {f:g} Hz and $xi = {xi:g}$ for ", f=f, xi=xi),
        ERRORS[Metric(sample.metric)],
        f" of {percent(sample.threshold)}.{curve_phrase}",
    )
    table = Table(
        frame=listed_motions,
        columns=(
            Column(key="motion", heading="Motion"),
            *([] if _has_event_names(listed_motions) else [Column(key="event", heading="Earthquake")]),
            *(column for name, column in optional.items() if name in listed_motions),
            Column(key="a", heading=prose("$a$"), unit="-", number=Scientific()),
            Column(key="b", heading=prose("$b$"), unit="ms²", number=Significant()),
        ),
        caption=caption,
        label="tab:motions",
    )
    return Section(title="Ellipses of the motions", blocks=(table,), appendix=True)


def _has_event_names(motions: pd.DataFrame) -> bool:
    """Tell whether every name begins with its earthquake, "KOBE/KJM000", which then needs no column."""
    return all(
        str(name).startswith(f"{event}/")
        for name, event in zip(motions["motion"], motions["event"], strict=True)
    )


_MARGIN, _ROW = 28.0, 3.7
_TALLEST = 205.0
_NORMAL_95 = 1.96
_LONGEST = 24  # characters of the name of an earthquake


@apply_style
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
    for k, (place, parameter) in enumerate(zip(axes[0], (sample.a, sample.b), strict=True)):
        _draw(place, parameter, sample.events, order, float(spreads[k]), limits[k])
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


_NEXT = (
    "judge a test with reliab assess TEST.csv --criterion FILE.json: it takes the index of the test from its "
    "command and measured displacement, and also states the error of the test itself"
)


def criterion_report(
    *,
    title: str,
    ellipses: xr.Dataset,
    criteria: Sequence[Criterion],
    coverage: pd.DataFrame | None = None,
    population: str = "ground motions",
    real_motions: Mapping[str, float] | None = None,
    provenance: Mapping[str, object],
    notes: Sequence[Prose] = (),
    purpose: str = "",
) -> Document:
    """Report criteria and the motions behind them.

    `real_motions` [-].
    """
    result = ReportedCriteria(ellipses=ellipses, criteria=tuple(criteria))
    criterion = result.criterion
    fraction = share_of(ellipses)
    blocks: list[Block] = [result_section(result, population), motions_section(result)]
    if coverage is not None and len(coverage):
        blocks.append(rates_section(coverage, confidence=criterion.confidence))
    blocks += [
        limits_section((*criterion.provenance.warnings, *notes)),
        method_section(criterion, experimental_fraction=fraction, window=criterion.provenance.window),
        appendix_section(result),
    ]
    return Document(
        kind="Reliability criterion",
        title=title,
        verdict=_verdict(result, population),
        facts={
            **_facts(result, coverage),
            **_real(real_motions),
            "Purpose": purpose,
            "To do next": _NEXT,
        },
        blocks=tuple(blocks),
        provenance=provenance_of(provenance, criterion.provenance),
    )


def _verdict(result: ReportedCriteria, population: str) -> Prose:
    criterion, (f, xi), (a, b) = result.criterion, result.structure, result.limits
    early = result.lead(criterion)
    return (
        *prose("At {f:g} Hz and $xi = {xi:g}$, a test keeps ", f=f, xi=xi),
        *error_below(criterion.metric, criterion.threshold),
        f" for {share_in_words(criterion.promise)} of {population} like those behind it while ",
        ellipse(a, b),
        *prose(
            " with $d$ in ms: at most {amplitude} of amplitude error alone, or {delay:.2f} ms of delay alone"
            "{lead}.",
            amplitude=percent(np.sqrt(a), 2),
            delay=np.sqrt(b),
            lead=f", or a lead of {early:.2f} ms alone" if np.isfinite(early) else "",
        ),
    )


def _real(share: Mapping[str, float] | None) -> dict[str, Prose]:
    """Say how many real motions contain a criterion that was derived from others."""
    if share is None:
        return {}
    rate, ends = percent_and_interval(share["rate"], share["low"], share["high"])
    sentence = (
        f"{rate} of {share['n_motions']:g} real motions of "
        f"{share['n_events']:g} other earthquakes contain this criterion by their simulated errors "
        f"(95 % interval {ends})"
    )
    return {"On real motions": sentence}


def _facts(result: ReportedCriteria, coverage: pd.DataFrame | None) -> dict[str, Prose]:
    criterion, source = result.criterion, result.criterion.provenance
    joint_phrase = "for both limits together" if criterion.joint else "for each limit separately"
    meaning = meaning_of_confidence(criterion.method)
    facts: dict[str, Prose] = {
        "Ground motions": source.population or f"{source.n_motions} of {source.n_events} earthquakes",
        "Structures": prose(
            "$f$ = {f}, $xi$ = {xi}, $alpha$ = {alpha:g} of the stiffness in the laboratory",
            f=values(result.frequencies.tolist(), "Hz"),
            xi=values(result.damping_ratios.tolist()),
            alpha=source.experimental_fraction,
        ),
        "Error": (
            *error_below(criterion.metric, criterion.threshold),
            f", {MEANINGS_OF_ERRORS[Metric(criterion.metric)]}, over {window_in_words(source.window)}",
        ),
        "Confidence": f"{share_in_words(criterion.promise)}, {joint_phrase}: {meaning}",
    }
    if coverage is not None and len(coverage):
        facts["Put to the test"] = _describe_coverage(coverage, criterion.confidence)
    return facts


def _describe_coverage(coverage: pd.DataFrame, confidence: float) -> Prose:
    overall = coverage[coverage["f"].isna() & np.isclose(coverage["confidence"], confidence)]
    if overall.empty:
        return prose("see @sec:coverage")
    row = overall.iloc[0]
    rate, ends = percent_and_interval(row["rate"], row["low"], row["high"])
    return f"{rate} of the motions of held-out earthquakes contain the criterion (95 % interval {ends})"


def no_criterion_report(
    *,
    title: str,
    ellipses: xr.Dataset,
    reasons: Sequence[str],
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Report the boundaries of the motions, and why no criterion follows from them."""
    events = len(set(ellipses["event"].values.tolist()))
    motions = ellipses.sizes["motion"]
    return Document(
        kind="Reliability criterion",
        title=title,
        verdict=f"{motions} ground motions of {events} earthquakes are too few for the criteria asked for.",
        tone="bad",
        facts={"Ground motions": f"{motions} of {events} earthquakes", "Purpose": purpose},
        blocks=(
            Section(title="What could not be done", blocks=(Points(items=tuple(reasons)),)),
            Section(title="What each motion tolerates", blocks=(_ellipses_table(ellipses),)),
        ),
        provenance=provenance_of(provenance),
    )


def _ellipses_table(ellipses: xr.Dataset) -> Table:
    first = {name: 0 for name in ellipses["a"].dims if name != "motion"}
    position = ellipses.isel(first)
    f, xi, threshold = (float(position[name]) for name in ("f", "xi", "threshold"))
    frame = position[["a", "b"]].reset_coords("event").to_dataframe().reset_index()
    positive = frame[["a", "b"]].where(frame[["a", "b"]] > 0.0)
    frame = frame.assign(amplitude=np.sqrt(positive["a"]), delay=np.sqrt(positive["b"]))
    columns: tuple[tuple[str, Prose, str, Number], ...] = (
        ("a", prose("$a$"), "-", Scientific()),
        ("b", prose("$b$"), "ms²", Significant()),
        ("amplitude", prose("$sqrt(a)$"), "%", Fixed(factor=PERCENT)),
        ("delay", prose("$sqrt(b)$"), "ms", Fixed()),
    )
    return Table(
        frame=frame,
        columns=(
            Column(key="motion", heading="Motion"),
            Column(key="event", heading="Earthquake"),
            *(
                Column(key=key, heading=heading, unit=unit, number=number)
                for key, heading, unit, number in columns
            ),
        ),
        caption=prose(
            "Ellipses fitted to the boundaries of the motions at {f:g} Hz, $xi = {xi:g}$ and an error of "
            "{threshold:g} %.",
            f=f,
            xi=xi,
            threshold=PERCENT * threshold,
        ),
        label="tab:motions",
    )
