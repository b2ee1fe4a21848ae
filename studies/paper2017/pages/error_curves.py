"""Error of the whole test against delay and against amplitude (Figures 4 and 6)."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report import (
    AMPLITUDE,
    ERRORS,
    GREY,
    INK,
    label_logarithmic,
    legend_below,
    letters,
    line,
    mark,
    panels,
    styled,
)
from reliab.vocabulary import MILLI, PERCENT, Metric

_HEIGHT = 62.0
_MANY = 12
_LEAST = 0.5


Curves = tuple[NDArray[np.float64], Mapping[Metric, NDArray[np.float64]]]
"""Abscissae, shape (n,), with the errors MTE^R and RMS^R [-] there."""


@styled
def error_curves(
    over_delay: Curves, over_amplitude: Curves, *, critical_delay: float, threshold: float
) -> Figure:
    """Draw how the error grows with the delay and with the amplitude error of the actuator.

    `over_delay`: delays d [s] and the errors; `over_amplitude`: amplitudes A [-] and the errors;
    `critical_delay`: where the loop becomes unstable [s]; `threshold`: error at which a test is no longer
    accepted [-]. Result: error [%] over delay [ms], on a linear and on a logarithmic scale, and over
    amplitude [-].
    """
    figure, axes = panels(1, 3, height=_HEIGHT)
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
