"""The band of the motion: where the command rises above the noise that was recorded with it."""

from dataclasses import dataclass

import numpy as np
import scipy

from reliab.arrays import Array
from reliab.recordings import Recording
from reliab.signals import hann, periodogram, upper_level

_ABOVE_FLOOR = 10.0
_SMOOTHED = 16  # bins over which a periodogram is averaged
_ROOM = 0.9  # share of the Nyquist frequency up to which a filter is worth while


@dataclass(frozen=True, kw_only=True, eq=False)
class Band:
    """Histories in the band of the motion, and the noise of the command."""

    command: Array  # command, measured: Filtered histories [m], shape (n,)
    measured: Array
    bins: int  # Bins of a periodogram in which the command rises above its noise
    noise: Array  # Noise in the filtered command by bin, over the command's power [-], shape (n // 2,)


def in_band(recording: Recording) -> Band:
    """Filter both histories alike at twice the highest frequency where the command rises above its noise."""
    power = power_of(recording.command)
    floor, _ = noise_floor(recording.command)
    smooth = np.convolve(power, np.full(_SMOOTHED, 1.0 / _SMOOTHED), mode="same")
    bins = int(np.flatnonzero(smooth >= np.minimum(_ABOVE_FLOOR * floor, smooth.max()))[-1]) + 1
    histories, passed = [recording.command, recording.measured], np.ones(power.size)
    if 2 * bins < _ROOM * power.size:
        sections = scipy.signal.butter(4, 2.0 * bins / power.size, output="sos")
        histories = [np.asarray(scipy.signal.sosfiltfilt(sections, history)) for history in histories]
        passed = np.abs(scipy.signal.sosfreqz(sections, power.size)[1]) ** 4  # forwards and backwards
    total = float(power_of(histories[0]).sum())
    return Band(command=histories[0], measured=histories[1], bins=bins, noise=floor * passed / total)


def noise_floor(values: Array) -> tuple[float, float]:
    """Level of the upper half of a periodogram, per bin, and its total."""
    power = power_of(values)
    return upper_level(power), float(power.sum())


def power_of(values: Array) -> Array:
    """Periodogram of a history, shape (n,), by frequency above zero."""
    return periodogram(values, hann(values.size))
