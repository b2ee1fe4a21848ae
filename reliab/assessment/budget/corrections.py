"""A recording without the skew, scale, filters and hysteresis that are stated of its channels."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from reliab.assessment.rebuilt_error.readings import lag_of_reading
from reliab.core.arrays import Array
from reliab.core.stated_value import StatedValue
from reliab.core.vocabulary import MILLI
from reliab.recordings.recording import Recording
from reliab.signals.cubic_path import CubicPath
from reliab.signals.filters import LowPass

CHANNELS: Final = ("command", "measured")
"""Channels that may have a filter."""

_UNFILTERED_CHANNELS = ("ground", "force")
_CORNER_TOLERANCE = 0.03  # relative standard deviation of the corner of a filter, ±5 % over √3


def correct_recording(
    recording: Recording, stated: Mapping[str, StatedValue], filters: Mapping[str, LowPass]
) -> Recording:
    """Correct a recording for what is stated of its channels, with several actuators of all of them alike.

    The filter of each channel is applied to all others as well: the equation of the error holds for histories
    that passed through the same filters, and no noise is amplified. A stated hysteresis is that of a play; a
    skew is positive where the measured displacement was recorded later than the command [ms].
    """
    command, measured, step = recording.command, recording.measured, recording.time_step
    if "command_scale" in stated:
        command = command / stated["command_scale"].value
    if (hysteresis := stated.get("hysteresis", StatedValue(0.0)).value) > 0.0:
        measured = measured + hysteresis * np.apply_along_axis(lag_of_reading, -1, command, hysteresis)
    if "measured" in filters:
        command = filters["measured"].apply(command, step)
    if "command" in filters:
        measured = filters["command"].apply(measured, step)
    other_channels = {
        name: values
        for name in _UNFILTERED_CHANNELS
        if (values := getattr(recording, name, None)) is not None
    }
    for low_pass in filters.values():
        other_channels = {name: low_pass.apply(values, step) for name, values in other_channels.items()}
    skew = stated.get("skew", StatedValue(0.0)).value / MILLI
    if skew != 0.0:
        measured = np.apply_along_axis(_earlier, -1, measured, skew, step)
    return replace(recording, command=command, measured=measured, **other_channels)


def _earlier(values: Array, time: float, step: float) -> Array:
    """Values of a history as much later [s], by a cubic through its samples, shape (n,)."""
    return CubicPath.interpolate(np.arange(values.size) * step, values).read_delayed(-time)


def delays_of_filters(filters: Mapping[str, LowPass]) -> dict[str, StatedValue]:
    """Give what stated filters leave unknown: the delay [ms] that deviations of their corners make."""
    if not filters:
        return {}
    delays = [low_pass.delay for low_pass in filters.values()]
    return {"filter_delay": StatedValue(0.0, MILLI * _CORNER_TOLERANCE * float(np.linalg.norm(delays)))}
