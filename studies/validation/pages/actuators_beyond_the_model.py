"""Tests with actuators beyond a constant gain and delay: the error against what A and d tell."""

import pandas as pd
from matplotlib.figure import Figure

from reliab.report import GREY, label_logarithmic, legend_below, line, name_axes, panels, plain, styled
from reliab.vocabulary import PERCENT

_HEIGHT = 76.0
_WIDTH = 120.0


@styled
def error_beyond_the_model(
    tests: pd.DataFrame, *, prediction: str = "Error of a constant gain $A$ and delay $d$"
) -> Figure:
    """Draw the error of each test over that of a constant gain and delay with the same indices.

    `tests`: columns rig, error [-] and predicted [-], one row a test. Result: both errors [%] on logarithmic
    scales; on the diagonal they agree.
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    percent = PERCENT * tests[["predicted", "error"]]
    ends = (0.8 * float(percent.min().min()), 1.25 * float(percent.max().max()))
    place.plot(ends, ends, color=GREY, linewidth=0.9)
    for rank, (name, errors) in enumerate(percent.groupby(tests["rig"], sort=False)):
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
        place.plot(errors["predicted"], errors["error"], label=plain(str(name)), **look)
    place.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
    label_logarithmic(place.xaxis, place.yaxis)
    name_axes(place, f"{prediction} [%]", "Error of the test [%]")
    legend_below(figure, place, columns=2)
    return figure
