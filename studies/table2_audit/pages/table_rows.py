"""Rows of a published table against a simulation of them, before and after hidden differences are named."""

import pandas as pd
from matplotlib.figure import Figure

from reliab.report import (
    BLUE,
    GREY,
    INK,
    VERMILION,
    label_logarithmic,
    legend_below,
    letters,
    name_axes,
    panels,
    styled,
)


@styled
def table_rows(rows: pd.DataFrame) -> Figure:
    """Draw simulated over printed ellipse parameters, row by row.

    Panels before and after; b over a, each as a ratio.
    """
    figure, axes = panels(1, 2, height=78.0, share_x=True, share_y=True)
    letters(axes, ("as simulated", "with the differences that were named"))
    explained = ~rows["agrees"] & rows["difference"].isin(["time step", "duration", "component"])
    groups = (
        ("row that agrees", rows["agrees"], {"color": GREY, "marker": "o", "fillstyle": "none"}),
        ("difference named", explained, {"color": BLUE, "marker": "s"}),
        ("none found", ~rows["agrees"] & ~explained, {"color": VERMILION, "marker": "x"}),
    )
    for place, ending in zip(axes[0], ("", "_after"), strict=True):
        for label, selection, style in groups:
            points = rows[selection]
            ratios = [points[f"{name}{ending}"] / points[f"{name}_printed"] for name in ("a", "b")]
            place.plot(*ratios, linestyle="", markersize=3.6, label=label, **style)
        place.axhline(1.0, color=INK, linewidth=0.5)
        place.axvline(1.0, color=INK, linewidth=0.5)
        place.set_xscale("log")
        place.set_yscale("log")
        label_logarithmic(place.xaxis)
        label_logarithmic(place.yaxis)
        name_axes(place, "$a$, simulated over printed [-]", "")
    axes[0, 0].set_ylabel("$b$, simulated over printed [-]")
    legend_below(figure, axes[0, 0])
    return figure
