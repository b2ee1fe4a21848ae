"""Error of the whole test against delay (Figure 4) and against amplitude (Figure 6)."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report.axes import AMPLITUDE, ERRORS, MILLI, label_logarithmic, mark
from reliab.report.style import GREY, INK, letters, line, panels, styled
from reliab.vocabulary import Metric

_HEIGHT = 58.0
_PERCENT = 100.0
_MANY = 12
_LEAST = 0.5


@styled
def error_against_delay(
    delays: NDArray[np.float64],
    errors: Mapping[Metric, NDArray[np.float64]],
    *,
    critical_delay: float,
    threshold: float,
) -> Figure:
    """Draw how the error grows with the delay of the actuator (Figure 4).

    Parameters
    ----------
    delays : array of float, shape (n,)
        Delays d [s].
    errors : mapping of Metric to array of float, shape (n,)
        MTE^R and RMS^R [-].
    critical_delay : float
        Where the loop becomes unstable [s].
    threshold : float
        Error at which a test is no longer accepted [-].

    Returns
    -------
    matplotlib.figure.Figure
        Error [%] over delay [ms], on a linear and on a logarithmic scale.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, ("linear scale", "logarithmic scale"))
    for place in axes[0]:
        _curves(place, MILLI * delays, errors)
        _threshold(place, threshold)
        place.axvline(MILLI * critical_delay, color=INK, linewidth=0.8, linestyle=(0, (1, 2)))
        place.set_xlabel("Delay $d$ [ms]")
    axes[0, 1].set_yscale("log")
    axes[0, 1].set_ylim(bottom=_LEAST)
    label_logarithmic(axes[0, 1].yaxis)
    mark(
        axes[0, 0],
        "critical\ndelay",
        (_share_of(axes[0, 0], MILLI * critical_delay) - 0.02, 0.97),
        ha="right",
    )
    axes[0, 0].legend(loc="center left")
    return figure


@styled
def error_against_amplitude(
    amplitudes: NDArray[np.float64], errors: Mapping[Metric, NDArray[np.float64]], *, threshold: float
) -> Figure:
    """Draw how the error grows with the amplitude error of the actuator (Figure 6).

    Parameters
    ----------
    amplitudes : array of float, shape (n,)
        Amplitudes A [-].
    errors : mapping of Metric to array of float, shape (n,)
        MTE^R and RMS^R [-].
    threshold : float
        Error at which a test is no longer accepted [-].

    Returns
    -------
    matplotlib.figure.Figure
        Error [%] over amplitude [-].
    """
    figure, axes = panels(height=_HEIGHT, width=100.0)
    _curves(axes[0, 0], amplitudes, errors)
    _threshold(axes[0, 0], threshold)
    axes[0, 0].set_xlabel(AMPLITUDE)
    axes[0, 0].set_ylim(bottom=0.0)
    axes[0, 0].legend(loc="upper center")
    return figure


def _curves(axes: Axes, x: NDArray[np.float64], errors: Mapping[Metric, NDArray[np.float64]]) -> None:
    for rank, (metric, values) in enumerate(errors.items()):
        axes.plot(
            x,
            _PERCENT * values,
            label=ERRORS[metric],
            markevery=max(1, x.size // _MANY),
            **line(rank, marker=True),
        )
    axes.set_ylabel("Error of the whole test [%]")
    axes.set_xlim(x.min(), x.max())


def _threshold(axes: Axes, threshold: float) -> None:
    axes.axhline(_PERCENT * threshold, color=GREY, linewidth=0.8, label=f"{_PERCENT * threshold:g} %")


def _share_of(axes: Axes, x: float) -> float:
    low, high = axes.get_xlim()
    return (x - low) / (high - low)
