"""The open record of a test: one NetCDF file with everything that a reader in ten years needs.

Dimensions `actuator` and `time`. Variables `command` and `measured` [m] over both and, where they were
recorded, `force` [N], of several actuators over both, and `ground_acceleration` [m s-2] over time; and every
other channel of the source as it stood there. Each carries `units` (UDUNITS), `long_name`, `source_column`
and `transformation`; the attributes of the file say from which file it was made (name and SHA-256), and by
whom, on which rig and when, as far as that was stated. It is described on the page "Recordings" of the
documentation.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from reliab.core.encodings import as_text
from reliab.core.files import LIMITS, decoding, ordinary, written_whole
from reliab.core.shipped import checksum_of
from reliab.core.stated_value import RANGES
from reliab.core.untrusted_files import objects_of, open_hdf5
from reliab.recordings.readers.columns import Series
from reliab.recordings.readers.hierarchical import STATED_ATTRIBUTES, text_of
from reliab.recordings.reading import ChannelHistories, histories_of, read_statements, read_test
from reliab.recordings.recording import DISPLACEMENTS, FEWEST_SAMPLES, Channel, Part, StatedChannels
from reliab.version import __version__

if TYPE_CHECKING:
    import h5py
    import xarray as xr

SCHEMA: Final = "reliab recording 1"
"""Value of the attribute `schema` of a record."""

_VARIABLES: Final = {
    Part.COMMAND: ("command", "m", "commanded displacement"),
    Part.MEASURED: ("measured", "m", "measured displacement"),
    Part.FORCE: ("force", "N", "restoring force of the specimen"),
    Part.GROUND: ("ground_acceleration", "m s-2", "ground acceleration"),
}
_REQUIRED_ATTRIBUTES: Final = ("schema", "source_file", "source_sha256", "sampling_rate_hz", "time_step_s")
_DIGITS: Final = 64  # of a checksum
_EVEN: Final = 1e-6  # of a step
"""By which a time of a record may be off."""


@dataclass(frozen=True, kw_only=True)
class About:
    """What a laboratory states of a test beside its channels; texts, empty where nothing is stated."""

    f: str = ""  # Natural frequency [Hz], "1" or "1±0.01"
    xi: str = ""  # Damping ratio [-]
    alpha: str = ""  # Share of the stiffness in the laboratory [-]
    mass: str = ""  # Mass of the structure [kg]
    specimen: str = ""
    rig: str = ""
    operator: str = ""
    date: str = ""
    further: Mapping[str, str] = field(default_factory=dict)  # Free attributes

    def attributes(self) -> dict[str, str]:
        """All of them that are stated."""
        filled_attributes = {name: value for name, value in vars(self).items() if name != "further" and value}
        return {**self.further, **filled_attributes}


def record_test(
    path: str | Path,
    *,
    laboratory: StatedChannels | None = None,
    test: str | None = None,
    about: About | None = None,
    time_units: str | None = None,
    delimiter: str | None = None,
) -> tuple["xr.Dataset", ChannelHistories]:
    """Make the record of a test, and say what was recognised; arguments and errors as of `read_recording`.

    `laboratory`: what is stated of the channels; `test`: which one, where the file holds several.
    """
    columns = read_test(path, test, delimiter=delimiter)
    histories = histories_of(columns, laboratory or StatedChannels(), time_units=time_units)
    return _as_dataset(histories, Path(path), about or About()), histories


def write_record(record: "xr.Dataset", path: str | Path) -> None:
    """Write a record as NetCDF, whole or not at all."""
    texts = {name: as_text(text) for name, text in record.attrs.items() if isinstance(text, str)}
    encoding = {str(name): {"zlib": True, "complevel": 4, "shuffle": True} for name in record.data_vars}
    with written_whole(path) as file:
        file.write_bytes(record.assign_attrs(texts).to_netcdf(engine="h5netcdf", encoding=encoding))


def write_csv(record: "xr.Dataset", histories: ChannelHistories, path: str | Path) -> None:
    """Write the recognised channels as CSV with names and units that every reader understands."""
    names, values = ["time_s"], [histories.time_step * np.arange(_size(histories))]
    endings = {Part.COMMAND: "m", Part.MEASURED: "m", Part.FORCE: "n", Part.GROUND: "mps2"}
    for key, channel in histories.channels.items():
        if key in histories.values:
            names.append(f"{key.replace(' ', '_')}_{endings[channel.part]}")
            values.append(histories.values[key])
    comments = [f"# {name} = {record.attrs[name]}\n" for name in STATED_ATTRIBUTES if name in record.attrs]
    with written_whole(path) as place, place.open("w", encoding="utf-8", newline="\n") as file:
        file.write("".join(comments) + ",".join(names) + "\n")
        np.savetxt(file, np.column_stack(values), fmt="%.17g", delimiter=",")


def check_record(path: str | Path) -> list[str]:
    """Say in sentences what is wrong with a record, if anything is; what is no NetCDF file is refused."""
    with decoding("This is no record", remedy="Make it with `reliab record`", where=path):
        LIMITS["test"].require_small(ordinary(path))
        with open_hdf5(path) as file:
            size = sum(int(getattr(item, "nbytes", 0)) for _, item in objects_of(file))
            LIMITS["test"].require_few_numbers(size, path)
            return list(_faults(file))


def _as_dataset(histories: ChannelHistories, path: Path, about: About) -> "xr.Dataset":
    import xarray as xr

    numbers = sorted({channel.actuator for channel in histories.channels.values()} - {""}) or [""]
    size, step = _size(histories), histories.time_step
    variables = {_VARIABLES[part][0]: entry for part in _VARIABLES if (entry := _variable(histories, part))}
    variables |= _remaining_channels(histories, set(variables))
    time = ("time", step * np.arange(size), {"units": "s", "long_name": "time from the first sample"})
    statements = {name: str(value) for name, value in read_statements(histories.columns).items()}
    return xr.Dataset(
        variables,
        coords={"time": time, "actuator": ("actuator", np.array(numbers, dtype="U20"))},
        attrs={
            **statements,
            **about.attributes(),
            "schema": SCHEMA,
            "Conventions": "CF-1.11",
            "made_by": f"reliab {__version__}",
            "source_file": path.name,
            "source_sha256": checksum_of(path),
            "source_test": histories.columns.test,
            "sampling_rate_hz": 1.0 / step,
            "time_step_s": step,
            "notes": " ".join(histories.notes),
        },
    )


def _variable(histories: ChannelHistories, part: Part) -> tuple[Any, ...]:
    """One of the main variables, of all actuators; none where the test has no such channel."""
    _, unit, long_name = _VARIABLES[part]
    channels = {key: channel for key, channel in histories.channels.items() if channel.part is part}
    rows = [histories.values[key] for key in channels]
    if not rows:
        return ()
    has_actuators = part in DISPLACEMENTS or len(rows) > 1
    return (
        ("actuator", "time") if has_actuators else ("time",),
        np.stack(rows) if has_actuators else rows[0],
        {
            "units": unit,
            "long_name": long_name,
            "source_column": "; ".join(channel.column for channel in channels.values()),
            "transformation": "; ".join(_transformation(channel, unit) for channel in channels.values()),
            "reason": next(iter(channels.values())).reason,
        },
    )


def _size(histories: ChannelHistories) -> int:
    return int(next(iter(histories.values.values())).size)


def _transformation(channel: Channel, unit: str) -> str:
    """Say how readings became the variable."""
    reading = "reading" if channel.zero == 0.0 else f"(reading - {channel.zero:.17g})"
    conversion = f"{reading} * {channel.factor:.17g}, from {channel.unit or 'no stated unit'} to {unit}"
    return ", ".join((*channel.corrections, conversion))


def _remaining_channels(histories: ChannelHistories, taken_names: set[str]) -> dict[str, Any]:
    """Channels of the source that were not needed, as they stand there, where they have the test's clock."""
    columns, columns_used = histories.columns, {channel.column for channel in histories.channels.values()}
    lead = columns.series[next(iter(histories.channels[key].column for key in histories.values))]
    variables: dict[str, Any] = {}
    for column, series in columns.series.items() if histories.has_rows else ():
        if (
            column in columns_used
            or series.values.size != lead.values.size
            or not _have_one_clock(series, lead)
        ):
            continue
        plain = re.sub(r"\W+", "_", column).strip("_") or "channel"
        name = next(
            free
            for k in range(len(variables) + 2 + len(taken_names))
            if (free := plain if k == 0 else f"{plain}_{k}")
            not in {*variables, *taken_names, "time", "actuator"}
        )
        variables[name] = (
            ("time",),
            series.values,
            {
                "units": str(series.unit) or "unknown",
                "long_name": column,
                "source_column": column,
                "transformation": "; ".join((*series.corrections, *filter(None, [series.unclear]))) or "none",
            },
        )
    return variables


