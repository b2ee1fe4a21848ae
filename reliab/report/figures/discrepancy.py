"""Figures of a diagnosis: the loop, the gap, histories, posteriors, residuals over state and frequency."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.patches import FancyBboxPatch
from numpy.typing import NDArray
from scipy.signal import ShortTimeFFT
from scipy.stats import binned_statistic_2d

from reliab.core.arrays import Array
from reliab.core.vocabulary import MILLI, PERCENT, Block
from reliab.report.numbers import Significant, write_in_line
from reliab.report.style import (
    BLUE,
    GREY,
    INK,
    PALE,
    SEQUENTIAL,
    TIME,
    VERMILION,
    apply_style,
    blank,
    legend_below,
    letters,
    name_axes,
    panels,
    plain,
)

_PANEL_HEIGHT, _MARGIN = 37.0, 12.0
_COLOUR_OF: Final = {"before": VERMILION, "linear": PALE, "rival": GREY, "after": BLUE, "noise": INK}
_MOST_SAMPLES = 3000
_BAND = 2.0  # standard deviations of the noise
_BLOCKS_HEIGHT: Final = 62.0
_LINE: Final = 1.0
_HALF: Final = (1.7, 0.75)
_PLACES: Final = {
    Block.EXCITATION: (1.9, 4.2),
    Block.NUMERICAL: (6.7, 4.2),
    Block.ACTUATOR: (11.5, 4.2),
    Block.SENSOR: (14.2, 1.6),
    Block.SPECIMEN: (8.2, 1.6),
}
_NAMES: Final = {
    Block.EXCITATION: "excitation",
    Block.NUMERICAL: "numerical substructure",
    Block.ACTUATOR: "actuator",
    Block.SENSOR: "sensors",
    Block.SPECIMEN: "specimen",
}
_LOOKS: Final[dict[str, dict[str, Any]]] = {
    "lacking": {"facecolor": "#f7d9c6", "edgecolor": VERMILION, "linewidth": 2.4},
    "sound": {"facecolor": "white", "edgecolor": BLUE, "linewidth": 1.2},
    "unseen": {"facecolor": "white", "edgecolor": GREY, "linewidth": 1.0, "linestyle": (0, (3, 2))},
}
_HISTORIES_HEIGHT = 70.0
_SIDE, _LARGEST, _NARROWEST = 36.0, 160.0, 90.0
_NAME_PAD = 0.1  # inches, for the names above the panels
_BINS = 30
_INTERVAL = (0.05, 0.95)
_SHARES = (0.9, 0.5)  # of the draws inside the contours
_STATE_PLANE_HEIGHT = 56.0
_FIELD_BINS = 25
_FEWEST_SAMPLES = 3  # samples in a field
_REACH = 0.995  # quantile of the motion at which the axes end
_COLOURS = "RdBu_r"
_TIME_FREQUENCY_HEIGHT = 54.0
STRETCHES = 24.0
"""Lengths of a spectrogram's window in a test."""

_OVERLAP = 8
_RANGE = (-10.0, 40.0)  # dB


@dataclass(frozen=True, kw_only=True, eq=False)
class GapPanel:
    """One channel of a held-out test."""

    title: str  # Channel and test
    label: str  # What the axis is called, with the unit of the residuals
    rate: float  # Sampling rate [Hz]
    before: NDArray[np.float64]  # before, after: Residuals in that unit, shape (n,)
    after: NDArray[np.float64]
    noise: float | None  # RMS in that unit of what the recordings do not repeat, None where it is not known
    # RMS over that of the signal, over all held-out tests [-]: of models, by name, and of the noise
    errors: Mapping[str, float]


@apply_style
def discrepancy_gap(channels: Sequence[GapPanel]) -> Figure:
    """Draw residuals over time, and their size beside the noise's, channel by channel.

    Returns A row for each channel: histories with the band of the noise, and RMS of what every model leaves.
    """
    height = _PANEL_HEIGHT * len(channels) + _MARGIN
    figure, axes = panels(len(channels), 2, height=height, ratios=(3.0, 1.25))
    for row, (channel, places) in enumerate(zip(channels, axes, strict=True)):
        _histories(places[0], channel, legend=row == 0)
        _bars(places[1], channel)
        if row == len(channels) - 1:
            places[0].set_xlabel(TIME)
    return figure


