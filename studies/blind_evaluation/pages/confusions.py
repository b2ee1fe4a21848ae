"""How often a diagnosis is right: stated probabilities against frequencies, and effects confused."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from reliab.report import BLUE, GREY, INK, blank, name_axes, panels, plain, styled

_HEIGHT = 76.0
_ROW, _EDGE = 4.6, 42.0
_DARK = 0.55


@styled
def discrepancy_reliability(bins: pd.DataFrame) -> Figure:
    """Draw how often effects that were named with a stated probability were right.

    `bins`: columns `mean_stated`, `share`, `low`, `high` (95 % interval of the share) [-] and `of`, the
    count. Result: share that was right over the stated probability; on the diagonal statements are
    calibrated.
    """
    figure, axes = panels(height=_HEIGHT, width=_HEIGHT + 14.0)
    place = axes[0, 0]
    place.plot([0.0, 1.0], [0.0, 1.0], color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    reach = np.maximum([bins["share"] - bins["low"], bins["high"] - bins["share"]], 0.0)
    place.errorbar(bins["mean_stated"], bins["share"], yerr=reach, fmt="o", color=BLUE, capsize=2.5)
    for row in bins.itertuples():
        place.annotate(
            f"{row.of}", (row.mean_stated, row.share), (4, -9), textcoords="offset points", fontsize=7.0
        )
    place.set(xlim=(-0.02, 1.04), ylim=(-0.02, 1.04), aspect="equal")
    name_axes(place, "Stated probability [-]", "Share that is right [-]")
    return figure


@styled
def discrepancy_confusion(counts: Mapping[str, Mapping[str, int]]) -> Figure:
    """Draw which effects were given which names.

    Truths in rows, answers in columns; shading by the share of the row.
    """
    table = pd.DataFrame(counts).T.fillna(0).astype(int)
    table = table[sorted(table.columns, key=lambda name: _place(str(name), list(counts)))]
    figure = blank(height=_ROW * len(table) + _EDGE)
    axes = figure.subplots()
    shares = table.to_numpy() / np.maximum(table.to_numpy().sum(axis=1, keepdims=True), 1)
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    axes.grid(visible=False)
    for (row, column), count in np.ndenumerate(table.to_numpy()):
        if count:
            colour = "white" if shares[row, column] > _DARK else INK
            axes.text(column, row, f"{count}", ha="center", va="center", color=colour, fontsize=6.5)
    axes.set_xticks(
        range(table.shape[1]), [_worded(name) for name in table.columns], rotation=90.0, fontsize=6.5
    )
    axes.set_yticks(range(table.shape[0]), [_worded(name) for name in table.index], fontsize=6.5)
    name_axes(axes, "Answer", "Truth")
    return figure


def _place(name: str, truths: list[str]) -> tuple[bool, int, str]:
    """Order of the answers: that of the truths, then other names, then verdicts."""
    return name.startswith("("), truths.index(name) if name in truths else len(truths), name


def _worded(name: object) -> str:
    return plain(str(name).replace("_", " "))
