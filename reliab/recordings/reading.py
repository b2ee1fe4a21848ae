"""Read a test from a file."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from reliab.errors import InputError
from reliab.recordings.readers import Columns, read_columns, read_frame
from reliab.recordings.recognition import (
    ACCELERATIONS,
    FORCES,
    LENGTHS,
    Part,
    Recognised,
    recognise,
    recognise_extras,
)
from reliab.recordings.recording import Recording
from reliab.recordings.time_step import finite, time_step_of
from reliab.stated_value import StatedValue

_HEADER_NAMES = {
    "f": ("f", "natural frequency", "natural_frequency", "f_n", "fn"),
    "xi": ("xi", "ξ", "damping ratio", "damping_ratio"),
    "alpha": ("alpha", "α", "experimental fraction", "experimental_fraction"),
    "mass": ("mass", "mass_kg"),
    "scale": ("scale", "sensor scale", "sensor_scale"),
}


def read_recording(
    path: str | Path | pd.DataFrame,
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
    path : str, pathlib.Path or pandas.DataFrame
        CSV or other text, MATLAB, HDF5 or NetCDF; or a data frame with a history in each column.
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
    columns = read_frame(path) if isinstance(path, pd.DataFrame) else read_columns(path, delimiter=delimiter)
    given = {Part.COMMAND: command, Part.MEASURED: measured, Part.TIME: time}
    recognised = recognise(columns, {part: name for part, name in given.items() if name is not None})
    scale, notes = _scales(recognised, units)
    extras, extra_notes = _extras(columns, recognise_extras(columns))
    return Recording(
        command=finite(columns, recognised[Part.COMMAND].name) * scale[Part.COMMAND],
        measured=finite(columns, recognised[Part.MEASURED].name) * scale[Part.MEASURED],
        time_step=time_step_of(columns, recognised.get(Part.TIME), rate_hz, time_units),
        name=columns.path.name,
        notes=(*_unnamed(columns, recognised), *notes, *extra_notes),
        ground=extras.get(Part.GROUND),
        force=extras.get(Part.FORCE),
        stated=_stated(columns),
    )


def _stated(columns: Columns) -> dict[str, StatedValue]:
    """Read what the header, or single numbers of a binary file, say of the structure and the sensor."""
    texts = {name.rpartition(".")[2].lower(): f"{value:.17g}" for name, value in columns.scalars.items()}
    texts |= {name: text.removesuffix("Hz") for name, text in columns.header.items()}
    return {
        quantity: StatedValue.parse(texts[name], name)
        for quantity, names in _HEADER_NAMES.items()
        for name in names
        if name in texts
    }


def _extras(
    columns: Columns, recognised: Mapping[Part, Recognised]
) -> tuple[dict[Part, NDArray[np.float64]], list[str]]:
    """Ground acceleration [m/s²] and force [N], where the file holds them."""
    histories, notes = {}, []
    for part, column in recognised.items():
        factors, unit = (ACCELERATIONS, "m/s²") if part is Part.GROUND else (FORCES, "N")
        if not column.unit:
            notes.append(f"The {part} states no unit and was taken to be in {unit}.")
        histories[part] = finite(columns, column.name) * factors.get(column.unit, 1.0)
    return histories, notes


def _unnamed(columns: Columns, recognised: Mapping[Part, Recognised]) -> list[str]:
    if columns.named:
        return []
    order = ", ".join(f"{part} = {column.name}" for part, column in recognised.items())
    return [f"The columns have no names and were taken by their order: {order}."]


def _scales(recognised: Mapping[Part, Recognised], units: str | None) -> tuple[dict[Part, float], list[str]]:
    """Factors to metres of command and measured displacement."""
    if units is not None and units not in LENGTHS:
        raise InputError(
            "The unit must be one of length", value=units, remedy=f"Choose among {', '.join(LENGTHS)}"
        )
    parts = (Part.COMMAND, Part.MEASURED)
    stated = {part: units or recognised[part].unit for part in parts}
    missing = [part for part in parts if not stated[part]]
    notes = []
    if len(missing) == 1:
        unit = stated[parts[1 - parts.index(missing[0])]]
        stated[missing[0]] = unit
        notes.append(f"The {missing[0]} displacement states no unit and was taken to be in {unit} too.")
    if stated[parts[0]] != stated[parts[1]]:
        command_unit, measured_unit = (stated[part] for part in parts)
        notes.append(f"The command is stated in {command_unit}, the measured in {measured_unit}.")
    return {part: LENGTHS.get(stated[part], 1.0) for part in parts}, notes