def _have_one_clock(first: Series, second: Series) -> bool:
    """Whether two channels were sampled at the same times, as far as their file says."""
    if first.times is None or second.times is None:
        return first.times is second.times
    return first.start == second.start and np.array_equal(first.times, second.times)


def _faults(file: "h5py.File") -> Iterator[str]:
    schema = text_of(file.attrs.get("schema", ""))
    if schema != SCHEMA:
        yield f"The attribute `schema` is {schema!r} instead of {SCHEMA!r}."
        return
    missing = [f"attribute `{name}`" for name in _REQUIRED_ATTRIBUTES if name not in file.attrs]
    missing += [
        f"variable `{name}`" for name in ("time", "actuator", "command", "measured") if name not in file
    ]
    yield from (f"The {variable_name} is missing." for variable_name in missing)
    if missing:
        return
    size = file["time"].shape[0] if len(file["time"].shape) == 1 else 0
    for part, (name, unit, _) in _VARIABLES.items():
        if name in file:
            is_of_actuators = part in DISPLACEMENTS or (part is Part.FORCE and len(file[name].shape) > 1)
            shape = (*file["actuator"].shape, size) if is_of_actuators else (size,)
            yield from _faults_of_variable(file[name], name, unit, shape)
    yield from _faults_of_time(file)


