"""Amplitude and delay of actuator tracking over frequency."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from reliab.indices import TrackingOverFrequency
from reliab.report.axes import legend_below
from reliab.report.style import BLUE, GREY, PALE, VERMILION, panels, styled
from reliab.vocabulary import MILLI, PERCENT

_NINETY = 1.645  # standard deviations
_MARGIN = 0.25  # of the range of the values


@styled
def amplitude_and_delay_over_frequency(
    resolved: TrackingOverFrequency,
    *,
    amplitude: float,
    delay: float,
    modes: Sequence[float],
    height: float = 58.0,
) -> Figure:
    """Draw A(f) − 1 and d(f) with their 90 % bands, the index of the whole test, and the modes.

    `modes` [Hz]; `height` [mm].
    """
    figure, axes = panels(1, 2, height=height)
    rows = (
        (
            PERCENT * (resolved.amplitude - 1.0),
            PERCENT * resolved.amplitude_deviation,
            PERCENT * (amplitude - 1.0),
        ),
        (MILLI * resolved.delay, MILLI * resolved.delay_deviation, MILLI * delay),
    )
    names = "$A - 1$ [%]", "$d$ [ms]"
    for place, (values, deviations, whole), name in zip(axes[0], rows, names, strict=True):
        ends = values - _NINETY * deviations, values + _NINETY * deviations
        place.fill_between(resolved.frequency, *ends, color=PALE, linewidth=0.0, label="90 % band")
        place.plot(resolved.frequency, values, color=BLUE, linewidth=0.9, label="over frequency")
        place.axhline(whole, color=VERMILION, linewidth=0.9, linestyle="--", label="index of the test")
        for frequency in filter(resolved.known, modes):
            place.axvline(frequency, color=GREY, linewidth=0.7, linestyle=":")
        heights = np.append(values, whole)
        reach = _MARGIN * max(float(np.ptp(heights)), 0.02 * float(np.abs(heights).max()), 1e-3)
        place.set_ylim(float(heights.min()) - reach, float(heights.max()) + reach)
        place.set(xlabel="Frequency $f$ [Hz]", ylabel=name)
        place.margins(x=0.0)
    legend_below(figure, axes[0, 0], columns=3)
    return figure
