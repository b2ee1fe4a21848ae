"""The open record of a test, as `reliab record` writes it: what each variable is stands in the file."""

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from reliab.recordings.readers.columns import Columns
from reliab.recordings.recording import require_few_samples

if TYPE_CHECKING:
    import h5py

_SCHEMA: Final = "reliab recording"
_PARTS: Final = {
    "time": "time",
    "command": "command",
    "measured": "measured",
    "force": "force",
    "ground_acceleration": "ground acceleration",
}
STATED: Final = ("f", "xi", "alpha", "mass", "scale")
"""Attributes that state the structure and the sensor."""


def is_record(file: "h5py.File") -> bool:
    """Whether an open file says that it is a record."""
    return text_of(file.attrs.get("schema", "")).startswith(_SCHEMA)


def columns_of_record(file: "h5py.File", path: Path) -> Columns:
    """Read the variables of a record, those of several actuators with their numbers."""
    numbers = (
        [text_of(value) for value in np.asarray(file["actuator"][()]).reshape(-1)]
        if "actuator" in file
        else [""]
    )
    values: dict[str, np.ndarray] = {}
    parts: dict[str, tuple[str, str]] = {}
    units: dict[str, str] = {}
    for name, item in file.items():
        if not hasattr(item, "shape") or item.dtype.kind not in "iuf" or name == "actuator":
            continue
        require_few_samples(max(item.shape, default=0), f"{path.name}, {name}")
        rows = np.atleast_2d(np.asarray(item[()], dtype=np.float64))
        for number, row in zip(numbers if len(rows) > 1 else [""], rows, strict=True):
            column = f"{name}_{number}" if number else name
            values[column], units[column] = row, text_of(item.attrs.get("units", ""))
            if name in _PARTS:
                parts[column] = (_PARTS[name], number)
    stated = {name: text_of(file.attrs[name]) for name in STATED if name in file.attrs}
    return Columns(path=path, values=values, units=units, parts=parts, header=stated)


def text_of(value: object) -> str:
    """Text of an attribute, whatever HDF5 made of it."""
    if isinstance(value, np.ndarray):
        value = value.reshape(-1)[0] if value.size else ""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)
