"""Whether a posterior can be relied on: traces, ranks and pairs."""

from collections.abc import Sequence
from textwrap import fill

import numpy as np
import scipy
import seaborn as sns
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report.axes import name_axes, plain
from reliab.report.style import BLUE, INK, blank, line, panels, styled
from reliab.sampling.posterior_sample import PosteriorSample, walkers_in_turn

_ROW = 26.0
_CELL = 30.0
_LABEL = 18
_RANK_BINS = 20
_DRAWS = 1000
"""Draws of an ensemble that are drawn; all of them would make large files and no other picture."""


@styled
def traces(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw the density and the course of the draws of each ensemble.

    Returns one row for each parameter; ensembles that have converged lie over one another and run level.
    """
    names = list(parameters or posterior.names)
    figure, axes = panels(len(names), 2, height=14.0 + _ROW * len(names), ratios=(1.0, 2.0))
    number, chains = _thinned(posterior)
    for (density, course), name in zip(axes, names, strict=True):
        for rank, values in enumerate(chains[..., posterior.names.index(name)]):
            colour = line(rank)["color"]
            _density(density, values, colour)
            course.plot(number, values, color=colour, linewidth=0.2, alpha=0.6)
        density.set_yticks([])
        density.set_title(plain(name))
        course.set_title(_convergence(posterior, name))
        name_axes(density, "Value [-]" if name == names[-1] else "", "Density [-]")
        name_axes(course, "Draw of the ensemble [-]" if name == names[-1] else "", "Value [-]")
    return figure


@styled
def ranks(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw how the draws of each ensemble rank among all draws.

    Returns one panel for each parameter; ensembles that have converged are uniform, near the level line.
    """
    names = list(parameters or posterior.names)
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    figure, axes = panels(rows, columns, height=14.0 + 34.0 * rows, share_y=True)
    places = axes.ravel()
    for place in places[len(names) :]:
        place.remove()
    for place, name in zip(places, names, strict=False):
        values = walkers_in_turn(posterior.draws)[..., posterior.names.index(name)]
        for rank, ratio in enumerate(_rank_histograms(values)):
            place.stairs(ratio, np.linspace(0.0, values.size, _RANK_BINS + 1), baseline=None, **line(rank))
        place.axhline(1.0, color=INK, linewidth=0.6)
        place.set_title(plain(name))
        name_axes(place, "Rank among all draws [-]", "Draws over expected [-]" if place in axes[:, 0] else "")
    return figure


@styled
def pairs(posterior: PosteriorSample, parameters: Sequence[str]) -> Figure:
    """Draw the joint distributions of a few parameters."""
    count = len(parameters)
    figure = blank(height=min(160.0, 10.0 + _CELL * count))
    axes = figure.subplots(count, count, squeeze=False)
    draws = _thinned(posterior)[1].reshape(-1, len(posterior.names))
    values = [draws[:, posterior.names.index(name)] for name in parameters]
    for (row, column), place in np.ndenumerate(axes):
        if column > row:
            place.remove()
            continue
        if row == column:
            _density(place, values[row], BLUE)
            place.set_yticks([])
        else:
            place.plot(values[column], values[row], ".", markersize=1.0, mew=0.0, alpha=0.6, color=BLUE)
        place.tick_params(labelbottom=row == count - 1, labelleft=column == 0)
        across = _label(parameters[column]) if row == count - 1 else ""
        up = _label(parameters[row]) if column == 0 and row > 0 else ""
        name_axes(place, across, up)
    return figure


def _density(place: Axes, values: NDArray[np.float64], colour: str) -> None:
    sns.kdeplot(x=values, ax=place, color=colour, linewidth=0.9, cut=0, warn_singular=False)


def _rank_histograms(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Draws of each ensemble among equal parts of all ranks, over what is expected where all are alike.

    Shape (ensembles, parts).
    """
    ranks = scipy.stats.rankdata(values, axis=None).reshape(values.shape)
    expected = values.shape[1] / _RANK_BINS
    ends = (0.5, values.size + 0.5)
    return np.array([np.histogram(chain, _RANK_BINS, range=ends)[0] / expected for chain in ranks])


def _thinned(posterior: PosteriorSample) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Take a thousand draws of each ensemble: their numbers, and shape (ensembles, draws, parameters)."""
    chains = walkers_in_turn(posterior.draws)
    number = np.unique(np.linspace(0, chains.shape[1] - 1, _DRAWS).astype(int))
    return number, chains[:, number]


def _label(name: str) -> str:
    return fill(f"{plain(name)} [-]", _LABEL)


def _convergence(posterior: PosteriorSample, name: str) -> str:
    diagnostics, k = posterior.diagnostics, posterior.names.index(name)
    size = min(diagnostics.bulk_size[k], diagnostics.tail_size[k])
    return rf"$\hat{{R}}$ = {diagnostics.r_hat[k]:.3f}, {size:.0f} effective draws"
