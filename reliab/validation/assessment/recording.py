"""A real test: command and measured displacement at equal steps, checked."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.validation.assessment.readers import Columns, read_columns
from reliab.validation.assessment.recognition import LENGTHS, TIMES, Found, Part, recognise

FEWEST_SAMPLES = 64
"""Samples below which no index is evaluated."""

_JITTER = 0.01  # share of a step by which a time may be off
_FEW = 0.01  # share of unusual steps up to which they are faults, and not the rounding of the times
_DIGITS = 9
_STEP_NAMES = ("dt", "timestep", "time_step", "time_step_s", "step")
_RATE_NAMES = ("rate", "rate_hz", "fs", "sampling_rate", "samplerate", "sample_rate", "sampling_rate_hz")


@dataclass(frozen=True, kw_only=True, eq=False)
class Recording:
    """Command and measured displacement of a test.

    Parameters
    ----------
    command, measured : numpy.ndarray
        Displacements [m], shape (n,), n ≥ 64; where no unit is known they only share one.
    time_step : float
        Step between samples [s].
    name : str, optional
        What the test is called.
    notes : tuple of str, optional
        What was assumed when the test was read, in sentences.

    Raises
    ------
    InputError
        If the histories differ in length, are too short, do not move, or hold a value that is no number.

    Examples
    --------
    >>> time = np.arange(0.0, 20.0, 0.01)
    >>> test = Recording(command=np.sin(6.0 * time), measured=np.sin(6.0 * time - 0.01), time_step=0.01)
    >>> round(test.duration, 2)
    19.99
    """

    command: NDArray[np.float64]
    measured: NDArray[np.float64]
    time_step: float
    name: str = "test"
    notes: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        if self.command.shape != self.measured.shape or self.command.size < FEWEST_SAMPLES:
            raise InputError(
                f"Command and measured displacement must have one length, at least {FEWEST_SAMPLES}",
                value=f"{self.command.size} and {self.measured.size}",
                remedy="Give the whole test",
                where=self.name,
            )
        if not (np.isfinite(self.time_step) and self.time_step > 0.0):
            raise InputError("The time step must be positive", value=f"{self.time_step} s", where=self.name)
        for what, values in (("command", self.command), ("measured displacement", self.measured)):
            if not np.isfinite(values).all():
                row = int(np.flatnonzero(~np.isfinite(values))[0])
                raise InputError(
                    "Every value must be a finite number",
                    value=f"{values[row]} in the {what}, sample {row + 1}",
                    remedy="Repair the recording; a gap cannot be left empty",
                    where=self.name,
                )
            if np.ptp(values) <= 1e-9 * np.abs(values).max():
                raise InputError(
                    f"The {what} must move",
                    value=f"{values[0]:g} throughout",
                    remedy="Check that the column is the right one and the channel was connected",
                    where=self.name,
                )

    @property
    def duration(self) -> float:
        """Time between the first and the last sample [s]."""
        return (self.command.size - 1) * self.time_step


def read_recording(
    path: str | Path,
    *,
    command: str | None = None,
    measured: str | None = None,
    time: str | None = None,
    rate_hz: float | None = None,
    units: str | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
) -> Recording:
    """Read a test from a file.

    Parameters
    ----------
    path : str or pathlib.Path
        CSV or other text, MATLAB, HDF5 or NetCDF.
    command, measured, time : str, optional
        Names of the columns, where they are not recognised.
    rate_hz : float, optional
        Sampling rate [Hz], where the file holds no time.
    units, time_units : str, optional
        Unit of both displacements and of the time, where the file states none.
    delimiter : str, optional
        What separates the columns of a text.

    Returns
    -------
    Recording
        The test.

    Raises
    ------
    InputError
        With file, line, rule and remedy, if a column is missing, times do not follow at equal steps, a
        value is missing or a history is constant.
    """
    columns = read_columns(path, delimiter=delimiter)
    given = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    found = recognise(columns, {part: name for part, name in given.items() if name is not None})
    scale, notes = _scales(found, units)
    return Recording(
        command=_finite(columns, found[Part.COMMAND].name) * scale[Part.COMMAND],
        measured=_finite(columns, found[Part.MEASURED].name) * scale[Part.MEASURED],
        time_step=_time_step(columns, found.get(Part.TIME), rate_hz, time_units),
        name=columns.path.name,
        notes=(*_unnamed(columns, found), *notes),
    )


def _unnamed(columns: Columns, found: Mapping[Part, Found]) -> list[str]:
    if columns.named:
        return []
    order = ", ".join(f"{part} = {each.name}" for part, each in found.items())
    return [f"The columns have no names and were taken by their order: {order}."]


def _scales(found: Mapping[Part, Found], units: str | None) -> tuple[dict[Part, float], list[str]]:
    """Factors to metres of command and measured displacement."""
    if units is not None and units not in LENGTHS:
        raise InputError(
            "The unit must be one of length", value=units, remedy=f"Choose among {', '.join(LENGTHS)}"
        )
    parts = (Part.COMMAND, Part.MEASURED)
    stated = {part: units or found[part].unit for part in parts}
    missing = [part for part in parts if not stated[part]]
    notes = []
    if len(missing) == 1:
        other = stated[parts[1 - parts.index(missing[0])]]
        stated[missing[0]] = other
        notes.append(f"The {missing[0]} displacement states no unit and was taken to be in {other} too.")
    if stated[parts[0]] != stated[parts[1]]:
        command_unit, measured_unit = (stated[part] for part in parts)
        notes.append(f"The command is stated in {command_unit}, the measured in {measured_unit}.")
    return {part: LENGTHS.get(stated[part], 1.0) for part in parts}, notes


def _finite(columns: Columns, name: str) -> NDArray[np.float64]:
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


def _time_step(columns: Columns, time: Found | None, rate_hz: float | None, time_units: str | None) -> float:
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
        remedy="Add a column time, name it with --time, or give the sampling rate with --rate",
        where=columns.path.name,
    )


def _agrees(columns: Columns, step: float, rate_hz: float | None) -> None:
    if rate_hz is not None and abs(step * rate_hz - 1.0) > _JITTER:
        raise InputError(
            "The times must agree with the sampling rate",
            value=f"{1.0 / step:.6g} Hz against {rate_hz:g} Hz",
            remedy="Correct --rate, or say with --time-units in what unit the times are",
            where=columns.path.name,
        )


def equal_step(columns: Columns, name: str) -> float:
    """Step between times, which must be equal.

    Parameters
    ----------
    columns : Columns
        The file.
    name : str
        Its column of times, in any unit.

    Returns
    -------
    float
        The step in the same unit.

    Raises
    ------
    InputError
        If a time does not follow the one before it by the step that most have, within what the times
        round or 1 % of the step; the message names the line.
    """
    times = _finite(columns, name)
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
