"""Report of suites of ground motions: whether a synthetic one can replace real records."""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.stats import ks_2samp

from reliab.core.significant_digits import percent, percent_and_interval
from reliab.core.vocabulary import PERCENT
from reliab.report.document import Block, Column, Document, Figure as RpFigure, Section, Table, provenance_of
from reliab.report.numbers import Fixed, Shortest, Significant
from reliab.report.prose import Prose, join_words, prose
from reliab.report.sections import limits_section, method_section, rates_section
from reliab.report.style import (
    apply_style,
    label_logarithmic,
    legend_below,
    letters,
    line,
    name_axes,
    panels,
    plain,
)

_WORDS = {
    "peak_acceleration": ("Peak acceleration", "m/s²"),
    "arias_intensity": ("Arias intensity", "m/s"),
    "significant_duration": ("Duration, 5 to 95 % of the Arias intensity", "s"),
    "mean_period": ("Mean period", "s"),
    "a": ("Ellipse parameter a", "-"),
    "b": ("Ellipse parameter b", "ms²"),
}


def suites_report(
    *,
    title: str,
    measures: Mapping[str, pd.DataFrame],
    spectra: Mapping[str, xr.DataArray],
    limits: pd.DataFrame,
    coverage: pd.DataFrame | None = None,
    confidence: float,
    provenance: Mapping[str, object],
    purpose: str = "",
) -> Document:
    """Compare suites of ground motions, the first being the reference.

    `measures`: by the name of the suite, one row for each motion: `event`, `peak_acceleration` [m/s²],
    `arias_intensity` [m/s], `significant_duration` [s], `mean_period` [s], `a` [-] and `b` [ms²]; `spectra`:
    spectral accelerations [m/s²] over (motion, period) by the name of the suite; may be empty; `limits`:
    limits of the criterion of each suite: columns suite, f [Hz], xi, a [-], b [ms²]; `confidence`: confidence
    of the criteria [-].
    """
    names, containment = list(measures), _containment(coverage, confidence)
    blocks: list[Block] = [_measures(measures), _limits(limits, names, confidence)]
    if spectra:
        blocks.insert(1, _spectra(spectra))
    if coverage is not None and len(coverage):
        division = f"learned from {names[-1]}, judged on {names[0]}"
        blocks.append(rates_section(coverage, confidence=confidence, division=division))
    blocks += [limits_section(()), method_section(None, experimental_fraction=1.0, window="record")]
    return Document(
        kind="Comparison of suites",
        title=title,
        verdict=_verdict(limits, names, containment, confidence),
        tone="bad" if containment is not None and containment["high"] < confidence else "plain",
        facts={
            "Suites": join_words([f"{name} ({len(table)} motions)" for name, table in measures.items()]),
            "Confidence": percent(confidence),
            "Purpose": purpose,
        },
        blocks=tuple(blocks),
        provenance=provenance_of(provenance),
    )


def _verdict(
    limits: pd.DataFrame, names: Sequence[str], containment: pd.Series | None, confidence: float
) -> Prose:
    reference, compared = names[0], names[-1]
    ratios = _ratios(limits, reference, compared)
    ending = ""
    if containment is not None:
        rate, ends = percent_and_interval(*(containment[key] for key in ("rate", "low", "high")))
        ending = f"; {rate} of the motions of “{reference}” contain it (95 % interval {ends})"
    return prose(
        "For a stated {share} of motions, the criterion from “{compared}” allows {a_low:.2f} to {a_high:.2f} "
        "times the amplitude error and {b_low:.2f} to {b_high:.2f} times the delay that the criterion from "
        "“{reference}” allows{ending}.",
        share=percent(confidence),
        compared=compared,
        reference=reference,
        a_low=ratios["a"].min(),
        a_high=ratios["a"].max(),
        b_low=ratios["b"].min(),
        b_high=ratios["b"].max(),
        ending=ending,
    )


