"""Spikes and dropouts: samples that jump away from a history and back faster than any actuator can move."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reliab.core.arrays import Array
from reliab.recordings.recording import Recording

_QUANTILE = 0.995  # of the steps between samples, nearly the largest one of a history that moves
_JUMP = 4.0  # times that step
_LEAST = 0.01  # share of the peak
_WIDEST = 8  # samples
_RETURN = 0.5  # share of the jump by which the history may differ after it


def spikes(values: Array) -> NDArray[np.bool_]:
    """Mark the samples of spikes and dropouts.

    Returns whether a sample belongs to a stretch of at most eight that a jump leads into and another jump, of
    about the same size and the other sign, leads out of, shape (n,).

    >>> history = np.sin(np.arange(0.0, 40.0, 0.05))
    >>> history[300] += 3.0
    >>> np.flatnonzero(spikes(history)).tolist()
    [300]
    """
    steps = np.diff(values)
    size = np.abs(steps)
    usual = float(np.quantile(size, _QUANTILE))
    peak = float(np.quantile(np.abs(values), _QUANTILE))
    jumps = np.flatnonzero(size > max(_JUMP * usual, _LEAST * peak))
    is_spike = np.zeros(values.size, dtype=np.bool_)
    for place, begin in enumerate(jumps):
        for end in jumps[place + 1 :]:
            if end - begin > _WIDEST:
                break
            remaining = abs(float(values[end + 1] - values[begin]))
            if remaining <= _RETURN * size[begin] and steps[begin] * steps[end] < 0.0:
                is_spike[begin + 1 : end + 1] = True
                break
    return is_spike


def remove_spikes(recording: Recording) -> tuple[Recording, NDArray[np.bool_], NDArray[np.bool_]]:
    """Bridge the spikes of both histories by straight lines.

    Returns the test without spikes, the same object where it has none, and which samples of command and
    measured displacement were spikes, each shape (n,).
    """
    command_spikes, measured_spikes = spikes(recording.command), spikes(recording.measured)
    if not (command_spikes.any() or measured_spikes.any()):
        return recording, command_spikes, measured_spikes
    return (
        replace(
            recording,
            command=_bridge(recording.command, command_spikes),
            measured=_bridge(recording.measured, measured_spikes),
        ),
        command_spikes,
        measured_spikes,
    )


def _bridge(values: Array, is_spike: NDArray[np.bool_]) -> Array:
    places = np.arange(values.size)
    return np.interp(places, places[~is_spike], values[~is_spike])
