"""The step between samples of a test: from its times, its sampling rate or a number in the file."""

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.recordings.readers import Columns
from reliab.recordings.recognition import TIMES, Recognised
from reliab.recordings.recording import FEWEST_SAMPLES

_JITTER = 0.01  # share of a step by which a time may be off
_FEW = 0.01  # share of unusual steps up to which they are faults, and not the rounding of the times
_DIGITS = 9
_STEP_NAMES = ("dt", "timestep", "time_step", "time_step_s", "step")
_RATE_NAMES = ("rate", "rate_hz", "fs", "sampling_rate", "samplerate", "sample_rate", "sampling_rate_hz")


def finite(columns: Columns, name: str) -> NDArray[np.float64]:
    """Take the samples of a column, all of which must be finite numbers."""
    values = columns.values[name]
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        raise InputError(
            "Every value must be a finite number",
            value=f"{'an empty cell or NaN' if np.isnan(values[wrong[0]]) else values[wrong[0]]}, "
            f"{wrong.size} in all",
            remedy="Repair the recording; a gap cannot be left empty",
            where=columns.place(int(wrong[0]), name),
        )
    return values


def time_step_of(
    columns: Columns, time: Recognised | None, rate_hz: float | None, time_units: str | None
) -> float:
    """Step between the samples of a file [s].

    `rate_hz` [Hz]; returns [s].
    """
    if time is not None:
        if time_units is not None and time_units not in TIMES:
            raise InputError(
                "The unit must be one of time", value=time_units, remedy=f"Choose among {', '.join(TIMES)}"
            )
        step = equal_step(columns, time.name) * TIMES[time_units or time.unit or "s"]
        _agrees(columns, step, rate_hz)
        return step
    if rate_hz is not None:
        return 1.0 / rate_hz
    for names, invert in ((_STEP_NAMES, False), (_RATE_NAMES, True)):
        for name, value in columns.scalars.items():
            if name.rpartition(".")[2].lower() in names and value > 0.0:
                return 1.0 / value if invert else value
    raise InputError(
        "A test's file must say at what times the samples were taken",
        value=", ".join(repr(name) for name in list(columns.values)[:8]),
        remedy="Add a column time, name it with `time`, or give the sampling rate with `rate`",
        where=columns.path.name,
    )


def _agrees(columns: Columns, step: float, rate_hz: float | None) -> None:
    if rate_hz is not None and abs(step * rate_hz - 1.0) > _JITTER:
        raise InputError(
            "The times must agree with the sampling rate",
            value=f"{1.0 / step:.6g} Hz against {rate_hz:g} Hz",
            remedy="Correct `rate`, or say with `time_units` in what unit the times are",
            where=columns.path.name,
        )


def equal_step(columns: Columns, name: str) -> float:
    """Step between times, which must be equal."""
    times = finite(columns, name)
    if times.size < FEWEST_SAMPLES:
        raise InputError(
            f"A test must have at least {FEWEST_SAMPLES} samples", value=times.size, where=columns.path.name
        )
    steps = np.diff(times)
    usual, mean = float(np.median(steps)), float((times[-1] - times[0]) / steps.size)
    off = np.abs(steps - usual) > _JITTER * abs(usual)
    rounded = off.mean() > _FEW
    if rounded:  # the step is no multiple of what the times are rounded to
        off = np.abs(steps - mean) > 1.01 * _rounding(times) + _JITTER * abs(mean)
    if off.any() or not mean > 0.0:
        row = int(np.flatnonzero(off)[0] if off.any() else np.argmin(steps)) + 1
        raise InputError(
            f"Samples must follow each other at equal steps, here mostly of {usual:.6g}",
            value=f"{times[row]:.10g} after {times[row - 1]:.10g}",
            remedy="Resample the test, or cut it where samples are missing",
            where=columns.place(row, name),
        )
    return mean


def _rounding(times: NDArray[np.float64]) -> float:
    """One unit in the last decimal that the times have."""
    for digits in range(_DIGITS + 1):
        if np.abs(times - times.round(digits)).max() <= 1e-12 * max(np.abs(times).max(), 1.0):
            return float(10.0**-digits)
    return 0.0