def _containment(coverage: pd.DataFrame | None, confidence: float) -> pd.Series | None:
    """Take what the first criterion contains of the reference over all structures, where that is known."""
    if coverage is None:
        return None
    overall = coverage[
        (coverage["measure"] == "containment")
        & coverage["f"].isna()
        & np.isclose(coverage["confidence"], confidence)
    ]
    return None if overall.empty else overall.iloc[0]


def _ratios(limits: pd.DataFrame, reference: str, compared: str) -> pd.DataFrame:
    """Ratios of the amplitude error and delay that two criteria allow, over structures."""
    by_suite = limits.set_index(["suite", "f", "xi"])[["a", "b"]]
    ratios: pd.DataFrame = (
        by_suite.loc[[compared]].droplevel(0) / by_suite.loc[[reference]].droplevel(0)
    ).apply(np.sqrt)
    return ratios


def _measures(measures: Mapping[str, pd.DataFrame]) -> Section:
    reference, *others = measures
    rows = [
        _row(column, measures[reference], measures[compared], compared)
        for compared in others
        for column in MEASURES
        if column in measures[reference] and column in measures[compared]
    ]
    return Section(
        title="Measures of the motions",
        blocks=(
            prose(
                "@fig:measures shows the suites motion by motion, @tab:measures their medians and "
                "spreads (standard deviation of the logarithm). The distance is the largest difference "
                "between two distributions (Kolmogorov–Smirnov); motions of one earthquake are alike, so"
                " that no p-value is given."
            ),
            RpFigure(
                drawing=suite_measures(measures),
                caption="Shares of the motions below each value. Where the lines differ, the suites differ.",
                label="fig:measures",
                leads=True,
            ),
            Table(
                frame=pd.DataFrame(rows),
                columns=_columns(reference),
                caption=prose(
                    "Measures of each suite compared with those of {reference}.", reference=reference
                ),
                label="tab:measures",
            ),
        ),
    )


def _columns(reference: str) -> tuple[Column, ...]:
    return (
        Column(key="measure", heading="Measure"),
        Column(key="suite", heading="Suite"),
        Column(key="unit", heading="Unit"),
        Column(key="reference_median", heading=reference, number=Significant(), group="median"),
        Column(key="median", heading="suite", number=Significant(), group="median"),
        Column(key="reference_spread", heading=reference, number=Fixed(), group="spread"),
        Column(key="spread", heading="suite", number=Fixed(), group="spread"),
        Column(key="distance", heading="Distance", number=Fixed()),
    )


def _row(column: str, reference: pd.DataFrame, compared: pd.DataFrame, name: str) -> dict[str, object]:
    of_reference, of_other = (table[column].dropna().to_numpy() for table in (reference, compared))
    factor, unit = (1e4, "10⁻⁴") if column == "a" else (1.0, _WORDS[column][1])
    return {
        "measure": _WORDS[column][0],
        "suite": name,
        "unit": unit,
        "reference_median": factor * float(np.median(of_reference)),
        "median": factor * float(np.median(of_other)),
        "reference_spread": float(np.log(of_reference).std()),
        "spread": float(np.log(of_other).std()),
        "distance": float(ks_2samp(of_reference, of_other).statistic),
    }


def _spectra(spectra: Mapping[str, xr.DataArray]) -> Section:
    figure = RpFigure(
        drawing=suite_spectra(spectra),
        caption="Median response spectra with the middle two thirds of the motions.",
        label="fig:spectra",
    )
    return Section(title="Response spectra", blocks=(figure,))


