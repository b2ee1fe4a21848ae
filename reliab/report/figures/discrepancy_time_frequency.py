"""Residual of a model in a measured channel, over time and frequency."""

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.signal import ShortTimeFFT

from reliab.report.axes import TIME, name_axes
from reliab.report.style import SEQUENTIAL, letters, panels, styled

_HEIGHT = 62.0
_STRETCHES = 24.0  # of the window, in a test
_OVERLAP = 8
_RANGE = (-10.0, 40.0)  # dB


@styled
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
    figure, axes = panels(1, 2, height=_HEIGHT, share_x=True, share_y=True)
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
    length = 2 * int(values.size / _STRETCHES / 2) + 2
    window = np.hanning(length + 1)[:-1]
    transform = ShortTimeFFT(window, max(1, length // _OVERLAP), rate)
    power = np.abs(transform.stft(values)) ** 2 / (window**2).sum()
    time, frequency = transform.t(values.size), transform.f
    inside, shown = (time >= 0.0) & (time <= values.size / rate), frequency <= highest
    noise = np.interp(frequency, np.linspace(0.0, rate / 2.0, density.size), density)
    level = 10.0 * np.log10(power[np.ix_(shown, inside)] / noise[shown, np.newaxis] + 1e-12)
    return time[inside], frequency[shown], level
