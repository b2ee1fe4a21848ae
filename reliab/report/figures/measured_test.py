"""A measured test in the plane of amplitude and delay and over time; tests by their errors."""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from numpy.typing import NDArray

from reliab.assessment.comparison import Comparison
from reliab.assessment.design import TolerableErrors
from reliab.assessment.tracking_index import TrackingIndex, Windows
from reliab.core.significant_digits import percent, share_in_words
from reliab.core.vocabulary import MILLI, PERCENT, Metric
from reliab.report.style import (
    AMPLITUDE_LIMIT,
    BLUE,
    DELAY_LIMIT,
    FREQUENCY,
    GREY,
    INK,
    PALE,
    TIME,
    VERMILION,
    apply_style,
    blank,
    legend_below,
    letters,
    line,
    name_axes,
    panels,
    plain,
)

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


_HEIGHT = 76.0


@apply_style
def tolerable_errors_over_frequency(tolerances: Sequence[TolerableErrors]) -> Figure:
    """Draw how much amplitude error and delay a rig may have.

    Returns [ms].
    Returns two panels: amplitude error and delay [ms], each alone, over the frequency; a line a confidence.
    """
    figure, axes = panels(1, 2, height=_HEIGHT)
    letters(axes, (r"$\sqrt{a}$, no delay", r"$\sqrt{b}$, no amplitude error"))
    for rank, confidence in enumerate(sorted({tolerance.confidence for tolerance in tolerances})):
        ordered_tolerances = sorted(
            (tolerance for tolerance in tolerances if tolerance.confidence == confidence),
            key=lambda tolerance: tolerance.frequency,
        )
        f = np.array([tolerance.frequency for tolerance in ordered_tolerances])
        has_promise = all(tolerance.promise is not None for tolerance in ordered_tolerances)
        share = share_in_words(confidence if has_promise else None, decimals=0)
        name = f"{share} of comparable ground motions"
        axes[0, 0].plot(
            f,
            [tolerance.amplitude_error for tolerance in ordered_tolerances],
            label=name,
            **line(rank, marker=True),
        )
        axes[0, 1].plot(
            f,
            [MILLI * tolerance.delay for tolerance in ordered_tolerances],
            label=name,
            **line(rank, marker=True),
        )
    axes[0, 0].set_ylim(bottom=0.0)
    axes[0, 1].set_yscale("log")
    axes[0, 1].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[0, 1].yaxis.set_major_formatter("{x:g}")
    axes[0, 1].yaxis.set_minor_locator(NullLocator())
    name_axes(axes[0, 0], FREQUENCY, AMPLITUDE_LIMIT)
    name_axes(axes[0, 1], FREQUENCY, DELAY_LIMIT)
    legend_below(figure, axes[0, 0], columns=2)
    return figure


_CHART_MARGIN: Final = 26.0
_ROW: Final = 7.0
_TALLEST: Final = 220.0
_LONGEST: Final = 32  # characters of the name of a test
_NAMES: Final = {Metric.RMS: "RMS", Metric.MTE: "MTE"}


@apply_style
def draw_ranked_tests(comparison: Comparison) -> Figure:
    """Draw the error of each test with its 90 % interval, the smallest above, and the threshold."""
    tests = comparison.tests
    figure, axes = panels(1, 1, height=min(_CHART_MARGIN + _ROW * len(tests), _TALLEST))
    place = axes[0, 0]
    rows = np.arange(len(tests))
    low, value, high = (
        PERCENT * np.array([getattr(test.error, end) for test in tests]) for end in ("low", "value", "high")
    )
    place.hlines(rows, low, high, color=BLUE, linewidth=1.4, label="90 % interval")
    place.plot(value, rows, "o", color=BLUE, markersize=4.0, label="error of the whole test")
    threshold = percent(comparison.threshold)
    place.axvline(
        PERCENT * comparison.threshold,
        color=VERMILION,
        linewidth=1.2,
        linestyle=(0, (5, 1.6)),
        label=f"threshold, {threshold}",
    )
    place.set_yticks(rows, [plain(test.file, longest=_LONGEST) for test in tests])
    place.set_ylim(len(tests) - 0.4, -0.6)
    place.set_xlim(left=0.0)
    place.set_xlabel(f"{_NAMES[comparison.metric]} error of the whole test [%]")
    legend_below(figure, place, columns=3)
    return figure
