"""The tests of a rig in their order: gain, delay, remainder and error, each against its prediction."""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from reliab.arrays import Array
from reliab.report.axes import legend_below
from reliab.report.style import BLUE, GREY, INK, PALE, VERMILION, letters, panels, styled
from reliab.rig import DriftChart, RigTable, known_effects, watch
from reliab.vocabulary import PERCENT

_HEIGHT: Final = 150.0
_AHEAD: Final = 0.035  # of the number of tests, by which the next one stands to the right


@styled
def rig_over_time(
    table: RigTable, chart: DriftChart, coming: Mapping[str, Mapping[str, float]], threshold: float
) -> Figure:
    """Draw each test with its prediction from those before, what was noticed to change, and the next test."""
    figure, axes = panels(4, 1, height=_HEIGHT, share_x=True)
    letters(axes, ("Amplitude", "Equivalent delay", "Remainder", "Error of the whole test"))
    errors = table.numbers("rms")
    known = np.isfinite(errors)
    logarithms = np.log(np.maximum(np.where(known, errors, np.nanmedian(errors)), 1e-12))
    of_errors = _band(logarithms, known_effects(table.rows), chart.segments)
    drawn: tuple[tuple[str, Array, tuple[Array, Array], str], ...] = (
        ("A", chart.values["gain"], chart.bands["gain"], "$A$ [-]"),
        ("d_ms", chart.values["delay"], chart.bands["delay"], "$d$ [ms]"),
        ("remainder", *_percent(chart.values["noise"], chart.bands["noise"]), "[% of RMS]"),
        ("rms", *_percent(np.where(known, logarithms, np.nan), of_errors), "$RMS^R$ [%]"),
    )
    good = np.array([bool(row["reliable"]) for row in table.rows], dtype=np.bool_)
    for place, (name, values, band, label) in zip(axes[:, 0], drawn, strict=True):
        factor = PERCENT if name in ("remainder", "rms") else 1.0
        _draw(place, values, band, good)
        _draw_next(place, {end: factor * value for end, value in coming[name].items()}, values.size)
        _draw_changes(place, chart)
        place.set_ylabel(label)
        low, high = np.nanquantile(values, [0.01, 0.99])
        reach = max(high - low, 1e-3 * abs(high))
        bottom = min(low - 0.4 * reach, factor * coming[name]["low"])
        place.set_ylim(max(bottom, 0.0) if factor != 1.0 else bottom, high + 0.6 * reach)
    axes[-1, 0].axhline(
        PERCENT * threshold, color=VERMILION, linewidth=1.1, linestyle=(0, (1, 2)), label="threshold"
    )
    axes[-1, 0].set_ylim(top=max(axes[-1, 0].get_ylim()[1], 1.1 * PERCENT * threshold))
    axes[-1, 0].set_xlabel("Test, in the order of their dates")
    legend_below(figure, *axes[:, 0], columns=3)
    return figure


def _band(values: Array, effects: Array, segments: Array) -> tuple[Array, Array]:
    """Predict each test from those before it since the last change of the rig."""
    low, high = np.full(values.size, np.nan), np.full(values.size, np.nan)
    for segment in np.unique(segments):
        places = segments == segment
        low[places], high[places] = watch(values[places], effects[places], math.inf).band
    return low, high


def _percent(logarithms: Array, band: tuple[Array, Array]) -> tuple[Array, tuple[Array, Array]]:
    low, high = (PERCENT * np.exp(np.clip(end, -30.0, 30.0)) for end in band)
    return PERCENT * np.exp(logarithms), (low, high)


def _draw(axes: Axes, values: Array, band: tuple[Array, Array], good: NDArray[np.bool_]) -> None:
    numbers = np.arange(1, values.size + 1)
    axes.fill_between(numbers, *band, color=PALE, linewidth=0.0, label="90 % interval from the tests before")
    axes.plot(numbers[good], values[good], "o", color=BLUE, markersize=2.6, label="reliable test")
    axes.plot(numbers[~good], values[~good], "x", color=INK, markersize=3.6, label="other test")


def _draw_next(axes: Axes, interval: Mapping[str, float], count: int) -> None:
    at = count + max(1.0, _AHEAD * count)
    axes.vlines(at, interval["low"], interval["high"], color=BLUE, linewidth=2.2, label="next test, 90 %")
    axes.plot([at], [interval["median"]], "s", color=BLUE, markersize=4.0)


def _draw_changes(axes: Axes, chart: DriftChart) -> None:
    for change in chart.changes:
        axes.axvline(
            change.noticed + 1,
            color=VERMILION if change.confirmed else GREY,
            linewidth=0.9,
            linestyle=(0, (5, 1.6)) if change.confirmed else (0, (1, 1.6)),
            label="change noticed" if change.confirmed else "not confirmed by the next tests",
        )
