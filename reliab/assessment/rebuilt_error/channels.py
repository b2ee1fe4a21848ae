"""Checks of the recorded channels, and of how the recording begins, before an error is rebuilt."""

from dataclasses import replace

import numpy as np

from reliab.arrays import Array
from reliab.assessment.rebuilt_error.initial import Start, examine_start
from reliab.assessment.rebuilt_error.noise import SensorNoise
from reliab.errors import InputError
from reliab.significant import significant
from reliab.structures import Partition

FEWEST_SAMPLES = 64
"""Smallest number of samples from which an error is rebuilt."""

_FEWEST_PER_PERIOD = 10.0


def checked_histories(
    command: Array, measured: Array, step: float, structure: Partition, *, several: bool = False
) -> tuple[Array, Array]:
    """Check command and measured displacement.

    `command`, `measured` [m], shape (n,), or (p, n) of `several` actuators; `step` [s].
    """
    command, measured = (np.ascontiguousarray(values, dtype=np.float64) for values in (command, measured))
    shape = command.shape
    if len(shape) != 1 + several or shape != measured.shape or shape[-1] < FEWEST_SAMPLES:
        raise InputError(
            f"Command and measured displacement must have one length, at least {FEWEST_SAMPLES} samples",
            value=f"shapes {shape} and {measured.shape}",
            remedy="Give the histories of the whole test, of every actuator if there are several",
        )
    if several and shape[0] != structure.degrees:
        raise InputError(
            "A test must have a command and a measured displacement for each degree of freedom of the "
            "specimen",
            value=f"{shape[0]} of {structure.degrees}",
            remedy="Record all of them, or describe the part that was driven",
        )
    for name, values in (("command", command), ("measured displacement", measured)):
        if not np.isfinite(values).all():
            raise InputError(f"The {name} must be finite throughout", remedy="Repair the recording")
    if not np.ptp(command, axis=-1).any():
        raise InputError("The command must move", remedy="Check that the column is the right one")
    if not (np.isfinite(step) and step > 0.0):
        raise InputError("The time step must be positive", value=f"{step} s")
    lowest = float(structure.natural_frequencies[0])
    if lowest * step * _FEWEST_PER_PERIOD > 1.0:
        raise InputError(
            f"A period of the structure must hold at least {_FEWEST_PER_PERIOD:.0f} samples",
            value=significant(1.0 / (lowest * step)),
            remedy="Record at a higher rate: the error between samples is unknown",
        )
    return command, measured


def stated_start(
    command: Array,
    measured: Array,
    time_step: float,
    structure: Partition,
    noise: SensorNoise,
    sensor_offset: float | None,
) -> Start:
    """Examine how a test begins; a stated sensor offset is used as given.

    `command`, `measured` [m]; `time_step` [s]; `sensor_offset` [m].
    """
    lowest = float(structure.natural_frequencies[0]) or 1.0
    share = float(structure.static_transfer[0, 0])
    start = examine_start(command, measured, time_step, lowest, noise.white, noise.slow, share)
    return start if sensor_offset is None else replace(start, offset=sensor_offset, offset_deviation=0.0)
