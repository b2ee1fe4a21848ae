"""Error of the whole test over amplitude and delay, as surface and as plan (Figure 8)."""

from collections.abc import Mapping
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

from reliab.report import AMPLITUDE, ERRORS, INK, SEQUENTIAL, blank, name_axes, styled
from reliab.vocabulary import MILLI, PERCENT, Metric

_HEIGHT = 124.0
_LEVELS = 8
_VIEW = {"elev": 27.0, "azim": -58.0}


@styled
def error_maps(
    amplitudes: NDArray[np.float64],
    delays: NDArray[np.float64],
    errors: Mapping[Metric, NDArray[np.float64]],
    *,
    threshold: float,
) -> Figure:
    """Draw errors over the plane of amplitude and delay, above as surfaces, below as plans.

    `amplitudes`: amplitudes A [-], shape (kp,); `delays`: delays d [s], shape (tau,); `errors`: MTE^R and
    RMS^R [-], shape (kp, tau); `threshold`: error whose contour is drawn thick [-].
    """
    figure = blank(height=_HEIGHT)
    figure.set_layout_engine("constrained", w_pad=0.12, h_pad=0.06)
    milliseconds = MILLI * delays
    for rank, (metric, values) in enumerate(errors.items()):
        percent = PERCENT * values.T
        surface = figure.add_subplot(2, len(errors), 1 + rank, projection="3d")
        surface.set_title(f"({'abcd'[rank]}) {ERRORS[metric]}, surface", loc="left")
        _draw_surface(cast("Axes3D", surface), amplitudes, milliseconds, percent)
        plan = figure.add_subplot(2, len(errors), 1 + len(errors) + rank)
        plan.set_title(f"({'abcd'[len(errors) + rank]}) {ERRORS[metric]} [%], plan", loc="left")
        _draw_plan(plan, amplitudes, milliseconds, percent, PERCENT * threshold)
    return figure


def _draw_surface(
    axes: Axes3D, amplitudes: NDArray[np.float64], delays: NDArray[np.float64], percent: NDArray[np.float64]
) -> None:
    grid = np.meshgrid(amplitudes, delays)
    axes.plot_surface(
        *grid, percent, cmap=SEQUENTIAL, rstride=1, cstride=1, linewidth=0.15, edgecolor=INK, antialiased=True
    )
    axes.view_init(**_VIEW)
    axes.set_box_aspect((1.25, 1.0, 0.75), zoom=0.92)
    axes.tick_params(pad=-2.0, labelsize=7.0)
    axes.set_xlabel(AMPLITUDE, labelpad=-2.0)
    axes.set_ylabel("Delay $d$ [ms]", labelpad=-4.0)
    axes.set_zlabel("Error [%]", labelpad=-6.0)
    axes.xaxis.set_major_locator(_few_ticks())
    axes.yaxis.set_major_locator(_few_ticks())
    axes.zaxis.set_major_locator(_few_ticks())


def _few_ticks() -> MaxNLocator:
    return MaxNLocator(4)


def _draw_plan(
    axes: Axes,
    amplitudes: NDArray[np.float64],
    delays: NDArray[np.float64],
    percent: NDArray[np.float64],
    threshold: float,
) -> None:
    levels = [level for level in MaxNLocator(_LEVELS).tick_values(0.0, float(percent.max())) if level > 0.0]
    axes.contourf(amplitudes, delays, percent, levels=[0.0, *levels], cmap=SEQUENTIAL, alpha=0.55)
    others = [level for level in levels if not np.isclose(level, threshold)]
    thin = axes.contour(amplitudes, delays, percent, levels=others, colors=INK, linewidths=0.5)
    axes.clabel(thin, fontsize=7.0, fmt="%g")
    thick = axes.contour(amplitudes, delays, percent, levels=[threshold], colors=INK, linewidths=1.8)
    axes.clabel(thick, fontsize=8.0, fmt="%g")
    name_axes(axes, AMPLITUDE, "Delay $d$ [ms]")
    axes.grid(visible=False)
