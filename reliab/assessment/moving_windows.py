"""A and d in moving windows: whether the rig behaved the same from beginning to end."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reliab.assessment.tracking_index import TrackingIndex, track
from reliab.errors import ReliabError
from reliab.recordings import FEWEST_SAMPLES, Recording

_PERIODS = 8.0  # of the equivalent frequency in a window
_MOST_WINDOWS = 40
_FEWEST_WINDOWS = 3
_QUIET = 0.05  # share of the largest mean square of a window; windows below it are left out
_DRAWS = 400
_DEVIATIONS = 2.5


@dataclass(frozen=True, kw_only=True, eq=False)
class Windows:
    """Indices of overlapping windows in which the command moved.

    Attributes
    ----------
    centre : numpy.ndarray
        Middle of each window [s], shape (windows,).
    amplitude, delay : numpy.ndarray
        A [-] and d [s], shape (windows,).
    amplitude_sd, delay_sd : numpy.ndarray
        Their standard deviations, shape (windows,).
    length : float
        Length of a window [s].
    """

    centre: NDArray[np.float64]
    amplitude: NDArray[np.float64]
    delay: NDArray[np.float64]
    amplitude_sd: NDArray[np.float64]
    delay_sd: NDArray[np.float64]
    length: float

    @property
    def delay_range(self) -> float:
        """Range of d over the windows beyond what noise explains [s]."""
        return _range(self.delay, self.delay_sd)

    @property
    def amplitude_range(self) -> float:
        """Range of A over the windows beyond what noise explains [-]."""
        return _range(self.amplitude, self.amplitude_sd)


def _range(values: NDArray[np.float64], deviations: NDArray[np.float64]) -> float:
    if values.size < 2:  # noqa: PLR2004 - one window has no range
        return 0.0
    low, high = values + _DEVIATIONS * deviations, values - _DEVIATIONS * deviations
    return max(float(high.max() - low.min()), 0.0)


def track_windows(recording: Recording, whole: TrackingIndex, *, window: str = "hann") -> Windows:
    """Evaluate A and d in windows that overlap by half."""
    begins, size = _cuts(recording, whole.plain.equivalent_frequency)
    energies = [float(np.var(recording.command[begin : begin + size])) for begin in begins]
    rows = []
    for begin, energy in zip(begins, energies, strict=True):
        tracked = None if energy < _QUIET * max(energies) else _tracked(recording, begin, size, window)
        if tracked is not None:
            centre = (begin + 0.5 * size) * recording.time_step
            rows.append((centre, tracked.amplitude, tracked.delay, *tracked.spread))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 5).T
    names = ("centre", "amplitude", "delay", "amplitude_sd", "delay_sd")
    return Windows(**dict(zip(names, columns, strict=True)), length=size * recording.time_step)


def _cuts(recording: Recording, frequency: float) -> tuple[list[int], int]:
    """First samples of the windows, and their length in samples."""
    total = recording.command.size
    size = max(int(_PERIODS / (frequency * recording.time_step)), 2 * total // _MOST_WINDOWS, FEWEST_SAMPLES)
    count = 2 * total // size - 1
    if count < _FEWEST_WINDOWS:
        return [], size
    return np.linspace(0, total - size, count).astype(int).tolist(), size


def _tracked(recording: Recording, begin: int, size: int, window: str) -> TrackingIndex | None:
    """Index of one window; None where it has none, as where nothing moves."""
    stretch = slice(begin, begin + size)
    try:
        part = Recording(
            command=recording.command[stretch],
            measured=recording.measured[stretch],
            time_step=recording.time_step,
        )
        return track(part, window=window, draws=_DRAWS)
    except ReliabError:
        return None
