"""Whether a posterior can be relied on: traces, ranks and pairs of parameters, in the reports' style."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.criterion.bayes import PosteriorSample
from reliab.report.axes import name_axes, plain
from reliab.report.style import BLUE, GREY, INK, blank, line, panels, styled

_ROW = 26.0
_CELL = 30.0
_BINS = 20
_MOST_POINTS = 1500
_SHARES = (0.05, 0.5, 0.95)


@styled
def traces(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw the mean and the 5 % and 95 % quantiles over the walkers of each ensemble, draw by draw.

    Parameters
    ----------
    posterior : PosteriorSample
        The draws.
    parameters : sequence of str, optional
        Which parameters; all by default.

    Returns
    -------
    matplotlib.figure.Figure
        One row for each parameter; ensembles that have converged lie over one another and run level.
    """
    chosen = _places(posterior, parameters)
    figure, axes = panels(len(chosen), 1, height=14.0 + _ROW * len(chosen), share_x=True)
    steps = posterior.thin * np.arange(posterior.draws.shape[1])
    for place, (name, k) in zip(axes[:, 0], chosen, strict=True):
        for rank, ensemble in enumerate(posterior.draws[..., k]):
            low, middle, high = np.quantile(ensemble, _SHARES, axis=1)
            look = line(rank)
            place.plot(steps, middle, linewidth=0.9, label=f"ensemble {rank + 1}", color=look["color"])
            for edge in (low, high):
                place.plot(steps, edge, linewidth=0.5, color=look["color"], alpha=0.7)
        place.set_title(_title(posterior, name, k))
        place.set_ylabel("Value [-]")
    axes[-1, 0].set_xlabel("Step after the first half [-]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


@styled
def ranks(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw how the draws of each ensemble rank among all draws.

    Parameters
    ----------
    posterior : PosteriorSample
        The draws.
    parameters : sequence of str, optional
        Which parameters; all by default.

    Returns
    -------
    matplotlib.figure.Figure
        One panel for each parameter; ensembles that have converged are uniform, near the level line.
    """
    chosen = _places(posterior, parameters)
    columns = min(3, len(chosen))
    rows = -(-len(chosen) // columns)
    figure, axes = panels(rows, columns, height=14.0 + 34.0 * rows, share_x=True)
    for place, (name, k) in zip(axes.ravel(), chosen, strict=False):
        _draw_ranks(place, posterior.draws[..., k])
        place.set_title(plain(name))
    for place in axes.ravel()[len(chosen) :]:
        place.set_axis_off()
    for place in axes[:, 0]:
        place.set_ylabel("Density [-]")
    for place in axes[-1]:
        place.set_xlabel("Rank among all draws [-]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


@styled
def pairs(posterior: PosteriorSample, parameters: Sequence[str]) -> Figure:
    """Draw the joint distributions of a few parameters.

    Parameters
    ----------
    posterior : PosteriorSample
        The draws.
    parameters : sequence of str
        Two to five parameters.

    Returns
    -------
    matplotlib.figure.Figure
        Histograms on the diagonal, points below it.
    """
    chosen = _places(posterior, parameters)
    count, points = len(chosen), posterior.spread_out(_MOST_POINTS)
    figure = blank(height=min(160.0, 10.0 + _CELL * count))
    axes = figure.subplots(count, count, squeeze=False, sharex="col")
    for (row, column), place in np.ndenumerate(axes):
        if column > row:
            place.set_axis_off()
            continue
        x = points[:, chosen[column][1]]
        if column == row:
            place.hist(x, bins=_BINS, color=BLUE, edgecolor="white")
            place.set_yticks([])
        else:
            place.plot(x, points[:, chosen[row][1]], ".", color=BLUE, markersize=1.0, alpha=0.4)
        across = _in_two_lines(chosen[column][0]) if row == count - 1 else ""
        up = _in_two_lines(chosen[row][0]) if column == 0 and row > 0 else ""
        name_axes(place, across, up)
    return figure


def _in_two_lines(name: str) -> str:
    """Break a name after the effect that it belongs to."""
    return f"{plain(name)} [-]".replace(": ", ":\n", 1)


def _places(posterior: PosteriorSample, parameters: Sequence[str]) -> list[tuple[str, int]]:
    return [(name, posterior.names.index(name)) for name in parameters or posterior.names]


def _title(posterior: PosteriorSample, name: str, k: int) -> str:
    found = posterior.diagnostics
    size = min(found.bulk_size[k], found.tail_size[k])
    return rf"{plain(name)}: $\hat{{R}}$ = {found.r_hat[k]:.3f}, {size:.0f} effective draws"


def _draw_ranks(place: Axes, draws: NDArray[np.float64]) -> None:
    order = draws.ravel().argsort().argsort().reshape(draws.shape[0], -1) / draws.size
    for rank, ensemble in enumerate(order):
        density, edges = np.histogram(ensemble, bins=_BINS, range=(0.0, 1.0), density=True)
        place.stairs(density, edges, color=line(rank)["color"], label=f"ensemble {rank + 1}")
    place.axhline(1.0, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    place.set_ylim(0.0, 2.0)
    place.tick_params(colors=INK)
