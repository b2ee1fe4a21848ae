"""What is known before the first sample: the sensor's offset and how the error begins.

A displacement sensor is read from an arbitrary zero. Where a test begins at rest, command and piston stand
at the same place, so that what the channels differ by is the sensor's offset; it is taken away where it
exceeds what noise and the command's own motion explain, and its uncertainty is carried on. Where a test
begins in motion nothing tells offset and error apart, nor how the error was moving: both go into the
interval.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_AT_REST = 1e-3  # share of the largest displacement up to which the first motion counts as rest
_STILL = 2e-3  # share up to which the command still counts as standing
_LONGEST_REST = 0.25  # of the record
_SIGNIFICANT = 4.0  # standard deviations
_FEWEST = 4


@dataclass(frozen=True, kw_only=True)
class Start:
    """How a recording begins.

    Attributes
    ----------
    at_rest : bool
        Whether the structure stands still at the first sample.
    amplitude : float
        Amplitude of its motion there [m].
    offset : float
        Offset of the sensor that was taken away, measured minus command at rest [m].
    offset_deviation : float
        Standard deviation of what may be left of it [m].
    """

    at_rest: bool
    amplitude: float
    offset: float
    offset_deviation: float


def examine_start(
    command: Array, measured: Array, time_step: float, frequency: float, white: float, slow: float = 0.0
) -> Start:
    """Find offset and state of motion at the begin of a recording.

    Parameters
    ----------
    command, measured : numpy.ndarray
        x_c and x_m [m], shape (n,).
    time_step : float
        Step between samples [s].
    frequency : float
        Lowest natural frequency [Hz].
    white : float
        Standard deviation of the sensor's white noise [m].
    slow : float, optional
        Root mean square of its slow noise [m].

    Returns
    -------
    Start
        Offset and amplitude of the motion.

    Examples
    --------
    >>> time = np.arange(0.0, 10.0, 0.01)
    >>> command = np.where(time > 1.0, np.sin(6.0 * (time - 1.0)), 0.0)
    >>> round(examine_start(command, command + 0.02, 0.01, 1.0, 0.0).offset, 6)
    0.02
    """
    peak = float(np.abs(command - command[0]).max())
    few = min(_FEWEST, command.size - 1)
    velocity = (command[few] - command[0]) / (few * time_step)
    amplitude = float(np.hypot(command[0], velocity / (2.0 * np.pi * frequency)))
    if amplitude > _AT_REST * max(peak, float(np.abs(command).max())):
        constant = float(np.mean(measured - command))
        return Start(at_rest=False, amplitude=amplitude, offset=0.0, offset_deviation=abs(constant))
    moved = np.abs(command - command[0]) > _STILL * peak
    still = int(np.argmax(moved)) if moved.any() else command.size
    still = max(min(still, int(_LONGEST_REST * command.size)), _FEWEST)
    offset = float(np.mean(measured[:still] - command[:still]))
    motion = float(np.abs(command[:still] - command[0]).max())
    deviation = float(np.hypot(white / np.sqrt(still), slow))
    if abs(offset) <= _SIGNIFICANT * deviation + motion:
        return Start(at_rest=True, amplitude=0.0, offset=0.0, offset_deviation=deviation)
    return Start(at_rest=True, amplitude=0.0, offset=offset, offset_deviation=deviation)
