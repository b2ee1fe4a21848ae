"""Computed over true errors of tests, family by family."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.report import GREY, legend_below, line, name_axes, panels, plain, styled

_HEIGHT = 122.0
_LEAST, _MOST = 0.3, 3.0
_SPREAD = 0.7  # between marks of the tests of a family
_BESIDE = 0.13  # between marks of tests with less and with more noise


@styled
def ratios_by_family(tests: pd.DataFrame) -> Figure:
    """Draw the computed error over the true one with its interval, one mark a test.

    `tests`: columns `family`, `decibels`, `true`, `value`, `low` and `high`, one row a test. Result: ratios
    [-] on a logarithmic scale, the band of 10 % shaded; what lies outside is drawn at the edge.
    """
    figure, axes = panels(height=_HEIGHT)
    place = axes[0, 0]
    families = list(dict.fromkeys(tests["family"]))
    place.axvspan(0.9, 1.1, color=GREY, alpha=0.15, linewidth=0.0)
    for rank, (decibels, rows) in enumerate(tests.groupby(tests["decibels"].astype(int), sort=False)):
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none", "markersize": 3.0}
        of_family = rows.groupby("family")
        number = of_family.cumcount() / of_family["family"].transform("size")
        height = rows["family"].map(families.index) + _SPREAD * (number - 0.5) + _BESIDE * rank
        ratio, low, high = (
            np.clip(rows[name] / rows["true"], _LEAST, _MOST) for name in ("value", "low", "high")
        )
        place.hlines(height, low, high, color=look["color"], linewidth=0.6)
        place.plot(ratio, height, label=plain(f"noise of {decibels} dB"), **look)
    ticks = [0.3, 0.5, 0.75, 1.0, 1.25, 2.0, 3.0]
    place.set(xscale="log", xlim=(_LEAST, _MOST), ylim=(len(families) - 0.4, -0.6))
    place.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    place.minorticks_off()
    place.set_yticks(range(len(families)), [plain(name) for name in families])
    name_axes(place, "Computed over true error [-]", "")
    legend_below(figure, place, columns=2)
    return figure
