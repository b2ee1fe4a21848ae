"""The error over amplitude and delay: curves (Figures 4, 6), maps (8), contours (9) and fits to one (10)."""

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.axes3d import Axes3D  # type: ignore[import-untyped]
from numpy.typing import NDArray

from reliab.core.significant_digits import significant
from reliab.core.vocabulary import MILLI, PERCENT, Metric
from reliab.report.style import (
    AMPLITUDE,
    DELAY,
    ERRORS,
    GREY,
    INK,
    SEQUENTIAL,
    apply_style,
    blank,
    label_logarithmic,
    legend_below,
    letters,
    line,
    mark,
    name_axes,
    panels,
)
from reliab.tracking.boundary.contour import Contour
from reliab.tracking.boundary.curves import Curve

_MANY = 12
_LEAST = 0.5


Curves = tuple[NDArray[np.float64], Mapping[Metric, NDArray[np.float64]]]
"""Abscissae, shape (n,), with the errors MTE^R and RMS^R [-] there."""


@apply_style
def error_curves(
    over_delay: Curves, over_amplitude: Curves, *, critical_delay: float, threshold: float
) -> Figure:
    """Draw how the error grows with the delay and with the amplitude error of the actuator.

    `over_delay`: delays d [s] and the errors; `over_amplitude`: amplitudes A [-] and the errors;
    `critical_delay`: where the loop becomes unstable [s]; `threshold`: error at which a test is no longer
    accepted [-]. Result: error [%] over delay [ms], on a linear and on a logarithmic scale, and over
    amplitude [-].
    """
    figure, axes = panels(1, 3, height=62.0)
    linear, logarithmic, amplitude = axes[0]
    letters(axes, ("delay", "delay, logarithmic scale", "amplitude"))
    for place in (linear, logarithmic):
        _curves(place, MILLI * over_delay[0], over_delay[1])
        place.axvline(MILLI * critical_delay, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        place.set_xlabel("Delay $d$ [ms]")
    _curves(amplitude, *over_amplitude)
    amplitude.set_xlabel(AMPLITUDE)
    amplitude.set_ylim(bottom=0.0)
    for place in axes[0]:
        place.axhline(PERCENT * threshold, color=GREY, linewidth=0.8, label=f"{PERCENT * threshold:g} %")
    logarithmic.set_yscale("log")
    logarithmic.set_ylim(bottom=_LEAST)
    label_logarithmic(logarithmic.yaxis)
    linear.set_ylabel("Error of the whole test [%]")
    mark(linear, "critical\ndelay", (_share_of(linear, MILLI * critical_delay) - 0.02, 0.97), ha="right")
    legend_below(figure, linear)
    return figure


def _curves(axes: Axes, x: NDArray[np.float64], errors: Mapping[Metric, NDArray[np.float64]]) -> None:
    for rank, (metric, values) in enumerate(errors.items()):
        axes.plot(
            x,
            PERCENT * values,
            label=ERRORS[metric],
            markevery=max(1, x.size // _MANY),
            **line(rank, marker=True),
        )
    axes.set_xlim(x.min(), x.max())


def _share_of(axes: Axes, x: float) -> float:
    low, high = axes.get_xlim()
    return (x - low) / (high - low)


_HEADROOM = 1.18


@apply_style
def error_contours(contours: Mapping[Metric, Mapping[float, Contour]]) -> Figure:
    """Draw contours of equal error, MTE^R and RMS^R side by side on the same scales.

    `contours`: contours by error and by threshold [-]. Result: delay [ms] over amplitude [-]; inside a
    contour the error is smaller.
    """
    figure, axes = panels(1, len(contours), height=62.0, share_x=True, share_y=True)
    letters(axes, tuple(ERRORS[metric] for metric in contours))
    for place, by_threshold in zip(axes[0], contours.values(), strict=True):
        for rank, (threshold, contour) in enumerate(by_threshold.items()):
            _draw(place, contour, f"{PERCENT * threshold:g} %", rank)
        name_axes(place, AMPLITUDE, DELAY)
        place.legend(loc="upper right", title="error of the test")
    drawn = [contour for of_metric in contours.values() for contour in of_metric.values()]
    axes[0, 0].set_ylim(0.0, _HEADROOM * MILLI * max(float(contour.delay.max()) for contour in drawn))
    mark(axes[0, 0], "inside: smaller error", (0.5, 0.12), ha="center")
    return figure


def _draw(axes: Axes, contour: Contour, name: str, rank: int) -> None:
    step = max(1, contour.amplitude.size // 16)
    axes.plot(
        contour.amplitude,
        MILLI * np.asarray(contour.delay),
        label=name,
        markevery=step,
        **line(rank, marker=True),
    )


_LEVELS = 8
_VIEW = {"elev": 27.0, "azim": -58.0}


@apply_style
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
    figure = blank(height=124.0)
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
        *grid,
        percent,
        cmap=SEQUENTIAL,
        rstride=1,
        cstride=1,
        linewidth=0.15,
        edgecolor=INK,
        antialiased=True,
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


_POINTS = 201


@apply_style
def curve_fits(contour: Contour, curves: Sequence[Curve]) -> Figure:
    """Draw a contour of equal error with the curves fitted to it.

    `contour`: amplitude [-] and delay [s] along the contour. Result: delay [ms] over amplitude [-]; the
    legend gives each fitting error [ms⁴].
    """
    figure, axes = panels(height=68.0, width=120.0)
    place = axes[0, 0]
    margin = 0.1 * np.ptp(contour.amplitude)
    amplitude = np.linspace(contour.amplitude[0] - margin, contour.amplitude[-1] + margin, _POINTS)
    for rank, curve in enumerate(curves):
        name = f"{curve.name}, misfit {significant(curve.sse, 2)} ms⁴"
        place.plot(amplitude, MILLI * curve.delay(amplitude), label=name, **line(rank))
    place.plot(
        contour.amplitude,
        MILLI * contour.delay,
        "o",
        color=INK,
        markersize=3.0,
        fillstyle="none",
        label="contour",
    )
    place.set_ylim(0.0, 1.35 * MILLI * contour.delay.max())
    place.legend(loc="upper center", ncols=2)
    name_axes(place, AMPLITUDE, DELAY)
    return figure
