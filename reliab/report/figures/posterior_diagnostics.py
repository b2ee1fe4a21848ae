"""Whether a posterior can be relied on: traces, ranks and pairs by ArviZ, in the style of the reports."""

import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import numpy as np
from matplotlib import MatplotlibDeprecationWarning
from matplotlib.figure import Figure

from reliab.report.axes import name_axes, plain
from reliab.report.style import BLUE, blank, line, panels, styled
from reliab.sampling import PosteriorSample
from reliab.sampling.diagnostics import inference_data, quiet_arviz

_ROW = 26.0
_CELL = 30.0
_KEPT = 1000
"""Draws of an ensemble that are drawn; all of them would make large files and no other picture."""


@styled
def traces(posterior: PosteriorSample, parameters: Sequence[str] = ()) -> Figure:
    """Draw the density and the course of the draws of each ensemble.

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
    chosen = list(parameters or posterior.names)
    figure, axes = panels(len(chosen), 2, height=14.0 + _ROW * len(chosen), ratios=(1.0, 2.0))
    with _arviz() as arviz:
        arviz.plot_trace(
            _thinned(posterior),
            var_names=chosen,
            axes=axes,
            compact=False,
            chain_prop={"color": [line(rank)["color"] for rank in range(len(posterior.draws))]},
            plot_kwargs={"linewidth": 0.9},
            trace_kwargs={"linewidth": 0.2, "alpha": 0.6},
        )
    for (density, course), name in zip(axes, chosen, strict=True):
        density.set_title(plain(name))
        course.set_title(_convergence(posterior, name))
        name_axes(density, "Value [-]" if name == chosen[-1] else "", "Density [-]")
        name_axes(course, "Draw of the ensemble [-]" if name == chosen[-1] else "", "Value [-]")
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
    chosen = list(parameters or posterior.names)
    columns = min(3, len(chosen))
    rows = -(-len(chosen) // columns)
    figure, axes = panels(rows, columns, height=14.0 + 34.0 * rows)
    places = axes.ravel()
    for place in places[len(chosen) :]:
        place.remove()
    with _arviz() as arviz:
        arviz.plot_rank(
            inference_data(posterior.draws, posterior.names),
            var_names=chosen,
            kind="vlines",
            colors=[line(rank)["color"] for rank in range(len(posterior.draws))],
            ax=places[: len(chosen)],
            vlines_kwargs={"linewidth": 1.0},
            marker_vlines_kwargs={"markersize": 2.0},
        )
    for place, name in zip(places, chosen, strict=False):
        place.set_title(plain(name))
        name_axes(place, "Rank among all draws [-]", "Density [-]")
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
        Densities on the diagonal, points below it.
    """
    count = len(parameters)
    figure = blank(height=min(160.0, 10.0 + _CELL * count))
    axes = figure.subplots(count, count, squeeze=False)
    with _arviz() as arviz:
        arviz.plot_pair(
            _thinned(posterior),
            var_names=list(parameters),
            kind="scatter",
            marginals=True,
            ax=axes,
            scatter_kwargs={"s": 1.0, "alpha": 0.4, "marker": ".", "color": BLUE},
            marginal_kwargs={"plot_kwargs": {"linewidth": 1.0, "color": BLUE}},
        )
    for (row, column), place in np.ndenumerate(axes):
        across = _in_two_lines(parameters[column]) if row == count - 1 else ""
        up = _in_two_lines(parameters[row]) if column == 0 and row > 0 else ""
        name_axes(place, across, up)
        if row == column:
            place.set_yticks([])
    return figure


def _thinned(posterior: PosteriorSample) -> Any:  # noqa: ANN401 - ArviZ is untyped
    """Draws as ArviZ's object, a thousand of each ensemble."""
    steps, walkers = posterior.draws.shape[1:3]
    return inference_data(posterior.draws, posterior.names).sel(
        draw=np.unique(np.linspace(0, steps * walkers - 1, _KEPT).astype(int))
    )


@contextmanager
def _arviz() -> Iterator[ModuleType]:
    """ArviZ without matplotlib's complaints of what it calls, which are not the user's concern."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MatplotlibDeprecationWarning)
        yield quiet_arviz()


def _in_two_lines(name: str) -> str:
    """Break a name after the effect that it belongs to."""
    return f"{plain(name)} [-]".replace(": ", ":\n", 1)


def _convergence(posterior: PosteriorSample, name: str) -> str:
    diagnostics, k = posterior.diagnostics, posterior.names.index(name)
    size = min(diagnostics.bulk_size[k], diagnostics.tail_size[k])
    return rf"$\hat{{R}}$ = {diagnostics.r_hat[k]:.3f}, {size:.0f} effective draws"
