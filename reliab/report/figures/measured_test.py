"""A measured test: its error, in the plane of amplitude and delay, and over time."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.assessment.tracking_index import TrackingIndex, Windows
from reliab.core.vocabulary import MILLI, PERCENT
from reliab.report.axes import TIME, legend_below, name_axes, plain
from reliab.report.style import BLUE, GREY, INK, PALE, apply_style, blank, line, panels

_MARGIN = 1.12
_POINTS = 241
_MOST_SAMPLES = 4000
_TWO = 2.0  # standard deviations


@apply_style
def tracking_overview(
    tracking: TrackingIndex, *, boundaries: Mapping[str, tuple[float, float]], windows: Windows | None
) -> Figure:
    """Draw a test in the plane of amplitude and delay, and both over the test.

    Returns delay [ms] over amplitude error [%] with 95 % intervals, and beside it both over time.
    """
    figure = blank(height=46.0)
    columns = 1 if windows is None else 2
    grid = figure.add_gridspec(2, columns, width_ratios=(1.0, 1.0)[:columns])
    plane = figure.add_subplot(grid[:, 0])
    _draw_plane(plane, tracking, boundaries)
    legend_below(figure, plane, columns=3)
    if windows is not None:
        upper = figure.add_subplot(grid[0, 1])
        lower = figure.add_subplot(grid[1, 1], sharex=upper)
        upper.tick_params(labelbottom=False)
        _draw_windows(upper, lower, windows)
    return figure


def _draw_plane(place: Axes, tracking: TrackingIndex, boundaries: Mapping[str, tuple[float, float]]) -> None:
    delay, draws = tracking.delay, tracking.draws
    angle = np.linspace(0.0, np.pi if delay >= 0.0 else -np.pi, _POINTS)
    for rank, (name, (a, b)) in enumerate(boundaries.items()):
        if a > 0.0 and b > 0.0:
            x, y = PERCENT * np.sqrt(a) * np.cos(angle), np.sqrt(b) * np.sin(angle)
            place.plot(x, y, label=plain(name), **{**line(rank), "linewidth": 1.8})
    cloud = PERCENT * (draws[0] - 1.0), MILLI * draws[1]
    place.plot(*cloud, ".", color=GREY, markersize=1.2, alpha=0.35, zorder=1.0)
    position = np.array([[PERCENT * (tracking.amplitude - 1.0)], [MILLI * delay]])
    ends = np.quantile(np.stack(cloud), [0.025, 0.975], axis=1)
    reach = np.maximum(np.stack([position[:, 0] - ends[0], ends[1] - position[:, 0]]), 0.0)
    place.errorbar(
        position[0],
        position[1],
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
    name_axes(place, "Amplitude error $A - 1$ [%]", "Delay $d$ [ms]")


def _draw_windows(upper: Axes, lower: Axes, windows: Windows) -> None:
    bars: dict[str, Any] = {"fmt": "o", "color": BLUE, "capsize": 2.0, "elinewidth": 0.8, "markersize": 3.0}
    rows = (
        (upper, PERCENT * (windows.amplitude - 1.0), PERCENT * windows.amplitude_sd, "$A - 1$ [%]"),
        (lower, MILLI * windows.delay, MILLI * windows.delay_sd, "$d$ [ms]"),
    )
    for place, values, deviations, name in rows:
        place.errorbar(windows.centre, values, yerr=_TWO * deviations, **bars)
        place.axhline(0.0, color=GREY, linewidth=0.6)
        place.set_ylabel(name)
    lower.set_xlabel(TIME)


@apply_style
def error_over_time(
    *,
    times: NDArray[np.float64],
    reference: NDArray[np.float64],
    measured_values: NDArray[np.float64],
    error: NDArray[np.float64],
    band: tuple[NDArray[np.float64], NDArray[np.float64]],
    parts: Mapping[str, NDArray[np.float64]],
) -> Figure:
    """Draw the exact and the measured history, the error with its band, and its parts over time.

    `times`, `reference`, `measured`, `error` (n,) [s]; `band` (n,); `parts` (stretches,);
    returns [s].
    Returns three panels over one scale of time [s]; displacements over the peak of the exact one.
    """
    figure, axes = panels(3, 1, height=64.0, share_x=True)
    histories, errors, ratio_axes = axes[:, 0]
    peak = float(np.abs(reference).max())
    samples = np.linspace(0, times.size - 1, min(times.size, _MOST_SAMPLES)).astype(int)
    histories.plot(times[samples], reference[samples] / peak, color=PALE, linewidth=2.6, label="exact $x_I$")
    histories.plot(
        times[samples], measured_values[samples] / peak, color=BLUE, linewidth=0.7, label="measured $x_m$"
    )
    histories.set_ylabel("Displacement\nover peak [-]")
    errors.fill_between(
        times[samples],
        *(PERCENT / peak * end[samples] for end in band),
        color=PALE,
        label="90 % band",
        linewidth=0.0,
    )
    errors.plot(
        times[samples], PERCENT / peak * error[samples], color=BLUE, linewidth=0.7, label="$x_m - x_I$"
    )
    errors.set_ylabel("Error\nover peak [%]")
    for rank, (name, sizes) in enumerate(parts.items()):
        edges = np.linspace(times[0], times[-1], sizes.size + 1)
        ratio_axes.stairs(PERCENT / peak * sizes, edges, label=plain(name), baseline=None, **line(rank))
    ratio_axes.set_ylabel("RMS of parts\nover peak [%]")
    ratio_axes.set_xlabel(TIME)
    for place in axes[:, 0]:
        place.margins(x=0.0)
        place.legend(loc="lower right", bbox_to_anchor=(1.0, 0.98), ncols=4, borderpad=0.0)
    figure.align_ylabels(axes[:, 0])
    return figure
