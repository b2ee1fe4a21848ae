"""The virtual hybrid-simulation benchmark: errors of the tests by compensator and case."""

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.report import label_logarithmic, legend_below, line, name_axes, panels, plain, styled

_HEIGHT = 80.0
_WIDTH = 120.0
_SPREAD = 0.16


@styled
def benchmark_spread(tests: pd.DataFrame) -> Figure:
    """Draw J4 of every test over the case, one mark for each compensator.

    `tests`: columns `name`, `case` and `J4` [%], one row a test. Result: J4 [%] on a logarithmic scale.
    """
    figure, axes = panels(height=_HEIGHT, width=_WIDTH)
    place = axes[0, 0]
    groups = list(tests.groupby("name", sort=False))
    for rank, (name, errors) in enumerate(groups):
        shift = _SPREAD * (rank - 0.5 * (len(groups) - 1))
        look = {**line(rank, marker=True), "linestyle": "none", "fillstyle": "none"}
        place.plot(errors["case"] + shift, errors["J4"].astype(float), label=plain(str(name)), **look)
    cases = np.unique(tests["case"])
    values = tests["J4"].astype(float)
    place.set(xticks=cases, yscale="log", ylim=(0.8 * values.min(), 1.25 * values.max()))
    label_logarithmic(place.yaxis)
    name_axes(place, "Case of the benchmark [-]", "Error of the first floor, J4 [%]")
    legend_below(figure, place, columns=2)
    return figure