def _faults_of_variable(
    variable: "h5py.Dataset", name: str, unit: str, shape: tuple[int, ...]
) -> Iterator[str]:
    if variable.shape != shape:
        yield f"The variable `{name}` has the shape {variable.shape} instead of {shape}."
    elif variable.dtype.kind != "f" or "scale_factor" in variable.attrs:
        yield f"The numbers of `{name}` are stored with a scale; store them as they are."
    elif not bool(np.isfinite(variable[()]).all()):
        yield f"`{name}` has values that are not finite numbers."
    unit_text = text_of(variable.attrs.get("units", ""))
    if unit_text != unit:
        yield f"The unit of `{name}` is {unit_text!r} instead of {unit!r}."
    for attribute in ("long_name", "source_column", "transformation"):
        if attribute not in variable.attrs:
            yield f"The variable `{name}` lacks its `{attribute}`."


def _faults_of_time(file: "h5py.File") -> Iterator[str]:
    times, step = file["time"][()], float(np.ravel(file.attrs["time_step_s"])[0])
    if not RANGES["time step"].includes(step):
        yield f"The attribute `time_step_s` must be {RANGES['time step'].span}."
    elif times.size < FEWEST_SAMPLES or not np.abs(np.diff(times) / step - 1.0).max() <= _EVEN:
        yield f"`time` has less than {FEWEST_SAMPLES} values, or does not increase by `time_step_s`."
    digest = text_of(file.attrs["source_sha256"])
    if len(digest) != _DIGITS or set(digest) - set("0123456789abcdef"):
        yield "The attribute `source_sha256` is not 64 hexadecimal digits."