def _limits(limits: pd.DataFrame, names: Sequence[str], confidence: float) -> Section:
    wide = limits.assign(amplitude=np.sqrt(limits["a"]), delay=np.sqrt(limits["b"])).pivot_table(
        index=["f", "xi"], columns="suite", values=["amplitude", "delay"]
    )
    wide.columns = pd.Index([" ".join(name) for name in wide.columns.to_flat_index()])
    columns = [
        Column(key=f"{value} {name}", heading=name, unit=unit, number=Fixed(factor=factor), group=group)
        for value, unit, factor, group in (
            ("amplitude", "%", PERCENT, "amplitude error"),
            ("delay", "ms", 1.0, "delay"),
        )
        for name in names
    ]
    return Section(
        title="Criteria of the suites",
        blocks=(
            Table(
                frame=wide.reset_index(),
                columns=(
                    Column(key="f", heading=prose("$f$"), unit="Hz", number=Shortest()),
                    Column(key="xi", heading=prose("$xi$"), unit="-", number=Shortest()),
                    *columns,
                ),
                caption=prose(
                    "Greatest amplitude error and greatest delay, each without the other, for {share} of "
                    "the motions of each suite.",
                    share=percent(confidence),
                ),
                label="tab:limits",
            ),
        ),
    )


MEASURES: Final = {
    "peak_acceleration": "Peak acceleration [m/s²]",
    "arias_intensity": "Arias intensity [m/s]",
    "significant_duration": "Duration $D_{5-95}$ [s]",
    "mean_period": "Mean period $T_m$ [s]",
    "a": "Ellipse parameter $a$ [-]",
    "b": "Ellipse parameter $b$ [ms²]",
}
"""Columns that are compared, and the names of their axes."""

_HEIGHT = 122.0
_SPECTRUM_HEIGHT = 84.0
_COLUMNS = 3
_QUANTILES = (0.16, 0.5, 0.84)


@apply_style
def suite_measures(suites: Mapping[str, pd.DataFrame]) -> Figure:
    """Draw the distribution of each measure over the motions of each suite.

    `suites`: by the name of the suite, one row for each motion with columns of `MEASURES`; those that all
    suites have are drawn.
    """
    measures = {
        name: axis for name, axis in MEASURES.items() if all(name in table for table in suites.values())
    }
    rows = -(-len(measures) // _COLUMNS)
    figure, axes = panels(rows, _COLUMNS, height=_HEIGHT * rows / 2.0, share_y=True)
    letters(axes)
    for place in axes.ravel()[len(measures) :]:
        place.set_axis_off()
    for number, (place, (column, name)) in enumerate(zip(axes.ravel(), measures.items(), strict=False)):
        for rank, (suite, table) in enumerate(suites.items()):
            look = line(rank)
            place.ecdf(table[column].dropna().to_numpy(), label=plain(suite), **look)
        place.set_xscale("log")
        label_logarithmic(place.xaxis, largest_count=4)
        name_axes(place, name, "Share below [-]" if number % _COLUMNS == 0 else "")
    legend_below(figure, axes[0, 0])
    return figure


@apply_style
def suite_spectra(suites: Mapping[str, xr.DataArray]) -> Figure:
    """Draw the median response spectrum of each suite with the middle two thirds of the motions.

    `suites`: spectral accelerations [m/s²] over (motion, period [s]) by the name of the suite. Result:
    spectral acceleration [m/s²] over period [s]: medians, and 16 to 84 % as bands and thin lines.
    """
    figure, axes = panels(height=_SPECTRUM_HEIGHT)
    place = axes[0, 0]
    place.set(xscale="log", yscale="log")
    for rank, (name, spectra) in enumerate(suites.items()):
        _band(place, spectra, plain(name), rank)
    periods = np.concatenate([spectra["period"].values for spectra in suites.values()])
    place.set_xlim(periods.min(), periods.max())
    label_logarithmic(place.xaxis, place.yaxis, largest_count=7)
    name_axes(place, "Period [s]", "Spectral acceleration [m/s²]")
    legend_below(figure, place, columns=3)
    return figure


def _band(axes: Axes, spectra: xr.DataArray, name: str, rank: int) -> None:
    low, median, high = np.quantile(spectra.transpose("motion", "period").values, _QUANTILES, axis=0)
    periods, look = spectra["period"].values, line(rank)
    axes.fill_between(periods, low, high, color=look["color"], alpha=0.13, linewidth=0.0)
    for edge in (low, high):
        axes.plot(periods, edge, **{**look, "linewidth": 0.6})
    axes.plot(periods, median, label=f"{name}: median, 16 to 84 %", **{**look, "linewidth": 1.8})
