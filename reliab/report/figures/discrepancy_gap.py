"""The gap between model and measurement on a held-out test, before and after effects were added."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter
from numpy.typing import NDArray

from reliab.report.axes import TIME, name_axes, plain
from reliab.report.style import BLUE, GREY, INK, VERMILION, panels, styled
from reliab.significant import significant

_PANEL_HEIGHT, _MARGIN = 37.0, 12.0
_MOST_SAMPLES = 3000
_BAND = 2.0  # standard deviations of the noise


@dataclass(frozen=True, kw_only=True, eq=False)
class GapPanel:
    """One channel of a held-out test."""

    title: str  # Channel and test
    label: str  # What the axis is called, with the unit of the residuals
    rate: float  # Sampling rate [Hz]
    before: NDArray[np.float64]  # before, after: Residuals in that unit, shape (n,)
    after: NDArray[np.float64]
    noise: float | None  # RMS in that unit of what the recordings do not repeat, None where it is not known
    # RMS over that of the signal, over all held-out tests: before, after and, where known, noise [-]
    errors: tuple[float, ...]


@styled
def discrepancy_gap(shown: Sequence[GapPanel]) -> Figure:
    """Draw residuals over time, and their size beside the noise's, channel by channel.

    Returns A row for each channel: histories with the band of the noise, and RMS on a logarithmic scale.
    """
    height = _PANEL_HEIGHT * len(shown) + _MARGIN
    figure, axes = panels(len(shown), 2, height=height, ratios=(3.0, 1.25))
    for row, (channel, places) in enumerate(zip(shown, axes, strict=True)):
        _histories(places[0], channel, legend=row == 0)
        _bars(places[1], channel)
        if row == len(shown) - 1:
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
    count = len(channel.errors)
    names, colours = ("before", "after", "noise")[:count], (VERMILION, BLUE, GREY)[:count]
    place.barh(names, channel.errors, color=colours, height=0.6)
    place.invert_yaxis()
    place.set_xscale("log")
    place.xaxis.set_minor_formatter(NullFormatter())
    low, high = min(channel.errors), max(channel.errors)
    place.set_xlim(0.08 * max(low, 1e-9), 12.0 * high)
    for rank, value in enumerate(channel.errors):
        place.text(1.15 * value, rank, significant(value), va="center", fontsize=8.0)
    name_axes(place, "RMS over signal's RMS [-]", "")
