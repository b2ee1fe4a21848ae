"""What tests with nonlinear specimens tolerate, over what linear ones tolerate."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from reliab.report import INK, label_logarithmic, legend_below, letters, line, name_axes, panels, styled

_HEIGHT = 122.0
_DIRECTIONS = {"late": "delay alone", "large": "gain above 1 alone", "small": "gain below 1 alone"}
_SPACING = 0.22  # of the distance between levels
_LEVELS = {
    "bilinear": "Linear peak over yield displacement $R$ [-]",
    "bouc_wen": "Linear peak over yield displacement $R$ [-]",
    "coulomb": "Friction over spring force [-]",
    "cubic": "Cubic over linear spring force [-]",
}
_TITLES = {
    "bilinear": "bilinear",
    "bouc_wen": "Bouc–Wen",
    "coulomb": "Coulomb friction",
    "cubic": "cubic spring",
}


@styled
def tolerance_over_level(levels: pd.DataFrame) -> Figure:
    """Draw quantiles of the tolerance over that of the linear test, one panel for each kind of specimen."""
    kinds = list(dict.fromkeys(levels["specimen"]))
    columns = min(2, len(kinds))
    rows = -(-len(kinds) // columns)
    figure, axes = panels(rows, columns, height=_HEIGHT * rows / 2.0 + 8.0, share_y=True)
    letters(axes, tuple(_TITLES.get(kind, kind) for kind in kinds))
    overall = levels[levels["f"].isna()]
    for rank, (kind, place) in enumerate(zip(kinds, axes.ravel(), strict=False)):
        _draw(place, overall[overall["specimen"] == kind])
        first = rank % columns == 0
        name_axes(place, _LEVELS.get(kind, "Level [-]"), "Tolerance over linear [-]" if first else "")
    for place in axes.ravel()[len(kinds) :]:
        place.set_axis_off()
    label_logarithmic(axes[0, 0].yaxis, most=7)
    legend_below(figure, axes[0, 0], columns=3)
    return figure


def _draw(place: Axes, levels: pd.DataFrame) -> None:
    """Draw one kind of specimen: its levels side by side, the directions around each."""
    present = sorted(set(levels["level"]))
    place.axhline(1.0, color=INK, linewidth=0.9)
    for rank, (direction, name) in enumerate(_DIRECTIONS.items()):
        quantiles = levels[levels["direction"] == direction].set_index("level").loc[present]
        at = np.arange(len(present)) + _SPACING * (rank - 1)
        look = line(rank, marker=True) | {"linestyle": "none"}
        place.vlines(at, quantiles["q05"], quantiles["q95"], color=look["color"], linewidth=0.8)
        place.vlines(at, quantiles["q25"], quantiles["q75"], color=look["color"], linewidth=2.6)
        place.plot(at, quantiles["q50"], label=name, markersize=4.6, **look)
    place.set(yscale="log", xticks=range(len(present)), xlim=(-0.5, len(present) - 0.5))
    place.set_xticklabels([f"{level:g}".replace("-", "−") for level in present])