def _histories(place: Axes, channel: GapPanel, *, legend: bool) -> None:
    every = max(1, channel.before.size // _MOST_SAMPLES)
    time = np.arange(channel.before.size)[::every] / channel.rate
    reach = _BAND * (channel.noise or 0.0)
    place.plot(time, channel.before[::every], color=VERMILION, linewidth=0.6, label="before")
    place.plot(time, channel.after[::every], color=BLUE, linewidth=0.6, label="after")
    for side in (-reach, reach) if reach > 0.0 else ():
        place.axhline(
            side,
            color=INK,
            linewidth=0.7,
            linestyle=(0, (4, 2)),
            label="± 2 RMS of noise" if side > 0 else None,
        )
    place.set_title(plain(channel.title), loc="left")
    name_axes(place, "", channel.label)
    if legend:
        peak = max(float(np.abs(channel.before).max()), reach)
        place.set_ylim(-1.1 * peak, 1.7 * peak)
        place.legend(loc="upper right", ncols=3)


def _bars(place: Axes, channel: GapPanel) -> None:
    errors = [PERCENT * error for error in channel.errors.values()]
    place.barh(list(channel.errors), errors, color=[_COLOUR_OF[name] for name in channel.errors], height=0.6)
    place.invert_yaxis()
    high = max(errors)
    place.set_xlim(0.0, 1.3 * high or 1.0)
    for rank, value in enumerate(errors):
        place.text(value + 0.02 * high, rank, write_in_line(Significant()(value)), va="center", fontsize=8.0)
    name_axes(place, "RMS over signal's RMS [%]", "")


@apply_style
def discrepancy_blocks(*, lacking: Mapping[Block, str], observed: Collection[Block]) -> Figure:
    """Draw the loop and colour what is missing in which block.

    Returns blocks that lack an effect are filled, others framed, those that no channel shows dashed.
    """
    figure = blank(height=_BLOCKS_HEIGHT)
    axes = figure.subplots()
    axes.set(xlim=(0.0, 16.2), ylim=(-0.4, 5.4), aspect="equal")
    axes.set_axis_off()
    _wires(axes)
    for block, place in _PLACES.items():
        kind = "lacking" if block in lacking else "sound" if block in observed else "unseen"
        _box(axes, place, _NAMES[block], lacking.get(block, ""), _LOOKS[kind])
    for k, (kind, text) in enumerate(
        (
            ("lacking", "missing effect"),
            ("sound", "observed, no missing effect"),
            ("unseen", "not observed"),
        )
    ):
        x = 0.4 + 5.3 * k
        axes.add_patch(FancyBboxPatch((x, -0.2), 0.5, 0.3, boxstyle="round,pad=0.03", **_LOOKS[kind]))
        axes.text(x + 0.75, -0.05, text, ha="left", va="center", fontsize=8.0)
    return figure


def _box(axes: Axes, centre: tuple[float, float], name: str, missing: str, look: dict[str, Any]) -> None:
    (x, y), (across, up) = centre, _HALF
    corner = (x - across, y - up)
    axes.add_patch(
        FancyBboxPatch(corner, 2.0 * across, 2.0 * up, boxstyle="round,pad=0.05", zorder=2.0, **look)
    )
    note: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 3.0}
    axes.text(x, y + (0.34 if missing else 0.0), name, **note)
    if missing:
        lines = "\n".join(map(plain, missing.split("\n")))
        axes.text(x, y - 0.32, lines, color=VERMILION, fontsize=8.0, fontweight="bold", **note)


def _wires(axes: Axes) -> None:
    _arrow(axes, [(3.7, 4.2), (4.9, 4.2)])
    _arrow(axes, [(8.5, 4.2), (9.7, 4.2)])
    _arrow(axes, [(13.3, 4.2), (14.2, 4.2), (14.2, 2.45)])
    _arrow(axes, [(13.7, 4.2), (13.7, 3.1), (10.9, 3.1), (10.9, 1.6), (10.0, 1.6)])
    _arrow(axes, [(6.4, 1.6), (4.4, 1.6), (4.4, 4.2), (4.9, 4.2)])
    for x, y, text, side in (
        (4.2, 4.4, "$a_g$", "center"),
        (9.1, 4.4, "$x_c$", "center"),
        (13.75, 4.4, "$x$", "center"),
        (5.3, 1.8, "$r$", "center"),
    ):
        axes.text(x, y, text, ha=side, va="bottom")


