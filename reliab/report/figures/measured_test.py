"""A measured test: in the plane of amplitude and delay, and over time."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.report.axes import MILLI, TIME, legend_below, name_axes, plain
from reliab.report.style import BLUE, GREY, INK, PALE, line, panels, styled

_PERCENT = 100.0
_MARGIN = 1.12
_POINTS = 241
_MOST_SAMPLES = 4000
_TWO = 2.0  # standard deviations


@styled
def tracking_plane(
    *,
    amplitude: float,
    delay: float,
    draws: NDArray[np.float64],
    boundaries: Mapping[str, tuple[float, float]],
    height: float = 88.0,
) -> Figure:
    """Draw a test with its uncertainty and the ellipses inside of which it would be accepted.

    Parameters
    ----------
    amplitude, delay : float
        A [-] and d [s] of the test.
    draws : array of float, shape (2, draws)
        What noise leaves open: A [-] and d [s].
    boundaries : mapping of str to (float, float)
        a [-] and b [ms²] by the name of the boundary; those of zero size are left out.
    height : float, optional
        Height in print [mm].

    Returns
    -------
    matplotlib.figure.Figure
        Delay [ms] over amplitude error [%], with 95 % intervals.
    """
    figure, axes = panels(height=height)
    place = axes[0, 0]
    angle = np.linspace(0.0, 2.0 * np.pi, _POINTS)
    for rank, (name, (a, b)) in enumerate(boundaries.items()):
        if a > 0.0 and b > 0.0:
            x, y = _PERCENT * np.sqrt(a) * np.cos(angle), np.sqrt(b) * np.sin(angle)
            place.plot(x, y, label=plain(name), **{**line(rank), "linewidth": 1.8})
    cloud = _PERCENT * (draws[0] - 1.0), MILLI * draws[1]
    place.plot(*cloud, ".", color=GREY, markersize=1.2, alpha=0.35, zorder=1.0)
    at = np.array([[_PERCENT * (amplitude - 1.0)], [MILLI * delay]])
    ends = np.quantile(np.stack(cloud), [0.025, 0.975], axis=1)
    reach = np.maximum(np.stack([at[:, 0] - ends[0], ends[1] - at[:, 0]]), 0.0)
    place.errorbar(
        *at,
        xerr=reach[:, :1],
        yerr=reach[:, 1:],
        fmt="D",
        color=INK,
        capsize=2.5,
        label="test, 95 % intervals",
    )
    place.axhline(0.0, color=GREY, linewidth=0.6)
    place.axvline(0.0, color=GREY, linewidth=0.6)
    place.margins(_MARGIN - 1.0)
    name_axes(place, "Amplitude error $A - 1$ [%]", "Equivalent delay $d$ [ms]")
    legend_below(figure, place, columns=3)
    return figure


@styled
def tracking_over_time(
    *,
    times: NDArray[np.float64],
    command: NDArray[np.float64],
    measured: NDArray[np.float64],
    centres: NDArray[np.float64],
    amplitude: NDArray[np.float64],
    amplitude_sd: NDArray[np.float64],
    delay: NDArray[np.float64],
    delay_sd: NDArray[np.float64],
    height: float = 88.0,
) -> Figure:
    """Draw the histories of a test, and its amplitude error and delay in moving windows.

    Parameters
    ----------
    times, command, measured : array of float, shape (n,)
        Times [s], and displacements in one unit.
    centres : array of float, shape (windows,)
        Middle of each window [s].
    amplitude, amplitude_sd : array of float, shape (windows,)
        A [-] and its standard deviation.
    delay, delay_sd : array of float, shape (windows,)
        d [s] and its standard deviation.
    height : float, optional
        Height in print [mm].

    Returns
    -------
    matplotlib.figure.Figure
        Three panels over one scale of time [s].
    """
    figure, axes = panels(3, 1, height=height, share_x=True)
    histories, of_amplitude, of_delay = axes[:, 0]
    peak = float(np.abs(command).max())
    kept = np.linspace(0, times.size - 1, min(times.size, _MOST_SAMPLES)).astype(int)
    histories.plot(times[kept], command[kept] / peak, color=PALE, linewidth=2.6, label="command")
    histories.plot(times[kept], measured[kept] / peak, color=BLUE, linewidth=0.7, label="measured")
    histories.set_ylabel("Displacement\nover its peak [-]")
    histories.legend(loc="upper right", ncols=2)
    histories.margins(x=0.0)
    bars = {"fmt": "o", "color": BLUE, "capsize": 2.0, "elinewidth": 0.8, "markersize": 3.0}
    of_amplitude.errorbar(centres, _PERCENT * (amplitude - 1.0), yerr=_TWO * _PERCENT * amplitude_sd, **bars)
    of_delay.errorbar(centres, MILLI * delay, yerr=_TWO * MILLI * delay_sd, **bars)
    for place, name in ((of_amplitude, "$A - 1$ [%]"), (of_delay, "$d$ [ms]")):
        place.axhline(0.0, color=GREY, linewidth=0.6)
        place.set_ylabel(name)
    of_delay.set_xlabel(TIME)
    figure.align_ylabels(axes[:, 0])
    return figure
