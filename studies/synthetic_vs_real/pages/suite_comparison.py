"""Suites of ground motions side by side: measures of intensity, ellipse parameters, response spectra."""

from collections.abc import Mapping
from typing import Final

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.report import label_logarithmic, legend_below, letters, line, name_axes, panels, plain, styled

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


@styled
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
        label_logarithmic(place.xaxis, most=4)
        name_axes(place, name, "Share below [-]" if number % _COLUMNS == 0 else "")
    legend_below(figure, axes[0, 0])
    return figure


@styled
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
    label_logarithmic(place.xaxis, place.yaxis, most=7)
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