def _arrow(axes: Axes, points: list[tuple[float, float]]) -> None:
    *start, last = points
    axes.plot(*zip(*start, strict=True), color=INK, linewidth=_LINE, zorder=1.0)
    look = {"arrowstyle": "-|>", "color": INK, "linewidth": _LINE, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", last, start[-1], arrowprops=look, zorder=1.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelledHistory:
    """A stretch of a held-out test with what models leave of it."""

    time: Array  # Time [s], shape (n,)
    driven: Array  # What drives the block, in the unit of `input_label`, shape (n,)
    measured: Array  # The channel
    before: Array  # before, after: Residual of the calibrated model, and of the model with the effects
    after: Array
    input_label: str  # input_label, label, residual_label: Names of the quantities with their units
    label: str
    residual_label: str


@apply_style
def discrepancy_histories(history: ModelledHistory) -> Figure:
    """Draw a measured channel, and the residuals before and after effects were added.

    Returns above each other the channel and the residuals; left over time, right over what drives the block.
    """
    figure, axes = panels(2, 2, height=_HISTORIES_HEIGHT, ratios=(1.7, 1.0))
    cut = slice(None, None, max(1, history.time.size // _MOST_SAMPLES))
    for column, x in enumerate((history.time[cut], history.driven[cut])):
        above, below = axes[:, column]
        above.plot(x, history.measured[cut], color=INK, linewidth=0.8, label="measured")
        below.plot(x, history.before[cut], color=VERMILION, linewidth=0.8, label="residual before")
        below.plot(x, history.after[cut], color=BLUE, linewidth=0.8, label="after")
        above.tick_params(labelbottom=False)
        name_axes(above, "", "" if column else history.label)
        name_axes(
            below, history.input_label if column else "Time [s]", "" if column else history.residual_label
        )
    legend_below(figure, *axes[:, 0])
    return figure


@apply_style
def discrepancy_posterior(names: Sequence[str], draws: NDArray[np.float64]) -> Figure:
    """Draw every parameter and every pair of them.

    Returns densities with 90 % intervals on the diagonal, each under its name, contours of 50 and 90 % below.
    """
    count = len(names)
    size = min(_SIDE * count + 20.0, _LARGEST)
    figure, axes = panels(count, count, height=min(size, 0.9 * _LARGEST), width=max(size, _NARROWEST))
    figure.set_layout_engine("constrained", h_pad=_NAME_PAD)
    for row in range(count):
        for column in range(count):
            place = axes[row, column]
            if column > row:
                place.set_axis_off()
                continue
            if row == column:
                _draw_histogram(place, draws[:, row])
            else:
                _pair(place, draws[:, column], draws[:, row])
            place.tick_params(labelbottom=row == count - 1, labelleft=column == 0 and row > 0)
            place.locator_params(axis="x", nbins=3)
            place.ticklabel_format(useOffset=False, axis="x")
            place.tick_params(axis="x", rotation=30.0)
        # A name stands in the free half above the diagonal, where it collides with nothing.
        side: Literal["left", "right"] = "right" if row and row == count - 1 else "left"
        axes[row, row].set_title(plain(names[row], longest=80), loc=side, fontsize=8.0, in_layout=False)
    return figure


def _draw_histogram(place: Axes, values: NDArray[np.float64]) -> None:
    place.hist(values, bins=_BINS, density=True, histtype="stepfilled", facecolor=PALE, edgecolor=BLUE)
    for end in np.quantile(values, _INTERVAL):
        place.axvline(end, color=INK, linewidth=0.8, linestyle=(0, (4, 2)))
    place.set_yticks([])


def _pair(place: Axes, x: NDArray[np.float64], y: NDArray[np.float64]) -> None:
    place.plot(x[::4], y[::4], ".", color=BLUE, markersize=1.0, alpha=0.3, rasterized=True)
    counts, across, up = np.histogram2d(x, y, bins=_BINS // 2)
    ordered = np.sort(counts.ravel())[::-1]
    inside = np.cumsum(ordered) / ordered.sum()
    levels = sorted({float(ordered[np.searchsorted(inside, share)]) for share in _SHARES})
    centres = (0.5 * (edges[1:] + edges[:-1]) for edges in (across, up))
    place.contour(*centres, counts.T, levels=levels, colors=INK, linewidths=0.8)


@apply_style
def discrepancy_state_plane(
    displacement: NDArray[np.float64],
    velocity: NDArray[np.float64],
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    *,
    unit: str,
    factor: float = 1.0,
) -> Figure:
    """Draw mean residuals over the state of the specimen, before and after effects were added.

    `displacement`, `velocity` [m, m/s].
    Returns mean residual over displacement [mm] and velocity [mm/s] on one scale; blank where the tests never
    were.
    """
    figure, axes = panels(1, 2, height=_STATE_PLANE_HEIGHT, share_x=True, share_y=True)
    letters(axes, ("calibrated model", "with the effects"))
    ends = [MILLI * float(np.quantile(np.abs(values), _REACH)) for values in (displacement, velocity)]
    fields = [_field(displacement, velocity, factor * values, ends) for values in (before, after)]
    limit = float(np.nanquantile(np.abs(fields[0]), 0.98)) or 1.0
    for place, field in zip(axes[0], fields, strict=True):
        drawn = _draw_field(place, field, ends, limit)
        name_axes(place, "Displacement [mm]", "Velocity [mm/s]" if place is axes[0, 0] else "")
    figure.colorbar(drawn, ax=axes[0], label=f"Mean residual [{unit}]", extend="both")
    return figure


def _field(
    displacement: NDArray[np.float64],
    velocity: NDArray[np.float64],
    values: NDArray[np.float64],
    ends: list[float],
) -> NDArray[np.float64]:
    """Mean over fields of the state plane, shape (displacement, velocity)."""
    limits = [[-ends[0], ends[0]], [-ends[1], ends[1]]]
    position = (MILLI * displacement, MILLI * velocity)
    mean, count = (
        binned_statistic_2d(*position, values, statistic, bins=_FIELD_BINS, range=limits).statistic
        for statistic in ("mean", "count")
    )
    return np.where(count >= _FEWEST_SAMPLES, mean, np.nan)


def _draw_field(place: Axes, field: NDArray[np.float64], ends: list[float], limit: float) -> AxesImage:
    place.grid(visible=False)
    return place.imshow(
        field.T,
        origin="lower",
        aspect="auto",
        extent=(-ends[0], ends[0], -ends[1], ends[1]),
        cmap=_COLOURS,
        vmin=-limit,
        vmax=limit,
        interpolation="nearest",
    )


@apply_style
def discrepancy_time_frequency(
    before: NDArray[np.float64],
    after: NDArray[np.float64],
    *,
    density: NDArray[np.float64],
    rate: float,
    highest: float,
) -> Figure:
    """Draw the power of residuals over that of the noise, before and after effects were added.

    `rate`, `highest` [Hz].
    Returns power over noise [dB] over time [s] and frequency [Hz]; at 0 dB nothing is left but noise.
    """
    figure, axes = panels(1, 2, height=_TIME_FREQUENCY_HEIGHT, share_x=True, share_y=True)
    letters(axes, ("calibrated model", "with the effects"))
    for place, values in zip(axes[0], (before, after), strict=True):
        time, frequency, level = _levels(values, density, rate, highest)
        drawn = place.pcolormesh(
            time, frequency, level, cmap=SEQUENTIAL, vmin=_RANGE[0], vmax=_RANGE[1], rasterized=True
        )
        place.grid(visible=False)
        name_axes(place, TIME, "Frequency [Hz]" if place is axes[0, 0] else "")
    figure.colorbar(drawn, ax=axes[0], label="Residual over noise [dB]", extend="both")
    return figure


def _levels(
    values: NDArray[np.float64], density: NDArray[np.float64], rate: float, highest: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    length = 2 * int(values.size / STRETCHES / 2) + 2
    window = np.hanning(length + 1)[:-1]
    transform = ShortTimeFFT(window, max(1, length // _OVERLAP), rate)
    power = np.abs(transform.stft(values)) ** 2 / (window**2).sum()
    time, frequency = transform.t(values.size), transform.f
    inside, judged = (time >= 0.0) & (time <= values.size / rate), frequency <= highest
    noise = np.interp(frequency, np.linspace(0.0, rate / 2.0, density.size), density)
    level = 10.0 * np.log10(power[np.ix_(judged, inside)] / noise[judged, np.newaxis] + 1e-12)
    return time[inside], frequency[judged], level
